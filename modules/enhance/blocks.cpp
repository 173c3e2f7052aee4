#include "enhance/blocks.h"

#include <algorithm>
#include <limits>

#include "base/parallel.h"

namespace stackmesh {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

double coordinate(const Vec3& p, int axis) {
  return axis == 0 ? p.x : axis == 1 ? p.y : p.z;
}
double& coordinate(Vec3& p, int axis) {
  return axis == 0 ? p.x : axis == 1 ? p.y : p.z;
}

/// Space halved again and again; leaves are the boxes.
class SpaceTree {
 public:
  SpaceTree(const ComplexMesh& mesh, std::size_t vertices_each, double cut)
      : mesh_(mesh), each_(vertices_each), cut_(cut) {
    std::vector<std::int32_t> all;
    for (std::int32_t v = 0; v < static_cast<std::int32_t>(mesh.points.size()); ++v)
      if (!mesh.star[v].empty()) all.push_back(v);
    halve(all.begin(), all.end(), {-kFar, -kFar, -kFar}, {kFar, kFar, kFar});
  }

  struct Leaf {
    Vec3 low, high;
  };
  std::vector<Leaf> leaves;

  /// Calls visit(leaf) for all leaves that the box meets.
  template <class Visit>
  void meets(const Vec3& low, const Vec3& high, Visit visit) const {
    std::int32_t stack[64], depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
      const Node& n = nodes_[stack[--depth]];
      if (n.leaf >= 0) {
        visit(n.leaf);
        continue;
      }
      if (coordinate(high, n.axis) >= n.at) stack[depth++] = n.above;
      if (coordinate(low, n.axis) <= n.at) stack[depth++] = n.below;
    }
  }

 private:
  using Iterator = std::vector<std::int32_t>::iterator;
  struct Node {
    int axis = 0;
    double at = 0;
    std::int32_t below = -1, above = -1, leaf = -1;
  };

  std::int32_t halve(Iterator first, Iterator last, Vec3 low, Vec3 high) {
    const auto here = static_cast<std::int32_t>(nodes_.size());
    nodes_.emplace_back();
    const auto count = static_cast<std::size_t>(last - first);
    if (count <= each_) {
      nodes_[here].leaf = static_cast<std::int32_t>(leaves.size());
      leaves.push_back({low, high});
      return here;
    }
    Vec3 least{kFar, kFar, kFar}, most{-kFar, -kFar, -kFar};
    for (Iterator i = first; i != last; ++i)
      for (int k = 0; k < 3; ++k) {
        const double x = coordinate(mesh_.points[*i], k);
        coordinate(least, k) = std::min(coordinate(least, k), x);
        coordinate(most, k) = std::max(coordinate(most, k), x);
      }
    const Vec3 d = most - least;
    const int axis = d.x >= d.y && d.x >= d.z ? 0 : d.y >= d.z ? 1 : 2;
    const Iterator middle = first + static_cast<std::ptrdiff_t>(cut_ * static_cast<double>(count));
    std::nth_element(first, middle, last, [&](std::int32_t a, std::int32_t b) {
      const double x = coordinate(mesh_.points[a], axis), y = coordinate(mesh_.points[b], axis);
      return x < y || (x == y && a < b);
    });
    const double at = coordinate(mesh_.points[*middle], axis);
    Vec3 high_below = high, low_above = low;
    coordinate(high_below, axis) = coordinate(low_above, axis) = at;
    const std::int32_t below = halve(first, middle, low, high_below), above = halve(middle, last, low_above, high);
    nodes_[here].axis = axis;
    nodes_[here].at = at;
    nodes_[here].below = below;
    nodes_[here].above = above;
    return here;
  }

  const ComplexMesh& mesh_;
  std::size_t each_;
  double cut_;
  std::vector<Node> nodes_;
};

}  // namespace

