#include "sections/masked_section.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "planar/planar.h"
#include "planar/snap_rounding.h"

namespace stackmesh {
namespace {

/// A noded edge, and the labels that change over it.
struct MaskedEdge {
  std::int32_t a, b;
  LabelMask mask;
};

/// Noded edges with the labels that change over them; what is walked twice cancels.
std::vector<MaskedEdge> merge(const NodedSegments& noded, const std::vector<SourceSegment>& sources) {
  std::vector<MaskedEdge> edges;
  for (const NodedEdge& e : noded.edges)
    edges.push_back({std::min(e.a, e.b), std::max(e.a, e.b), LabelMask(1) << sources[e.source].file});
  std::sort(edges.begin(), edges.end(),
            [](const MaskedEdge& u, const MaskedEdge& v) { return u.a != v.a ? u.a < v.a : u.b < v.b; });
  std::size_t kept = 0;
  for (std::size_t i = 0, j; i < edges.size(); i = j) {
    MaskedEdge sum = edges[i];
    for (j = i + 1; j < edges.size() && edges[j].a == sum.a && edges[j].b == sum.b; ++j) sum.mask ^= edges[j].mask;
    if (sum.mask.any()) edges[kept++] = sum;
  }
  edges.resize(kept);
  return edges;
}

std::pair<FaceHandle, FaceHandle> sides(const Cdt& cdt, VertexHandle a, VertexHandle b) {
  FaceHandle face;
  int i = 0;
  if (!cdt.is_edge(a, b, face, i))
    fail_internal("a contour edge is missing in the triangulation", "orienting contours");
  const FaceHandle other = face->neighbor(i);
  return face->vertex(Cdt::ccw(i)) == a ? std::make_pair(face, other) : std::make_pair(other, face);
}

/// Regions grown without crossing a contour (paper 3.1.2), then which labels cover each, from the outside in.
std::vector<LabelMask> grow_regions(Cdt& cdt, const std::vector<VertexHandle>& handles,
                                    const std::vector<MaskedEdge>& edges) {
  std::int32_t regions = 0;
  const auto grow = [&](FaceHandle start) {
    std::vector<FaceHandle> stack = {start};
    start->info().sheet = regions;
    while (!stack.empty()) {
      const FaceHandle f = stack.back();
      stack.pop_back();
      for (int i = 0; i < 3; ++i)
        if (!f->is_constrained(i) && f->neighbor(i)->info().sheet < 0) {
          f->neighbor(i)->info().sheet = regions;
          stack.push_back(f->neighbor(i));
        }
    }
    ++regions;
  };
  grow(cdt.infinite_face());
  for (const FaceHandle f : cdt.all_face_handles())
    if (f->info().sheet < 0) grow(f);
  std::vector<std::vector<std::pair<std::int32_t, LabelMask>>> beside(regions);
  for (const MaskedEdge& e : edges) {
    const auto [left, right] = sides(cdt, handles[e.a], handles[e.b]);
    beside[left->info().sheet].emplace_back(right->info().sheet, e.mask);
    beside[right->info().sheet].emplace_back(left->info().sheet, e.mask);
  }
  std::vector<LabelMask> mask(regions);
  std::vector<char> known(regions, 0);
  std::vector<std::int32_t> stack = {0};
  known[0] = 1;
  while (!stack.empty()) {
    const std::int32_t r = stack.back();
    stack.pop_back();
    for (const auto& [next, change] : beside[r])
      if (!known[next]) {
        known[next] = 1;
        mask[next] = mask[r] ^ change;
        stack.push_back(next);
      }
  }
  return mask;
}

}  // namespace

void mask_regions(std::vector<GridSegment> segments, const std::vector<SourceSegment>& sources, MaskedSection& out,
                  const VisitArea& visit) {
  NodedSegments noded = std::move(node_segments({std::move(segments)}, 1)[0]);
  const std::vector<MaskedEdge> edges = merge(noded, sources);
  if (edges.empty()) return;

  Cdt cdt;
  std::vector<VertexHandle> handles;
  for (const GridPoint p : noded.points) handles.push_back(cdt.insert(PlanarPoint(p.x, p.y)));
  for (const MaskedEdge& e : edges) cdt.insert_constraint(handles[e.a], handles[e.b]);
  const std::vector<LabelMask> region_mask = grow_regions(cdt, handles, edges);
  for (const FaceHandle f : cdt.finite_face_handles())
    visit(region_mask[f->info().sheet], std::abs(cdt.triangle(f).area()));
  out.section.points = std::move(noded.points);
  for (const MaskedEdge& e : edges) {
    const auto [left, right] = sides(cdt, handles[e.a], handles[e.b]);
    out.edges.push_back({e.a, e.b, region_mask[left->info().sheet], region_mask[right->info().sheet]});
  }
}

}  // namespace stackmesh
