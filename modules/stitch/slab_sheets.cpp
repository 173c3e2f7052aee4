#include "stitch/slab_sheets.h"

#include <algorithm>
#include <utility>

#include "base/error.h"
#include "stitch/sheet_layers.h"

namespace stackmesh {
namespace {

class SheetFinder {
 public:
  SheetFinder(const SlabInput& input, SlabPlane& out) : in_(input), out_(out) {}

  void run() {
    build_plane(*in_.lower, *in_.upper, in_.scale_x, in_.scale_y, out_.plane);
    if (out_.plane.cdt.dimension() < 2) return;
    find_sheets();
    split_single_sheets();
    order_sheets();
    mark_copies();
    add_points();
  }

 private:
  Cdt& cdt() { return out_.plane.cdt; }
  static std::int32_t id(VertexHandle v) { return v->info(); }

  /// Do the triangles on both sides of edge (face, i) belong to one sheet?
  static bool continues(FaceHandle face, int i) {
    return face->info().edge[i] != kBoth && face->neighbor(i)->info().in_domain();
  }

  template <class Continues>
  void flood_sheet(FaceHandle start, std::int32_t sheet, Continues go_on) {
    std::vector<FaceHandle> stack = {start};
    start->info().sheet = sheet;
    while (!stack.empty()) {
      const FaceHandle face = stack.back();
      stack.pop_back();
      for (int i = 0; i < 3; ++i) {
        const FaceHandle next = face->neighbor(i);
        if (next->info().sheet == sheet || !go_on(face, i)) continue;
        next->info().sheet = sheet;
        stack.push_back(next);
      }
    }
  }

  /// The parametric domain D = {l != u} (paper 3.2.2) as sheets; what bounds each.
  void find_sheets() {
    for (const FaceHandle f : cdt().finite_face_handles())
      if (f->info().in_domain() && f->info().sheet < 0) {
        flood_sheet(f, static_cast<std::int32_t>(out_.sheets.size()), continues);
        out_.sheets.emplace_back();
      }
    for (const FaceHandle f : cdt().finite_face_handles())
      if (f->info().in_domain())
        for (int i = 0; i < 3; ++i)
          if (!continues(f, i)) out_.sheets[f->info().sheet].rims |= rim_bit(f->info().edge[i]);
  }

  static std::uint8_t rim_bit(std::uint8_t edge_of) {
    return edge_of == kBoth ? kRimBoth : edge_of == kLower ? kRimLower : kRimUpper;
  }

  /// Its shape and scale.
  std::pair<EndShape, double> end_shape(const PlanarFace& face, bool upward) const {
    const auto& ends = upward ? in_.upward_ends : in_.downward_ends;
    const Label label = upward ? face.lower : face.upper;
    const auto it =
        std::lower_bound(ends.begin(), ends.end(), label, [](const SlabEnd& e, Label l) { return e.label < l; });
    return it != ends.end() && it->label == label ? std::make_pair(it->shape, it->scale)
                                                  : std::make_pair(EndShape::round, 1.0);
  }

  /// A sheet that a single section bounds is an end: its labels may end in different shapes, so it is cut into
  /// one sheet a shape (the seams between them carry a wall).
  void split_single_sheets() {
    const std::size_t n = out_.sheets.size();
    std::vector<char> done(n, 0);
    for (const FaceHandle f : cdt().finite_face_handles()) {
      const std::int32_t s = f->info().sheet;
      if (s < 0 || static_cast<std::size_t>(s) >= n || !out_.sheets[s].is_single()) continue;
      const bool upward = out_.sheets[s].rims == kRimLower;
      const auto shape = end_shape(f->info(), upward);
      std::int32_t target = s;
      if (done[s]) {
        target = static_cast<std::int32_t>(out_.sheets.size());
        out_.sheets.emplace_back();
        out_.sheets[target].rims = out_.sheets[s].rims;
      }
      done[s] = 1;
      out_.sheets[target].end = shape.first;
      out_.sheets[target].scale = shape.second;
      out_.sheets[target].flat = shape.first != EndShape::round;
      // Faces of the first shape keep the number; mark them through a temporary one so that the flood ends.
      const std::int32_t temporary = 0x40000000 + static_cast<std::int32_t>(renumber_.size());
      flood_sheet(f, temporary, [&](FaceHandle face, int i) {
        const PlanarFace& next = face->neighbor(i)->info();
        return continues(face, i) && next.sheet == s && end_shape(next, upward) == shape;
      });
      renumber_.emplace_back(temporary, target);
    }
    if (renumber_.empty()) return;
    std::sort(renumber_.begin(), renumber_.end());
    for (const FaceHandle f : cdt().finite_face_handles()) {
      const auto it = std::lower_bound(renumber_.begin(), renumber_.end(), std::make_pair(f->info().sheet, -1));
      if (it != renumber_.end() && it->first == f->info().sheet) f->info().sheet = it->second;
    }
  }