std::vector<MeshBlock> cut_into_blocks(const ComplexMesh& mesh, const std::vector<double>& size,
                                       const std::vector<std::int32_t>& hints, std::size_t vertices_each, double cut,
                                       double margin_mm, int threads) {
  const SpaceTree tree(mesh, vertices_each, cut);
  std::vector<std::vector<std::int32_t>> inside(tree.leaves.size()), halo(tree.leaves.size());
  std::vector<std::int32_t> met;
  for (std::int32_t t = 0; t < static_cast<std::int32_t>(mesh.triangles.size()); ++t) {
    if (!mesh.alive(t)) continue;
    const auto& v = mesh.triangles[t].v;
    const Vec3 &a = mesh.points[v[0]], &b = mesh.points[v[1]], &c = mesh.points[v[2]],
               m{margin_mm, margin_mm, margin_mm};
    const Vec3 low = Vec3{std::min({a.x, b.x, c.x}), std::min({a.y, b.y, c.y}), std::min({a.z, b.z, c.z})} - m;
    const Vec3 high = Vec3{std::max({a.x, b.x, c.x}), std::max({a.y, b.y, c.y}), std::max({a.z, b.z, c.z})} + m;
    met.clear();
    tree.meets(low, high, [&](std::int32_t leaf) { met.push_back(leaf); });
    if (met.size() == 1) inside[met[0]].push_back(t);
    else
      for (std::int32_t leaf : met) halo[leaf].push_back(t);
  }
  std::vector<MeshBlock> blocks(tree.leaves.size());
  parallel_for(blocks.size(), threads, [&](std::size_t i) {
    MeshBlock& b = blocks[i];
    b.triangles = std::move(inside[i]);
    const std::size_t free = b.triangles.size();
    b.triangles.insert(b.triangles.end(), halo[i].begin(), halo[i].end());
    b.mesh = mesh.part(b.triangles, free, b.vertices);
    const Vec3 m{margin_mm, margin_mm, margin_mm};
    b.mesh.low = tree.leaves[i].low + m;
    b.mesh.high = tree.leaves[i].high - m;
    for (std::int32_t v : b.vertices) {
      b.size.push_back(size[v]);
      b.hints.push_back(hints[v]);
    }
  });
  return blocks;
}

void join_blocks(ComplexMesh& mesh, std::vector<double>& size, std::vector<std::int32_t>& hints,
                 const std::vector<MeshBlock>& blocks) {
  std::vector<std::vector<std::int32_t>> numbers(blocks.size());
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const MeshBlock& b = blocks[i];
    numbers[i] = b.vertices;
    for (std::size_t v = b.vertices.size(); v < b.mesh.points.size(); ++v) {
      numbers[i].push_back(static_cast<std::int32_t>(mesh.points.size()));
      mesh.points.emplace_back();
      mesh.pinned.push_back(0);
      mesh.flat.push_back(0);
      mesh.curve.emplace_back();
      size.push_back(0);
      hints.push_back(-1);
    }
    // A vertex belongs to the block that has a triangle of it that is not frozen; no other one does.
    for (std::size_t v = 0; v < numbers[i].size(); ++v) {
      const std::int32_t g = numbers[i][v];
      if (!b.mesh.owned(static_cast<std::int32_t>(v))) continue;
      mesh.points[g] = b.mesh.points[v];
      mesh.pinned[g] = b.mesh.pinned[v];
      mesh.flat[g] = b.mesh.flat[v];
      size[g] = b.size[v];
      hints[g] = b.hints[v];
      mesh.curve[g].clear();
      for (std::int32_t c : b.mesh.curve[v]) mesh.curve[g].push_back(numbers[i][c]);
    }
    for (std::size_t t = 0; t < b.mesh.triangles.size(); ++t) {
      if (b.mesh.frozen[t]) continue;
      MeshTriangle m = b.mesh.triangles[t];
      for (std::int32_t& v : m.v) v = numbers[i][v];
      if (t < b.triangles.size()) mesh.triangles[b.triangles[t]] = m;
      else mesh.triangles.push_back(m);
    }
  }
  mesh.compact(size, hints);
}

}  // namespace stackmesh
