#include "validate/self_intersections.h"

#include <algorithm>

#include "base/parallel.h"
#include "validate/box_tree.h"
#include "validate/exact.h"
#include "validate/triangle_contact.h"

namespace stackmesh {
namespace {

using Pair = std::array<std::int32_t, 2>;

void keep_first(std::vector<Pair>& pairs, std::size_t limit) {
  std::sort(pairs.begin(), pairs.end());
  if (pairs.size() > limit) pairs.resize(limit);
}

}  // namespace

SelfIntersections find_self_intersections(const InterfaceComplex& complex, int threads, std::size_t limit) {
  const auto& points = complex.points;
  const auto& triangles = complex.triangles;
  SelfIntersections result;
  std::vector<Box> boxes(triangles.size());
  std::vector<char> flat(triangles.size(), 0);
  constexpr std::size_t kChunk = 4096;
  parallel_for((triangles.size() + kChunk - 1) / kChunk, threads, [&](std::size_t chunk) {
    for (std::size_t t = chunk * kChunk; t < std::min(triangles.size(), (chunk + 1) * kChunk); ++t) {
      const auto& v = triangles[t].v;
      for (int k = 0; k < 3; ++k) boxes[t].add(points[v[k]]);
      flat[t] = exact_collinear(points[v[0]], points[v[1]], points[v[2]]);
    }
  });
  for (std::size_t t = 0; t < triangles.size(); ++t)
    if (flat[t]) {
      ++result.degenerate;
      if (result.pairs.size() < limit)
        result.pairs.push_back({static_cast<std::int32_t>(t), static_cast<std::int32_t>(t)});
    }
  result.count = result.degenerate;

  const BoxTree tree(boxes);
  const std::size_t chunks = (tree.leaves() + kChunk - 1) / kChunk;
  struct Found {
    std::size_t count = 0;
    std::vector<Pair> pairs;
  };
  std::vector<Found> found(chunks);
  parallel_for(chunks, threads, [&](std::size_t chunk) {
    Found& mine = found[chunk];
    for (std::size_t leaf = chunk * kChunk; leaf < std::min(tree.leaves(), (chunk + 1) * kChunk); ++leaf)
      tree.pairs_of_leaf(leaf, [&](std::int32_t i, std::int32_t j) {
        if (flat[i] || flat[j] || !triangles_collide(points, triangles[i].v, triangles[j].v)) return;
        ++mine.count;
        mine.pairs.push_back({std::min(i, j), std::max(i, j)});
        if (mine.pairs.size() > 4 * limit + 64) keep_first(mine.pairs, limit);
      });
  });
  for (const Found& f : found) {
    result.count += f.count;
    result.pairs.insert(result.pairs.end(), f.pairs.begin(), f.pairs.end());
  }
  keep_first(result.pairs, limit);
  return result;
}

}  // namespace stackmesh