  /// Where two sheets meet over a coincident edge, the one that passes beneath decides which labels meet between
  /// them. Parts of a label that only touch there stay apart (labels are 6-connected, as in the image): the sheets
  /// are ordered so that they do, or share their rim where either order would join something. Layers are that order.
  void order_sheets() {
    std::vector<std::pair<std::int32_t, std::int32_t>> below;  // (lower sheet, higher sheet)
    DisjointSets same(out_.sheets.size());                     // sheets that share their rims
    for (const FaceHandle f : cdt().finite_face_handles()) {
      const PlanarFace& left = f->info();
      if (!left.in_domain()) continue;
      for (int i = 0; i < 3; ++i) {
        const PlanarFace& right = f->neighbor(i)->info();
        if (left.edge[i] != kBoth || !right.in_domain() || left.sheet >= right.sheet) continue;
        const bool not_beneath = left.upper == right.lower && left.upper != 0;  // left beneath right would join a label
        const bool not_above = left.lower == right.upper && left.lower != 0;
        if (not_beneath && not_above) same.join(left.sheet, right.sheet);
        else if (not_beneath) below.emplace_back(right.sheet, left.sheet);
        else if (not_above) below.emplace_back(left.sheet, right.sheet);
      }
    }
    const std::vector<int> layers = sheet_layers(std::move(below), std::move(same));
    for (std::size_t s = 0; s < out_.sheets.size(); ++s) out_.sheets[s].layer = layers[s];
  }

  /// One copy per vertex and sheet, with what the sheet's rim is like there.
  void mark_copies() {
    out_.first_copy.assign(out_.plane.vertices.size(), -1);
    out_.copies.reserve(2 * out_.plane.vertices.size());
    for (const FaceHandle f : cdt().finite_face_handles()) {
      if (!f->info().in_domain()) continue;
      const std::int32_t sheet = f->info().sheet;
      std::array<std::int32_t, 3> copy;
      for (int i = 0; i < 3; ++i) copy[i] = out_.copy_index(id(f->vertex(i)), sheet);
      for (int i = 0; i < 3; ++i) {
        const std::uint8_t of = f->info().edge[i];
        if (of == kNone) continue;
        std::uint8_t bit = rim_bit(of);
        if (continues(f, i)) bit = of == kLower ? kInnerLower : kInnerUpper;
        for (const int end : {Cdt::cw(i), Cdt::ccw(i)}) {
          out_.copies[copy[end]].rim |= bit;
          if (!(bit & (kInnerLower | kInnerUpper)) && out_.copies[copy[end]].rim_edges < 255)
            ++out_.copies[copy[end]].rim_edges;
        }
      }
    }
  }

  bool lies_flat(FaceHandle f, int i, double& level) {
    const double a = SlabPlane::rim_height(out_.copies[out_.copy_index(id(f->vertex(Cdt::cw(i))), f->info().sheet)]);
    const double b = SlabPlane::rim_height(out_.copies[out_.copy_index(id(f->vertex(Cdt::ccw(i))), f->info().sheet)]);
    level = a;
    return a == b && a != kHalfGap;
  }

