#include "random_stacks.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <random>
#include <set>
#include <string>

namespace stackmesh::testing_support {
namespace {

using Random = std::mt19937_64;

int below(Random& r, int n) {
  return static_cast<int>(r() % static_cast<std::uint64_t>(n));
}
double unit(Random& r) {
  return static_cast<double>(r() >> 11) * 0x1p-53;
}

LabelVolume blank(Random& r, int labels) {
  LabelVolume v;
  v.size = {4 + below(r, 14), 4 + below(r, 14), 2 + below(r, 6)};
  v.spacing_mm = {1, 1, std::pow(10.0, -1 + 2 * unit(r))};
  if (below(r, 4) == 0) v.spacing_mm[1] = 0.5 + unit(r);
  for (int l = 0; l <= labels; ++l) v.labels.push_back({l, ""});
  v.voxels.assign(static_cast<std::size_t>(v.size[0]) * v.size[1] * v.size[2], 0);
  v.kind = "random";
  return v;
}

template <class F>
void fill(LabelVolume& v, F f) {
  for (int k = 0; k < v.size[2]; ++k)
    for (int j = 0; j < v.size[1]; ++j)
      for (int i = 0; i < v.size[0]; ++i) v.voxels[v.index(i, j, k)] = static_cast<std::uint16_t>(f(i, j, k));
}

void blobs(LabelVolume& v, Random& r, int labels) {
  struct Blob {
    double x, y, z, r;
    int label;
  };
  std::vector<Blob> list;
  for (int b = 0; b < labels + below(r, 6); ++b)
    list.push_back({unit(r) * v.size[0], unit(r) * v.size[1], unit(r) * v.size[2], 1 + 5 * unit(r), 1 + b % labels});
  fill(v, [&](int i, int j, int k) {
    double best = 0.35;
    int label = 0;
    for (const Blob& b : list) {
      const double d = (i - b.x) * (i - b.x) + (j - b.y) * (j - b.y) + 2 * (k - b.z) * (k - b.z);
      const double f = std::exp(-d / (b.r * b.r));
      if (f > best) {
        best = f;
        label = b.label;
      }
    }
    return label;
  });
}

void noise(LabelVolume& v, Random& r, int labels) {
  const double empty = unit(r);
  fill(v, [&](int, int, int) { return unit(r) < empty ? 0 : 1 + below(r, labels); });
}

void near_copies(LabelVolume& v, Random& r, int labels) {
  for (int k = 0; k < v.size[2]; ++k)
    for (int j = 0; j < v.size[1]; ++j)
      for (int i = 0; i < v.size[0]; ++i)
        v.voxels[v.index(i, j, k)] = k > 0 && unit(r) < 0.95  ? v.voxels[v.index(i, j, k - 1)]
                                     : i > 0 && unit(r) < 0.7 ? v.voxels[v.index(i - 1, j, k)]
                                                              : static_cast<std::uint16_t>(below(r, labels + 1));
}

void boxes(LabelVolume& v, Random& r, int labels) {
  for (int b = 0; b < 3 + below(r, 12); ++b) {
    const int label = below(r, labels + 1);
    std::array<int, 3> lo, hi;
    for (int a = 0; a < 3; ++a) {
      lo[a] = below(r, v.size[a]);
      hi[a] = std::min(v.size[a], lo[a] + 1 + below(r, v.size[a]));
    }
    for (int k = lo[2]; k < hi[2]; ++k)
      for (int j = lo[1]; j < hi[1]; ++j)
        for (int i = lo[0]; i < hi[0]; ++i) v.voxels[v.index(i, j, k)] = static_cast<std::uint16_t>(label);
  }
}

void tubes(LabelVolume& v, Random& r, int labels) {
  for (int t = 0; t < 1 + below(r, 4); ++t) {
    double x = unit(r) * v.size[0], y = unit(r) * v.size[1];
    const double radius = 0.6 + 2 * unit(r), dx = 3 * unit(r) - 1.5, dy = 3 * unit(r) - 1.5;
    const int label = 1 + below(r, labels), hollow = below(r, 3);
    for (int k = 0; k < v.size[2]; ++k, x += dx, y += dy)
      for (int j = 0; j < v.size[1]; ++j)
        for (int i = 0; i < v.size[0]; ++i) {
          const double d = std::hypot(i - x, j - y);
          if (d < radius && !(hollow == 0 && d < 0.4 * radius))
            v.voxels[v.index(i, j, k)] = static_cast<std::uint16_t>(label);
        }
  }
}

void touches(LabelVolume& v, Random& r, int labels) {
  const int period = 1 + below(r, 2), shift = below(r, 2);
  fill(v, [&](int i, int j, int k) {
    const bool on = ((i / period + j / period + k * shift) & 1) != 0;
    return on ? 1 + (labels > 1 ? (i / (2 * period) + k) % labels : 0)
              : (labels > 2 && (i + j + k) % 5 == 0 ? labels : 0);
  });
}

}  // namespace

LabelVolume random_volume(std::uint64_t seed) {
  Random r(seed * 0x9E3779B97F4A7C15ull + 1);
  const int labels = 1 + below(r, 8);
  LabelVolume v = blank(r, labels);
  switch (seed % 6) {
    case 0:
      blobs(v, r, labels);
      break;
    case 1:
      noise(v, r, labels);
      break;
    case 2:
      near_copies(v, r, labels);
      break;
    case 3:
      boxes(v, r, labels);
      break;
    case 4:
      tubes(v, r, labels);
      break;
    default:
      touches(v, r, labels);
  }
  if (below(r, 5) == 0) {  // an empty section
    const int k = below(r, v.size[2]);
    for (int j = 0; j < v.size[1]; ++j)
      for (int i = 0; i < v.size[0]; ++i) v.voxels[v.index(i, j, k)] = 0;
  }
  if (*std::max_element(v.voxels.begin(), v.voxels.end()) == 0) v.voxels[v.index(1, 1, v.size[2] / 2)] = 1;
  return v;
}

std::vector<LabelContours> random_contours(std::uint64_t seed) {
  Random r(seed * 0xD1B54A32D192ED03ull + 7);
  const int labels = 1 + below(r, 3), sections = 2 + below(r, 5), points = 3 + below(r, 24);
  const double jitter = below(r, 8) == 0 ? 0 : std::pow(10.0, -1 - 13 * unit(r));
  const double gap = std::pow(10.0, -1 + 2 * unit(r));
  std::vector<LabelContours> files;
  for (int l = 0; l < labels; ++l) {
    LabelContours file;
    file.path = "random " + std::to_string(seed) + " label " + std::to_string(l + 1);
    file.label = l + 1;
    std::vector<double> radius;
    for (int i = 0; i < points; ++i) radius.push_back((10.0 - 3 * l) * (0.5 + 0.5 * unit(r)));
    const double drift_x = unit(r) - 0.5, drift_y = unit(r) - 0.5;
    const bool island = below(r, 2) == 0, hole = below(r, 3) == 0;
    for (int k = 0; k < sections; ++k) {
      ContourSection s;
      s.z_mm = k * gap;
      const auto polygon = [&](double cx, double cy, double scale) {
        ContourPolygon p;
        for (int i = 0; i < points; ++i) {
          const double a = 2 * M_PI * i / points;
          p.points.push_back({cx + scale * radius[i] * std::cos(a) + jitter * (unit(r) - 0.5),
                              cy + scale * radius[i] * std::sin(a) + jitter * (unit(r) - 0.5)});
        }
        if (below(r, 2)) std::reverse(p.points.begin(), p.points.end());
        s.polygons.push_back(p);
      };
      const double moved = below(r, 3) == 0 ? 1.0 : 0.0;  // most sections are near copies
      polygon(moved * drift_x, moved * drift_y, 1);
      if (hole && below(r, 2)) polygon(moved * drift_x, moved * drift_y, 0.3);
      if (island && below(r, 2)) polygon(30 + l * 25, moved * drift_y, 0.5);
      file.sections.push_back(s);
    }
    files.push_back(file);
  }
  return files;
}

LabelVolume volume_of_bytes(const std::uint8_t* data, std::size_t size) {
  std::size_t at = 0;
  const auto next = [&]() -> int { return at < size ? data[at++] : 0; };
  static constexpr double kSpacings_mm[] = {1, 1, 1, 1, 1, 1, 1, 1, 0.8, 1.2, 1.5, 2, 0.5, 0.7, 1.01, 4};
  LabelVolume v;
  for (int a = 0; a < 3; ++a) v.size[a] = 2 + next() % 6;
  const int labels = 1 + next() % 7;
  for (int a = 0; a < 3; ++a) v.spacing_mm[a] = kSpacings_mm[next() % std::size(kSpacings_mm)];
  for (int l = 0; l <= labels; ++l) v.labels.push_back({l, ""});
  v.voxels.assign(static_cast<std::size_t>(v.size[0]) * v.size[1] * v.size[2], 0);
  int byte = 0;
  for (std::size_t i = 0; i < v.voxels.size(); ++i) {
    if (i % 2 == 0) byte = next();
    v.voxels[i] = static_cast<std::uint16_t>((i % 2 == 0 ? byte & 15 : byte >> 4) % (labels + 1));
  }
  if (*std::max_element(v.voxels.begin(), v.voxels.end()) == 0) v.voxels[v.voxels.size() / 2] = 1;
  v.kind = "fuzzed";
  return v;
}

LabelVolume volume_of(const std::vector<std::vector<const char*>>& slices, double gap_mm) {
  LabelVolume v;
  v.size = {static_cast<int>(std::string(slices[0][0]).size()), static_cast<int>(slices[0].size()),
            static_cast<int>(slices.size())};
  v.spacing_mm = {1, 1, gap_mm};
  std::set<int> numbers = {0};
  for (const auto& s : slices)
    for (const char* row : s)
      for (const char* c = row; *c; ++c) numbers.insert(*c - '0');
  std::vector<int> order(numbers.begin(), numbers.end());
  for (int n : order) v.labels.push_back({n, ""});
  for (const auto& s : slices)
    for (const char* row : s)
      for (const char* c = row; *c; ++c)
        v.voxels.push_back(
            static_cast<std::uint16_t>(std::lower_bound(order.begin(), order.end(), *c - '0') - order.begin()));
  v.kind = "test";
  return v;
}

}  // namespace stackmesh::testing_support
