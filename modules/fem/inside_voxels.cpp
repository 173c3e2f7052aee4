#include "fem/inside_voxels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace stackmesh {
namespace {

constexpr int kFaces[6][3] = {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}};

}  // namespace

InsideVoxels::InsideVoxels(const IntensityVolume& image, const TetMesh& mesh, const std::vector<std::int32_t>& tets,
                           int erode_px)
    : image_(image), space_(mesh.space) {
  Vec3 low{1e300, 1e300, 1e300}, high = -1.0 * low;
  const auto extend = [&](std::int32_t v) {
    const Vec3 p = voxel(mesh.points[v]);
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  };
  for (const std::int32_t t : tets) {
    each_node(mesh, static_cast<std::size_t>(t), extend);
  }
  const double lows[3] = {low.x, low.y, low.z}, highs[3] = {high.x, high.y, high.z};
  for (int d = 0; d < 3; ++d) {
    const double last = image.size[d] - 1;  // a mesh may reach farther than an int counts
    low_[d] = static_cast<int>(std::clamp(std::floor(lows[d]) - 1, 0.0, last));
    size_[d] = static_cast<int>(std::clamp(std::ceil(highs[d]) + 1, 0.0, last)) - low_[d] + 1;
  }
  const std::size_t count = static_cast<std::size_t>(size_[0]) * size_[1] * size_[2];
  state_.assign(count, 0);
  value_.resize(count);
  for (int k = 0; k < size_[2]; ++k)
    for (int j = 0; j < size_[1]; ++j)
      for (int i = 0; i < size_[0]; ++i)
        value_[at(i, j, k)] = image.values[image.index(low_[0] + i, low_[1] + j, low_[2] + k)];
  mark_inside(mesh, tets);
  erode(erode_px);
  used_ = static_cast<std::size_t>(std::count(state_.begin(), state_.end(), 1));
  if (used_ > 0) continue_outward();
}

void InsideVoxels::mark_inside(const TetMesh& mesh, const std::vector<std::int32_t>& tets) {
  std::vector<std::array<std::int32_t, 4>> corners;
  for (const std::int32_t t : tets)
    for (const auto& part : tets_of_element(mesh, static_cast<std::size_t>(t))) corners.push_back(part);
  for (const auto& t : corners) {
    Vec3 p[4];
    for (int k = 0; k < 4; ++k) p[k] = voxel(mesh.points[t[k]]) - Vec3{1.0 * low_[0], 1.0 * low_[1], 1.0 * low_[2]};
    const auto range = [&](auto part, int d, int& from, int& to) {
      double least = part(p[0]), most = least;
      for (int k = 1; k < 4; ++k) {
        least = std::min(least, part(p[k]));
        most = std::max(most, part(p[k]));
      }
      from = static_cast<int>(std::clamp<double>(std::ceil(least - 1e-9), 0, size_[d]));
      to = static_cast<int>(std::clamp<double>(std::floor(most + 1e-9), -1, size_[d] - 1));
    };
    int x0, x1, y0, y1, z0, z1;
    range([](Vec3 v) { return v.x; }, 0, x0, x1);
    range([](Vec3 v) { return v.y; }, 1, y0, y1);
    range([](Vec3 v) { return v.z; }, 2, z0, z1);
    const Vec3 a = p[1] - p[0], b = p[2] - p[0], c = p[3] - p[0];
    const double volume = dot(cross(a, b), c);
    if (volume == 0) continue;
    const Vec3 na = (1 / volume) * cross(b, c), nb = (1 / volume) * cross(c, a), nc = (1 / volume) * cross(a, b);
    for (int k = z0; k <= z1; ++k)
      for (int j = y0; j <= y1; ++j)
        for (int i = x0; i <= x1; ++i) {
          const Vec3 q = Vec3{1.0 * i, 1.0 * j, 1.0 * k} - p[0];
          const double la = dot(na, q), lb = dot(nb, q), lc = dot(nc, q);
          constexpr double grain = -1e-9;
          if (la >= grain && lb >= grain && lc >= grain && la + lb + lc <= 1 - grain) state_[at(i, j, k)] = 1;
        }
  }
}

