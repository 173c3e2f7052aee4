#include "fair/true_grid.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "base/parallel.h"

namespace stackmesh {
namespace {

constexpr double kLargest = 8;                          // stored voxels in a true one
constexpr double kSmallestBroken = 1.25;                // the same, of a ratio that is not whole
constexpr std::size_t kFewest = 6, kFewestBroken = 8;   // planes that must differ from the one before
constexpr double kCovered = 0.7, kCoveredBroken = 0.8;  // share of the ends of blocks at which they must
constexpr int kTries = 41;                              // ratios tried for a number of blocks

/// Blocks along one axis: block m begins at the face `start + m * length` (face i lies before stored plane i).
struct Blocks {
  double length = 1, start = 0;
};

/// For every plane whether it differs from the one before it along the axis; [0] is false.
std::vector<char> changes_along(const LabelVolume& volume, int axis, int threads) {
  const std::size_t nx = volume.size[0], ny = volume.size[1], nz = volume.size[2];
  std::vector<char> out(volume.size[axis], 0);
  const std::uint16_t* voxels = volume.voxels.data();
  if (axis == 2) {
    parallel_for(nz - 1, threads, [&](std::size_t k) {
      const std::uint16_t* a = voxels + k * nx * ny;
      out[k + 1] = !std::equal(a, a + nx * ny, a + nx * ny);
    });
  } else if (axis == 1) {
    parallel_for(ny - 1, threads, [&](std::size_t j) {
      for (std::size_t k = 0; k < nz && !out[j + 1]; ++k) {
        const std::uint16_t* a = voxels + (k * ny + j) * nx;
        out[j + 1] = !std::equal(a, a + nx, a + nx);
      }
    });
  } else {
    const std::size_t pieces = std::min<std::size_t>(64, nz);
    std::vector<std::vector<std::uint16_t>> different(pieces, std::vector<std::uint16_t>(nx, 0));
    parallel_for(pieces, threads, [&](std::size_t p) {
      std::uint16_t* sum = different[p].data();
      for (std::size_t row = p * nz / pieces * ny; row < (p + 1) * nz / pieces * ny; ++row) {
        const std::uint16_t* a = voxels + row * nx;
        for (std::size_t i = 1; i < nx; ++i) sum[i] |= static_cast<std::uint16_t>(a[i] ^ a[i - 1]);
      }
    });
    for (const auto& d : different)
      for (std::size_t i = 1; i < nx; ++i) out[i] |= d[i] != 0;
  }
  return out;
}

/// Where a block of that length may start so that all ends lie at changes: a face c ends a block that begins within
/// half a plane of it. Nothing if there is no such place.
std::optional<double> common_start(const std::vector<int>& changes, double length) {
  // On a circle of that length, relative to the first change: all of them must lie within one plane.
  double low = -0.5, high = 0.5;
  for (int c : changes) {
    double off = std::fmod(static_cast<double>(c - changes[0]), length);
    if (off > length / 2) off -= length;
    low = std::max(low, off - 0.5);
    high = std::min(high, off + 0.5);
    if (!(low < high)) return std::nullopt;
  }
  return changes[0] + 0.5 * (low + high);
}

/// The roundest size of voxels within the range of lengths that explain the changes; its middle where none is round.
double roundest(double first, double last, double stored_mm, const std::vector<int>& changes) {
  for (double step : {1.0, 0.5, 0.25, 0.1, 0.05}) {
    const double length = std::round(0.5 * (first + last) * stored_mm / step) * step / stored_mm;
    if (length > first && length < last && common_start(changes, length)) return length;
  }
  return 0.5 * (first + last);
}

std::optional<Blocks> find_blocks(const std::vector<char>& changed, double stored_mm) {
  std::vector<int> changes;
  for (std::size_t i = 0; i < changed.size(); ++i)
    if (changed[i]) changes.push_back(static_cast<int>(i));
  if (changes.size() < kFewest) return std::nullopt;
  const int span = changes.back() - changes.front();
  const auto covered = [&](double length) {
    return static_cast<double>(changes.size()) / (std::round(span / length) + 1);
  };
  int whole = 0;
  for (int c : changes) whole = std::gcd(whole, c - changes[0]);
  if (whole >= 2 && whole <= kLargest && covered(whole) >= kCovered)
    return Blocks{static_cast<double>(whole), static_cast<double>(changes[0] % whole)};
  if (changes.size() < kFewestBroken) return std::nullopt;
  // The most blocks first that can be: fewer would leave changes between their ends.
  for (int count = static_cast<int>(std::ceil(span / kLargest)); count <= span / kSmallestBroken; ++count) {
    if (covered(static_cast<double>(span) / count) < kCoveredBroken) break;
    if (covered(static_cast<double>(span) / count) > 1.05) continue;
    std::optional<double> first, last, start_first, start_last;
    for (int i = 0; i < kTries; ++i) {
      const double length = (span + (2.0 * i / (kTries - 1) - 1)) / count;
      if (length < kSmallestBroken) continue;
      if (const auto start = common_start(changes, length)) {
        if (!first) first = length;
        last = length;
      }
    }
    if (!first) continue;
    const double length = roundest(*first, *last, stored_mm, changes);
    if (const auto start = common_start(changes, length)) return Blocks{length, std::fmod(*start, length)};
  }
  return std::nullopt;
}

/// The first stored plane of every block, and where the first block begins.
struct Planes {
  std::vector<int> plane;
  double begin = 0;
};

Planes planes_of(const Blocks& blocks, int count) {
  Planes out;
  double begin = blocks.start;
  while (begin > 0) begin -= blocks.length;
  while (begin + blocks.length < 0.5) begin += blocks.length;  // of which no plane is stored
  out.begin = begin;
  for (std::size_t m = 0;; ++m) {
    const int plane = std::max(0, static_cast<int>(std::ceil(begin + static_cast<double>(m) * blocks.length - 0.5)));
    if (plane >= count) return out;
    out.plane.push_back(plane);
  }
}

/// True where a label reaches the image's border along an axis.
bool reaches_border(const LabelVolume& volume, int axis) {
  const int last = volume.size[axis] - 1;
  for (int k = 0; k < volume.size[2]; k += axis == 2 ? std::max(last, 1) : 1)
    for (int j = 0; j < volume.size[1]; j += axis == 1 ? std::max(last, 1) : 1)
      for (int i = 0; i < volume.size[0]; i += axis == 0 ? std::max(last, 1) : 1)
        if (volume.voxels[volume.index(i, j, k)] != 0) return true;
  return false;
}

/// True where the image's border cuts the first or the last block.
bool cut_at_border(const Blocks& blocks, const Planes& planes, int count) {
  const double end = planes.begin + static_cast<double>(planes.plane.size()) * blocks.length;
  return planes.begin < -0.01 || end > count + 0.01;
}

}  // namespace

std::optional<TrueGrid> find_true_grid(const LabelVolume& volume, int threads) {
  TrueGrid grid;
  std::array<Planes, 3> planes;
  bool finer = false;
  for (int axis = 0; axis < 3; ++axis) {
    Blocks blocks;
    if (volume.size[axis] > 1)
      if (const auto found = find_blocks(changes_along(volume, axis, threads), volume.spacing_mm[axis]))
        blocks = *found;
    planes[axis] = planes_of(blocks, volume.size[axis]);
    if (cut_at_border(blocks, planes[axis], volume.size[axis]) && reaches_border(volume, axis)) {
      blocks = {};  // the labels would go on beyond the image
      planes[axis] = planes_of(blocks, volume.size[axis]);
    }
    finer = finer || blocks.length > 1;
    grid.stored_per_voxel[axis] = blocks.length;
  }
  if (!finer) return std::nullopt;
  LabelVolume& out = grid.volume = without_voxels(volume);
  std::array<double, 3> first;  // centre of the first true voxel
  for (int axis = 0; axis < 3; ++axis) {
    out.size[axis] = static_cast<int>(planes[axis].plane.size());
    out.spacing_mm[axis] = grid.stored_per_voxel[axis] * volume.spacing_mm[axis];
    first[axis] = planes[axis].begin + 0.5 * grid.stored_per_voxel[axis] - 0.5;
  }
  out.origin_mm = volume.world(first[0], first[1], first[2]);
  out.voxels.resize(static_cast<std::size_t>(out.size[0]) * out.size[1] * out.size[2]);
  std::size_t at = 0;
  for (int k : planes[2].plane)
    for (int j : planes[1].plane)
      for (int i : planes[0].plane) out.voxels[at++] = volume.voxels[volume.index(i, j, k)];
  return grid;
}

std::string true_grid_warning(const std::array<double, 3>& stored_mm, const std::array<double, 3>& made_mm) {
  const auto size = [](const std::array<double, 3>& s) {
    char text[96];
    std::snprintf(text, sizeof text, "%.4g x %.4g x %.4g mm", s[0], s[1], s[2]);
    return std::string(text);
  };
  return "the labels were made on voxels of " + size(made_mm) + " and are stored as " + size(stored_mm) +
         ": they are taken as they were made (--as-stored takes the stored voxels)";
}

}  // namespace stackmesh