  /// Intermediate points (paper 3.3) by what is lifted: an unconstrained edge that would lie in a section gets
  /// its midpoint, a triangle that still would, its centroid. New edges all end in the new point, which lies
  /// between the sections, so one pass is enough.
  void add_points() {
    std::vector<std::pair<VertexHandle, VertexHandle>> flat;
    double level = 0;
    for (const FaceHandle f : cdt().finite_face_handles()) {
      if (!f->info().in_domain() || out_.sheets[f->info().sheet].flat) continue;
      for (int i = 0; i < 3; ++i)
        if (f->info().edge[i] == kNone && &*f < &*f->neighbor(i) && lies_flat(f, i, level))
          flat.emplace_back(f->vertex(Cdt::ccw(i)), f->vertex(Cdt::cw(i)));
    }
    // Handle order is allocation order; vertex numbers are the same from run to run.
    for (auto& e : flat)
      if (id(e.first) > id(e.second)) std::swap(e.first, e.second);
    std::sort(flat.begin(), flat.end(), [](const auto& a, const auto& b) {
      return id(a.first) != id(b.first) ? id(a.first) < id(b.first) : id(a.second) < id(b.second);
    });
    for (const auto& e : flat) {
      FaceHandle f;
      int i = 0;
      if (!cdt().is_edge(e.first, e.second, f, i)) continue;  // an earlier point flipped it away
      insert_point(CGAL::midpoint(e.first->point(), e.second->point()), Cdt::EDGE, f, i);
    }
    std::vector<FaceHandle> triangles;
    for (const FaceHandle f : cdt().finite_face_handles()) {
      if (!f->info().in_domain() || out_.sheets[f->info().sheet].flat) continue;
      std::array<double, 3> h;
      for (int i = 0; i < 3; ++i)
        h[i] = SlabPlane::rim_height(out_.copies[out_.copy_index(id(f->vertex(i)), f->info().sheet)]);
      if (h[0] == h[1] && h[1] == h[2] && h[0] != kHalfGap) triangles.push_back(f);
    }
    for (FaceHandle f : triangles) insert_point(inner_point(f), Cdt::FACE, f, 0);
  }

  static PlanarPoint inner_point(FaceHandle f) {
    const PlanarPoint &a = f->vertex(0)->point(), &b = f->vertex(1)->point(), &c = f->vertex(2)->point();
    const PlanarPoint p = CGAL::centroid(a, b, c);
    if (CGAL::orientation(a, b, p) != CGAL::LEFT_TURN || CGAL::orientation(b, c, p) != CGAL::LEFT_TURN ||
        CGAL::orientation(c, a, p) != CGAL::LEFT_TURN)
      fail_internal("a triangle of the plane is too thin to hold a point", "stitching");
    return p;
  }

  void insert_point(const PlanarPoint& p, Cdt::Locate_type where, FaceHandle f, int i) {
    const PlanarFace labels = f->info();
    const VertexHandle v = cdt().insert(p, where, f, i);
    v->info() = static_cast<std::int32_t>(out_.plane.vertices.size());
    out_.plane.vertices.emplace_back();
    out_.plane.handles.push_back(v);
    out_.first_copy.push_back(-1);
    out_.copy_index(id(v), labels.sheet);
    // All triangles that the insertion changed are around v and within the same region.
    Cdt::Face_circulator around = cdt().incident_faces(v), end = around;
    do {
      PlanarFace& info = around->info();
      info.lower = labels.lower;
      info.upper = labels.upper;
      info.sheet = labels.sheet;
    } while (++around != end);
    ++out_.added_points;
  }

  const SlabInput& in_;
  SlabPlane& out_;
  std::vector<std::pair<std::int32_t, std::int32_t>> renumber_;
};

}  // namespace

std::int32_t SlabPlane::copy_index(std::int32_t vertex, std::int32_t sheet) {
  for (std::int32_t k = first_copy[vertex]; k >= 0; k = copies[k].next)
    if (copies[k].sheet == sheet) return k;
  copies.push_back({first_copy[vertex], sheet, 0, 0, 0.0, -1});
  return first_copy[vertex] = static_cast<std::int32_t>(copies.size() - 1);
}

double SlabPlane::rim_height(const SheetVertex& c) {
  const std::uint8_t rim = c.rim & (kRimLower | kRimUpper | kRimBoth);
  if (rim == kRimLower && !(c.rim & kInnerUpper)) return 0;
  if (rim == kRimUpper && !(c.rim & kInnerLower)) return 1;
  return kHalfGap;
}

void find_sheets(const SlabInput& input, SlabPlane& plane) {
  SheetFinder(input, plane).run();
}

}  // namespace stackmesh