void InsideVoxels::erode(int steps) {
  for (int step = 0; step < steps; ++step) {
    std::vector<std::uint8_t> next = state_;
    bool any = false;
    for (int k = 0; k < size_[2]; ++k)
      for (int j = 0; j < size_[1]; ++j)
        for (int i = 0; i < size_[0]; ++i) {
          if (state_[at(i, j, k)] == 0) continue;
          for (const auto& d : kFaces) {
            const int x = i + d[0], y = j + d[1], z = k + d[2];
            // the image's own border: a cut
            if (x < 0 || y < 0 || z < 0 || x >= size_[0] || y >= size_[1] || z >= size_[2]) continue;
            if (state_[at(x, y, z)] == 0) next[at(i, j, k)] = 0;
          }
          any = any || next[at(i, j, k)] != 0;
        }
    if (!any) return;
    state_ = std::move(next);
    ++eroded_;
  }
}

/// Layer by layer: a voxel without a value gets the mean of its neighbours that have one.
void InsideVoxels::continue_outward() {
  std::vector<std::array<int, 3>> layer;
  std::vector<std::uint8_t> queued(state_.size(), 0);
  const auto visit_neighbours = [&](int i, int j, int k, auto visit) {
    for (int z = std::max(0, k - 1); z <= std::min(size_[2] - 1, k + 1); ++z)
      for (int y = std::max(0, j - 1); y <= std::min(size_[1] - 1, j + 1); ++y)
        for (int x = std::max(0, i - 1); x <= std::min(size_[0] - 1, i + 1); ++x) visit(x, y, z);
  };
  const auto queue_around = [&](int i, int j, int k, std::vector<std::array<int, 3>>& to) {
    visit_neighbours(i, j, k, [&](int x, int y, int z) {
      if (state_[at(x, y, z)] != 0 || queued[at(x, y, z)] != 0) return;
      queued[at(x, y, z)] = 1;
      to.push_back({x, y, z});
    });
  };
  for (int k = 0; k < size_[2]; ++k)
    for (int j = 0; j < size_[1]; ++j)
      for (int i = 0; i < size_[0]; ++i)
        if (state_[at(i, j, k)] != 0) queue_around(i, j, k, layer);
  while (!layer.empty()) {
    std::vector<float> means;
    means.reserve(layer.size());
    for (const auto& [i, j, k] : layer) {
      double sum = 0, weights = 0;
      visit_neighbours(i, j, k, [&, ci = i, cj = j, ck = k](int x, int y, int z) {
        if (state_[at(x, y, z)] == 0) return;
        const Vec3 d = {(x - ci) * image_.spacing_mm[0], (y - cj) * image_.spacing_mm[1],
                        (z - ck) * image_.spacing_mm[2]};
        sum += value_[at(x, y, z)] / norm(d);
        weights += 1 / norm(d);
      });
      means.push_back(static_cast<float>(sum / weights));
    }
    std::vector<std::array<int, 3>> next;
    for (std::size_t n = 0; n < layer.size(); ++n) {
      const auto [i, j, k] = layer[n];
      value_[at(i, j, k)] = means[n];
      state_[at(i, j, k)] = 1;
    }
    for (const auto& [i, j, k] : layer) queue_around(i, j, k, next);
    layer = std::move(next);
  }
}

double InsideVoxels::sample(Vec3 p) const {
  const Vec3 v = voxel(p);
  const double place[3] = {v.x - low_[0], v.y - low_[1], v.z - low_[2]};
  int from[3], to[3];
  double t[3];
  for (int d = 0; d < 3; ++d) {
    const double x = std::clamp<double>(place[d], 0, size_[d] - 1);
    from[d] = static_cast<int>(x);
    to[d] = std::min(from[d] + 1, size_[d] - 1);
    t[d] = x - from[d];
  }
  const auto along_x = [&](int j, int k) {
    return (1 - t[0]) * value_[at(from[0], j, k)] + t[0] * value_[at(to[0], j, k)];
  };
  const auto along_y = [&](int k) { return (1 - t[1]) * along_x(from[1], k) + t[1] * along_x(to[1], k); };
  return (1 - t[2]) * along_y(from[2]) + t[2] * along_y(to[2]);
}

}  // namespace stackmesh
