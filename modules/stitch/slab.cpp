#include "stitch/slab.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "planar/planar.h"
#include "stitch/slab_heights.h"
#include "stitch/slab_sheets.h"

namespace stackmesh {
namespace {

/// A 3-D vertex above a vertex of the plane.
struct Level {
  std::int32_t next;
  double height;
  std::int32_t out;
};

class SlabStitcher {
 public:
  explicit SlabStitcher(const SlabInput& input) : in_(input) {}

  SlabSurface run() {
    find_sheets(in_, p_);
    if (cdt().dimension() < 2) return {};
    out_.added_points = p_.added_points;
    place_heights(in_, p_);
    make_vertices();
    emit_sheets();
    emit_walls();
    return std::move(out_);
  }

 private:
  Cdt& cdt() { return p_.plane.cdt; }
  static std::int32_t id(VertexHandle v) { return v->info(); }

  /// The 3-D vertices of all copies.
  void make_vertices() {
    const auto n = static_cast<std::int32_t>(p_.plane.vertices.size());
    first_level_.assign(p_.plane.vertices.size(), -1);
    for (std::int32_t v = 0; v < n; ++v)
      for (std::int32_t k = p_.first_copy[v]; k >= 0; k = p_.copies[k].next)
        p_.copies[k].out = vertex_at(v, p_.copies[k].height);
  }

  /// The 3-D vertex over v at that height: a section's own point at 0 and 1, else one of the slab.
  std::int32_t vertex_at(std::int32_t v, double height) {
    const PlanarVertex& planar = p_.plane.vertices[v];
    if (height == 0 && planar.lower >= 0) return planar.lower;
    if (height == 1 && planar.upper >= 0) return planar.upper + static_cast<std::int32_t>(in_.lower->points.size());
    for (std::int32_t k = first_level_[v]; k >= 0; k = levels_[k].next)
      if (levels_[k].height == height) return levels_[k].out;
    const PlanarPoint& p = p_.plane.handles[v]->point();
    const std::int32_t out =
        static_cast<std::int32_t>(in_.lower->points.size() + in_.upper->points.size() + out_.points.size());
    out_.points.push_back({p.x(), p.y(), in_.z_low_mm + height * (in_.z_high_mm - in_.z_low_mm)});
    levels_.push_back({first_level_[v], height, out});
    first_level_[v] = static_cast<std::int32_t>(levels_.size() - 1);
    return out;
  }

  const SheetVertex& copy_of(VertexHandle v, FaceHandle f) {
    for (std::int32_t k = p_.first_copy[id(v)]; k >= 0; k = p_.copies[k].next)
      if (p_.copies[k].sheet == f->info().sheet) return p_.copies[k];
    fail_internal("a sheet has no copy of one of its vertices", "stitching");
  }

  /// Lifts the triangles of the domain (paper 2): l beneath, u above.
  void emit_sheets() {
    for (const FaceHandle f : cdt().finite_face_handles()) {
      if (!f->info().in_domain()) continue;
      SlabSurface::Triangle t;
      for (int i = 0; i < 3; ++i) t.v[i] = copy_of(f->vertex(i), f).out;
      t.below = f->info().lower;
      t.above = f->info().upper;
      out_.triangles.push_back(t);
    }
  }

  /// The 3-D vertices over v between two heights, from low to high.
  void chain(VertexHandle handle, double low, double high, std::vector<std::pair<double, std::int32_t>>& out) {
    const std::int32_t v = id(handle);
    out.clear();
    const PlanarVertex& planar = p_.plane.vertices[v];
    if (low == 0 && planar.lower >= 0) out.emplace_back(0.0, vertex_at(v, 0));
    for (std::int32_t k = first_level_[v]; k >= 0; k = levels_[k].next)
      if (levels_[k].height >= low && levels_[k].height <= high) out.emplace_back(levels_[k].height, levels_[k].out);
    if (high == 1 && planar.upper >= 0) out.emplace_back(1.0, vertex_at(v, 1));
    std::sort(out.begin(), out.end());
  }

  /// A wall over edge v -> w between heights (v_low, w_low) and (v_high, w_high): `left` on the left of the edge.
  void emit_wall(VertexHandle v, VertexHandle w, std::array<double, 2> low, std::array<double, 2> high, Label left,
                 Label right) {
    if (left == right || (low[0] == high[0] && low[1] == high[1])) return;
    chain(v, low[0], high[0], chain_v_);
    chain(w, low[1], high[1], chain_w_);
    std::size_t i = 0, j = 0;
    while (i + 1 < chain_v_.size() || j + 1 < chain_w_.size()) {
      bool step_v = j + 1 == chain_w_.size();
      if (!step_v && i + 1 < chain_v_.size()) {  // the shorter diagonal; ties by vertex number
        const double dv = std::abs(chain_v_[i + 1].first - chain_w_[j].first);
        const double dw = std::abs(chain_w_[j + 1].first - chain_v_[i].first);
        step_v = dv < dw || (dv == dw && id(v) < id(w));
      }
      if (step_v) {
        out_.triangles.push_back({{chain_v_[i].second, chain_w_[j].second, chain_v_[i + 1].second}, left, right});
        ++i;
      } else {
        out_.triangles.push_back({{chain_v_[i].second, chain_w_[j].second, chain_w_[j + 1].second}, left, right});
        ++j;
      }
    }
  }

  /// Over every contour edge, closes the gap between the columns on its two sides (this covers the paper's 3.4:
  /// crossings and overlapping edges).
  void emit_walls() {
    for (const PlanarEdge& e : p_.plane.edges) {
      const VertexHandle v = p_.plane.handles[e.a], w = p_.plane.handles[e.b];
      FaceHandle left, right;
      int i = 0;
      if (!cdt().is_edge(v, w, left, i)) fail_internal("a contour edge was lost", "stitching");
      right = left->neighbor(i);
      if (left->vertex(Cdt::ccw(i)) != v) std::swap(left, right);
      const PlanarFace &l = left->info(), &r = right->info();
      std::array<double, 2> hl{}, hr{};
      if (l.in_domain()) hl = {copy_of(v, left).height, copy_of(w, left).height};
      if (r.in_domain()) hr = {copy_of(v, right).height, copy_of(w, right).height};
      if (!l.in_domain()) hl = r.in_domain() ? hr : std::array<double, 2>{1, 1};
      if (!r.in_domain()) hr = hl;
      constexpr std::array<double, 2> bottom = {0, 0}, top = {1, 1};
      const bool left_beneath = hl[0] <= hr[0] && hl[1] <= hr[1];
      if (!left_beneath && (hl[0] < hr[0] || hl[1] < hr[1]))
        fail_internal("two sheets cross over a contour edge", "stitching");
      const auto& first = left_beneath ? hl : hr;
      const auto& second = left_beneath ? hr : hl;
      emit_wall(v, w, bottom, first, l.lower, r.lower);
      if (left_beneath) emit_wall(v, w, first, second, l.upper, r.lower);
      else emit_wall(v, w, first, second, l.lower, r.upper);
      emit_wall(v, w, second, top, l.upper, r.upper);
    }
  }

  const SlabInput& in_;
  SlabPlane p_;
  SlabSurface out_;
  std::vector<std::int32_t> first_level_;
  std::vector<Level> levels_;
  std::vector<std::pair<double, std::int32_t>> chain_v_, chain_w_;
};

}  // namespace

SlabSurface stitch_slab(const SlabInput& input) {
  return SlabStitcher(input).run();
}

}  // namespace stackmesh
