#pragma once
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <queue>
#include <vector>

#include "model/label_volume.h"
#include "sections/virtual_slices.h"

namespace stackmesh::testing_support {

inline InterpolatedVolume interpolated(const LabelVolume& volume, int per_gap, int axis = 2) {
  InterpolateOptions options;
  options.per_gap = per_gap;
  return add_virtual_slices(volume, axis, options);
}

/// label(x, y, k) at every pixel centre (x = i + 0.5), pixels of 1 mm.
template <class F>
LabelVolume shapes(int width, int height, int slices, double gap_mm, F label) {
  LabelVolume v;
  v.size = {width, height, slices};
  v.spacing_mm = {1, 1, gap_mm};
  v.labels = {{0, ""}, {1, ""}, {2, ""}, {3, ""}};
  for (int k = 0; k < slices; ++k)
    for (int j = 0; j < height; ++j)
      for (int i = 0; i < width; ++i) v.voxels.push_back(static_cast<std::uint16_t>(label(i + 0.5, j + 0.5, k)));
  return v;
}

inline LabelVolume disc_stack(const std::vector<double>& radii, int size) {
  return shapes(size, size, static_cast<int>(radii.size()), 4, [&](double x, double y, int k) {
    return std::hypot(x - 0.5 * size, y - 0.5 * size) < radii[k] ? 1 : 0;
  });
}

inline std::vector<std::uint16_t> slice(const LabelVolume& v, int k) {
  return {v.voxels.begin() + static_cast<std::ptrdiff_t>(v.index(0, 0, k)),
          v.voxels.begin() + static_cast<std::ptrdiff_t>(v.index(0, 0, k + 1))};
}

inline double area(const LabelVolume& v, int k, int label) {
  double n = 0;
  for (std::uint16_t l : slice(v, k)) n += l == label;
  return n;
}

inline double radius(const LabelVolume& v, int k) {
  return std::sqrt(area(v, k, 1) / M_PI);
}

inline double centre_x(const LabelVolume& v, int k, int label) {
  double sum = 0;
  for (int j = 0; j < v.size[1]; ++j)
    for (int i = 0; i < v.size[0]; ++i)
      if (v.voxels[v.index(i, j, k)] == label) sum += i + 0.5;
  return sum / area(v, k, label);
}

/// The 6-connected components of equal label, numbered from 1; 0 is background. A plain flood.
inline std::vector<int> components(const LabelVolume& v) {
  std::vector<int> of(v.voxels.size(), 0);
  int count = 0;
  for (std::size_t seed = 0; seed < of.size(); ++seed) {
    if (v.voxels[seed] == 0 || of[seed] != 0) continue;
    of[seed] = ++count;
    std::queue<std::size_t> front;
    front.push(seed);
    while (!front.empty()) {
      const std::size_t p = front.front();
      front.pop();
      const int i = static_cast<int>(p % v.size[0]), j = static_cast<int>(p / v.size[0] % v.size[1]),
                k = static_cast<int>(p / v.size[0] / v.size[1]);
      const int next[6][3] = {{i - 1, j, k}, {i + 1, j, k}, {i, j - 1, k}, {i, j + 1, k}, {i, j, k - 1}, {i, j, k + 1}};
      for (const auto& n : next) {
        if (n[0] < 0 || n[1] < 0 || n[2] < 0 || n[0] >= v.size[0] || n[1] >= v.size[1] || n[2] >= v.size[2]) continue;
        const std::size_t q = v.index(n[0], n[1], n[2]);
        if (of[q] != 0 || v.voxels[q] != v.voxels[p]) continue;
        of[q] = count;
        front.push(q);
      }
    }
  }
  return of;
}

inline int component_count(const LabelVolume& v) {
  int most = 0;
  for (int c : components(v)) most = std::max(most, c);
  return most;
}

inline std::size_t parts_in_slice(const LabelVolume& v, int k, int label) {
  LabelVolume one = v;
  one.size[2] = 1;
  one.voxels = slice(v, k);
  for (std::uint16_t& l : one.voxels) l = l == label ? 1 : 0;
  return static_cast<std::size_t>(component_count(one));
}

inline void expect_no_holes_in_tissue(const LabelVolume& in, const LabelVolume& out, int per_gap) {
  for (int k = 0; k + 1 < in.size[2]; ++k) {
    const auto low = slice(in, k), high = slice(in, k + 1);
    std::size_t holes = 0;
    for (int j = 1; j <= per_gap; ++j) {
      const auto here = slice(out, k * (per_gap + 1) + j);
      for (std::size_t p = 0; p < low.size(); ++p) holes += low[p] != 0 && high[p] != 0 && here[p] == 0;
    }
    EXPECT_EQ(holes, 0u) << "above slice " << k;
  }
}

/// The volume with its stacking axis z moved to x (0) or y (1), in-plane axes cyclic: same slices.
inline LabelVolume turned(const LabelVolume& in, int axis) {
  LabelVolume out = in;
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  out.size[u] = in.size[0];
  out.size[v] = in.size[1];
  out.size[axis] = in.size[2];
  out.spacing_mm[u] = in.spacing_mm[0];
  out.spacing_mm[v] = in.spacing_mm[1];
  out.spacing_mm[axis] = in.spacing_mm[2];
  for (int k = 0; k < in.size[2]; ++k)
    for (int j = 0; j < in.size[1]; ++j)
      for (int i = 0; i < in.size[0]; ++i) {
        int at[3];
        at[u] = i;
        at[v] = j;
        at[axis] = k;
        out.voxels[out.index(at[0], at[1], at[2])] = in.voxels[in.index(i, j, k)];
      }
  return out;
}

}  // namespace stackmesh::testing_support
