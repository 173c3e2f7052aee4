#pragma once
// Meshes whose sets, volumes and answers are known beforehand.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>

#include "model/tet_mesh.h"

namespace blocks {

using stackmesh::Label;
using stackmesh::TetMesh;
using stackmesh::Vec3;

/// nx * ny * nz cells of six tets each; label(i, j, k) 0 leaves a cell out.
inline TetMesh block(
    int nx, int ny, int nz, Vec3 cell,
    const std::function<Label(int, int, int)>& label = [](int, int, int) { return 1; }) {
  TetMesh mesh;
  mesh.space = stackmesh::Space::lps;
  const auto id = [=](int i, int j, int k) { return (k * (ny + 1) + j) * (nx + 1) + i; };
  for (int k = 0; k <= nz; ++k)
    for (int j = 0; j <= ny; ++j)
      for (int i = 0; i <= nx; ++i) mesh.points.push_back({i * cell.x, j * cell.y, k * cell.z});
  constexpr int paths[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {1, 0, 2}, {2, 1, 0}};
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i)
        for (int p = 0; p < 6; ++p) {
          if (label(i, j, k) == 0) continue;
          std::array<int, 3> at = {i, j, k};
          std::array<std::int32_t, 4> tet = {id(i, j, k), 0, 0, 0};
          for (int step = 0; step < 3; ++step) {
            ++at[paths[p][step]];
            tet[step + 1] = id(at[0], at[1], at[2]);
          }
          if (p >= 3) std::swap(tet[2], tet[3]);
          mesh.tets.push_back(tet);
          mesh.labels.push_back(label(i, j, k));
        }
  return mesh;
}

/// Moves inner nodes by up to a fifth of a cell, so that no element is like another.
inline void disturb(TetMesh& mesh, int nx, int ny, int nz, Vec3 cell) {
  for (int k = 1; k < nz; ++k)
    for (int j = 1; j < ny; ++j)
      for (int i = 1; i < nx; ++i) {
        const int v = (k * (ny + 1) + j) * (nx + 1) + i;
        mesh.points[v] = mesh.points[v] + 0.2 * Vec3{cell.x * std::sin(3.0 * v), cell.y * std::sin(5.0 * v + 1),
                                                     cell.z * std::sin(7.0 * v + 2)};
      }
}

}  // namespace blocks
