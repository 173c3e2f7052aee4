#include "stitch/slab.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "planar/planar.h"
#include "stitch/segment_distance.h"
#include "stitch/sheet_layers.h"

namespace stackmesh {
namespace {

constexpr double kHalf = 0.5;                        // where an end stands that has no partner, in gaps
constexpr double kRimRise = 0.45, kPeakRise = 0.95;  // limits of a round end's rim and peak, in gaps
constexpr double kMostBulge = 2.5;                   // limit of the exponent of equation (1), and of its inverse
constexpr double kLowest = 0.02, kHighest = 0.98;    // clamp of equation (1)

/// What the rim of a sheet is like at one of its vertices.
enum RimBits : std::uint8_t {
  kRimLower = 1,    // an edge of the lower section alone
  kRimUpper = 2,    // an edge of the upper section alone
  kRimBoth = 4,     // an edge of both
  kInnerLower = 8,  // an edge of the lower section that the sheet passes over (the groove of docs/stitching.md)
  kInnerUpper = 16
};

/// A vertex of the plane as one sheet sees it.
struct Copy {
  std::int32_t next;  // the same vertex in another sheet
  std::int32_t sheet;
  std::uint8_t rim;
  std::uint8_t rim_edges;  // edges of the sheet's rim that meet here
  double height;           // 0 lower section .. 1 upper section; set by place_copies
  std::int32_t out;        // number of the 3-D vertex
};

/// A maximal set of triangles with l != u that is not cut by a coincident edge: one continuous height field.
struct Sheet {
  std::uint8_t rims = 0;  // union over its rim edges
  EndShape end = EndShape::round;
  double scale = 1;                    // of a round end: SlabEnd::scale
  bool flat = false;                   // an end of a single section that is closed by a plane
  bool has_inner = false;              // has vertices that are neither on its rim nor flat
  int layer = 0;                       // order of sheets that meet over a coincident edge
  double reach = 0;                    // largest distance of an inner vertex from the rim
  double exponent = 1;                 // of equation (1)
  double rim_rise = 0, dome_rise = 0;  // of a round end: height = rim_rise + dome_rise * the dome's profile
  SegmentDistance lower, upper;
  bool single() const { return rims == kRimLower || rims == kRimUpper; }
};

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
    build_plane(*in_.lower, *in_.upper, in_.scale_x, in_.scale_y, plane_);
    if (plane_.cdt.dimension() < 2) return {};
    find_sheets();
    split_single_sheets();
    order_sheets();
    mark_copies();
    add_points();
    place_copies();
    emit_sheets();
    emit_walls();
    return std::move(out_);
  }

 private:
  Cdt& cdt() { return plane_.cdt; }
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
        flood_sheet(f, static_cast<std::int32_t>(sheets_.size()), continues);
        sheets_.emplace_back();
      }
    for (const FaceHandle f : cdt().finite_face_handles())
      if (f->info().in_domain())
        for (int i = 0; i < 3; ++i)
          if (!continues(f, i)) sheets_[f->info().sheet].rims |= rim_bit(f->info().edge[i]);
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
    const std::size_t n = sheets_.size();
    std::vector<char> done(n, 0);
    for (const FaceHandle f : cdt().finite_face_handles()) {
      const std::int32_t s = f->info().sheet;
      if (s < 0 || static_cast<std::size_t>(s) >= n || !sheets_[s].single()) continue;
      const bool upward = sheets_[s].rims == kRimLower;
      const auto shape = end_shape(f->info(), upward);
      std::int32_t target = s;
      if (done[s]) {
        target = static_cast<std::int32_t>(sheets_.size());
        sheets_.emplace_back();
        sheets_[target].rims = sheets_[s].rims;
      }
      done[s] = 1;
      sheets_[target].end = shape.first;
      sheets_[target].scale = shape.second;
      sheets_[target].flat = shape.first != EndShape::round;
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
    DisjointSets same(sheets_.size());                         // sheets that share their rims
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
    for (std::size_t s = 0; s < sheets_.size(); ++s) sheets_[s].layer = layers[s];
  }

  std::int32_t copy_index(std::int32_t vertex, std::int32_t sheet) {
    for (std::int32_t k = first_copy_[vertex]; k >= 0; k = copies_[k].next)
      if (copies_[k].sheet == sheet) return k;
    copies_.push_back({first_copy_[vertex], sheet, 0, 0, 0.0, -1});
    return first_copy_[vertex] = static_cast<std::int32_t>(copies_.size() - 1);
  }

  /// One copy per vertex and sheet, with what the sheet's rim is like there.
  void mark_copies() {
    first_copy_.assign(plane_.vertices.size(), -1);
    copies_.reserve(2 * plane_.vertices.size());
    for (const FaceHandle f : cdt().finite_face_handles()) {
      if (!f->info().in_domain()) continue;
      const std::int32_t sheet = f->info().sheet;
      std::array<std::int32_t, 3> copy;
      for (int i = 0; i < 3; ++i) copy[i] = copy_index(id(f->vertex(i)), sheet);
      for (int i = 0; i < 3; ++i) {
        const std::uint8_t of = f->info().edge[i];
        if (of == kNone) continue;
        std::uint8_t bit = rim_bit(of);
        if (continues(f, i)) bit = of == kLower ? kInnerLower : kInnerUpper;
        for (const int end : {Cdt::cw(i), Cdt::ccw(i)}) {
          copies_[copy[end]].rim |= bit;
          if (!(bit & (kInnerLower | kInnerUpper)) && copies_[copy[end]].rim_edges < 255)
            ++copies_[copy[end]].rim_edges;
        }
      }
    }
  }

  /// 0 or 1 where a copy lies on a section, else kHalf (between the sections).
  double rim_height(const Copy& c) const {
    const std::uint8_t rim = c.rim & (kRimLower | kRimUpper | kRimBoth);
    if (rim == kRimLower && !(c.rim & kInnerUpper)) return 0;
    if (rim == kRimUpper && !(c.rim & kInnerLower)) return 1;
    return kHalf;
  }

  bool lies_flat(FaceHandle f, int i, double& level) {
    const double a = rim_height(copies_[copy_index(id(f->vertex(Cdt::cw(i))), f->info().sheet)]);
    const double b = rim_height(copies_[copy_index(id(f->vertex(Cdt::ccw(i))), f->info().sheet)]);
    level = a;
    return a == b && a != kHalf;
  }

  /// Intermediate points (paper 3.3) by what is lifted: an unconstrained edge that would lie in a section gets
  /// its midpoint, a triangle that still would, its centroid. New edges all end in the new point, which lies
  /// between the sections, so one pass is enough.
  void add_points() {
    std::vector<std::pair<VertexHandle, VertexHandle>> flat;
    double level = 0;
    for (const FaceHandle f : cdt().finite_face_handles()) {
      if (!f->info().in_domain() || sheets_[f->info().sheet].flat) continue;
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
      if (!f->info().in_domain() || sheets_[f->info().sheet].flat) continue;
      std::array<double, 3> h;
      for (int i = 0; i < 3; ++i) h[i] = rim_height(copies_[copy_index(id(f->vertex(i)), f->info().sheet)]);
      if (h[0] == h[1] && h[1] == h[2] && h[0] != kHalf) triangles.push_back(f);
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
    v->info() = static_cast<std::int32_t>(plane_.vertices.size());
    plane_.vertices.emplace_back();
    plane_.handles.push_back(v);
    first_copy_.push_back(-1);
    copy_index(id(v), labels.sheet);
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

  bool is_inner(const Copy& c) const { return !sheets_[c.sheet].flat && !(c.rim & (kRimLower | kRimUpper | kRimBoth)); }

  /// Heights of all copies, and their 3-D vertices. On a rim: the section, or between both where both meet.
  /// Inside: equation (1), with distances to the sheet's own rim.
  void place_copies() {
    for (const Copy& c : copies_)
      if (is_inner(c)) sheets_[c.sheet].has_inner = true;
    collect_rims();
    const std::size_t n = plane_.vertices.size();
    first_level_.assign(n, -1);
    for (std::size_t v = 0; v < n; ++v)
      for (std::int32_t k = first_copy_[v]; k >= 0; k = copies_[k].next)
        if (is_inner(copies_[k])) {
          Sheet& s = sheets_[copies_[k].sheet];
          const PlanarPoint& p = plane_.handles[v]->point();
          if (s.single()) s.reach = std::max(s.reach, (s.rims == kRimLower ? s.lower : s.upper)(p.x(), p.y()));
        }
    keep_volumes();
    for (std::size_t v = 0; v < n; ++v) place_vertex(static_cast<std::int32_t>(v));
  }

  bool is_round_end(const Sheet& s) const { return s.single() && !s.flat; }

  /// 0 on the rim of a round end, 1 where it is widest: a dome.
  double dome_profile(const Copy& c, const PlanarPoint& p) {
    if (!is_inner(c)) return 0;
    Sheet& s = sheets_[c.sheet];
    const double d = (s.rims == kRimLower ? s.lower : s.upper)(p.x(), p.y());
    const double r = s.reach > 0 ? 1 - d / s.reach : 0;
    return std::sqrt(std::max(0.0, 1 - r * r));
  }

  /// May this vertex of a round end leave its section? Not on the rim where anything else meets it.
  bool may_rise(std::int32_t v, const Copy& c) const {
    return is_inner(c) || (!plane_.vertices[v].is_double() && copies_[first_copy_[v]].next < 0 && c.rim_edges == 2);
  }

  /// Slices stand for half a gap on either side, so a sheet should divide the gap in halves on average (a round end:
  /// hold its share). Few points, and rims of unequal length, make it hold less. Round ends: the rim is raised, and
  /// the peak if that is not enough. Other sheets with points inside: equation (1) gets an exponent.
  void keep_volumes() {
    struct Sums {
      double area = 0, may_rise = 0, height = 0;     // height: without the inner points of a sheet that is no end
      std::vector<std::pair<double, double>> inner;  // their heights and areas
    };
    std::vector<Sums> sums(sheets_.size());
    std::vector<double> around(copies_.size(), 0);  // area that a copy's height counts for
    for (const FaceHandle f : cdt().finite_face_handles()) {
      if (!f->info().in_domain() || sheets_[f->info().sheet].flat || !sheets_[f->info().sheet].has_inner) continue;
      const double third = cdt().triangle(f).area() / 3;
      sums[f->info().sheet].area += 3 * third;
      for (int i = 0; i < 3; ++i) around[copy_index(id(f->vertex(i)), f->info().sheet)] += third;
    }
    for (std::size_t v = 0; v < plane_.vertices.size(); ++v)
      for (std::int32_t k = first_copy_[v]; k >= 0; k = copies_[k].next) {
        Copy& c = copies_[k];
        if (around[k] == 0) continue;
        Sums& sum = sums[c.sheet];
        if (is_round_end(sheets_[c.sheet])) {
          c.height = dome_profile(c, plane_.handles[v]->point());
          sum.height += around[k] * c.height;
          if (may_rise(static_cast<std::int32_t>(v), c)) sum.may_rise += around[k];
        } else if (is_inner(c)) {
          c.height = inner_height(c, plane_.handles[v]->point());
          sum.inner.emplace_back(c.height, around[k]);
        } else {
          sum.height += around[k] * rim_height(c);
        }
      }
    for (std::size_t s = 0; s < sheets_.size(); ++s) {
      if (!(sums[s].area > 0)) continue;
      if (!is_round_end(sheets_[s])) {
        sheets_[s].exponent = exponent_for(0.5 * sums[s].area - sums[s].height, sums[s].inner);
        continue;
      }
      // a dome holds two thirds of its height
      const double holds = sheets_[s].scale * in_.round_holds_rel, peak = 1.5 * holds;
      const double profile = sums[s].height / sums[s].area, rising = sums[s].may_rise / sums[s].area;
      const double rim =
          rising > profile ? std::clamp((holds - peak * profile) / (rising - profile), 0.0, kRimRise) : 0;
      const double dome = profile > 0 ? std::min((holds - rim * rising) / profile, kPeakRise - rim) : peak - rim;
      sheets_[s].rim_rise = rim;
      sheets_[s].dome_rise = std::max(dome, kLowest);
    }
  }

  /// The power to which heights must be raised to add up to `wanted`, within limits.
  static double exponent_for(double wanted, const std::vector<std::pair<double, double>>& heights) {
    double low = 1 / kMostBulge, high = kMostBulge;
    for (int i = 0; i < 30; ++i) {
      const double middle = std::sqrt(low * high);
      double sum = 0;
      for (const auto& [height, area] : heights) sum += area * std::pow(height, middle);
      (sum > wanted ? low : high) = middle;
    }
    return std::sqrt(low * high);
  }

  /// The rim segments of every sheet that has inner vertices.
  void collect_rims() {
    for (const FaceHandle f : cdt().finite_face_handles()) {
      if (!f->info().in_domain() || !sheets_[f->info().sheet].has_inner) continue;
      Sheet& s = sheets_[f->info().sheet];
      for (int i = 0; i < 3; ++i) {
        const FaceHandle next = f->neighbor(i);
        if (!f->is_constrained(i)) continue;
        const std::uint8_t of = constrained_edge_of(f, i);
        if (next->info().in_domain() && of != kBoth) continue;  // passed over, or a seam of two end shapes
        const PlanarPoint &a = f->vertex(Cdt::ccw(i))->point(), &b = f->vertex(Cdt::cw(i))->point();
        const SegmentDistance::Segment segment = {a.x(), a.y(), b.x(), b.y()};
        if (of & kLower) s.lower.add(segment);
        if (of & kUpper) s.upper.add(segment);
      }
    }
  }

  /// Flips move the marks of PlanarFace::edge about; what an edge separates does not change.
  static std::uint8_t constrained_edge_of(FaceHandle f, int i) {
    const PlanarFace &a = f->info(), &b = f->neighbor(i)->info();
    return static_cast<std::uint8_t>((a.lower != b.lower ? kLower : 0) | (a.upper != b.upper ? kUpper : 0));
  }

  double inner_height(const Copy& c, const PlanarPoint& p) {
    Sheet& s = sheets_[c.sheet];
    if (s.lower.empty() || s.upper.empty()) return kHalf;
    const double low = s.lower(p.x(), p.y()), high = s.upper(p.x(), p.y());
    return low + high > 0 ? std::clamp(low / (low + high), kLowest, kHighest) : kHalf;  // equation (1)
  }

  /// c.height holds the dome's profile so far.
  double round_height(std::int32_t v, const Copy& c) const {
    const Sheet& s = sheets_[c.sheet];
    const bool upward = s.rims == kRimLower;
    double rise = may_rise(v, c) ? s.rim_rise + s.dome_rise * c.height : 0;
    if (is_inner(c)) rise = std::max(rise, kLowest);
    // not above a flat end beside it: their seam is a wall
    for (std::int32_t k = first_copy_[v]; k >= 0; k = copies_[k].next) {
      const Sheet& other = sheets_[copies_[k].sheet];
      if (other.flat && other.rims == s.rims && other.end == EndShape::flat) rise = std::min(rise, kHalf);
    }
    return upward ? rise : 1 - rise;
  }

  double flat_height(const Sheet& s) const {
    const double rise = s.end == EndShape::flat ? kHalf : 0;
    return s.rims == kRimLower ? rise : 1 - rise;
  }

  void place_vertex(std::int32_t v) {
    if (first_copy_[v] < 0) return;
    // The layers of the sheets that meet here between the sections share out the gap.
    layers_.clear();
    for (std::int32_t k = first_copy_[v]; k >= 0; k = copies_[k].next) {
      const Copy& c = copies_[k];
      if (is_inner(c) || sheets_[c.sheet].flat || sheets_[c.sheet].single() || rim_height(c) != kHalf) continue;
      const int layer = sheets_[c.sheet].layer;
      if (std::find(layers_.begin(), layers_.end(), layer) == layers_.end()) layers_.push_back(layer);
    }
    std::sort(layers_.begin(), layers_.end());
    for (std::int32_t k = first_copy_[v]; k >= 0; k = copies_[k].next) {
      Copy& c = copies_[k];
      const Sheet& s = sheets_[c.sheet];
      if (s.flat) {
        c.height = flat_height(s);
      } else if (s.single()) {
        c.height = round_height(v, c);
      } else if (is_inner(c)) {
        c.height = std::clamp(std::pow(c.height, s.exponent), kLowest, kHighest);
      } else {
        c.height = rim_height(c);
        if (c.height == kHalf) {
          const auto rank = std::lower_bound(layers_.begin(), layers_.end(), s.layer) - layers_.begin();
          c.height = (static_cast<double>(rank) + 1) / (static_cast<double>(layers_.size()) + 1);
        }
      }
      c.out = vertex_at(v, c.height);
    }
  }

  /// The 3-D vertex over v at that height: a section's own point at 0 and 1, else one of the slab.
  std::int32_t vertex_at(std::int32_t v, double height) {
    const PlanarVertex& planar = plane_.vertices[v];
    if (height == 0 && planar.lower >= 0) return planar.lower;
    if (height == 1 && planar.upper >= 0) return planar.upper + static_cast<std::int32_t>(in_.lower->points.size());
    for (std::int32_t k = first_level_[v]; k >= 0; k = levels_[k].next)
      if (levels_[k].height == height) return levels_[k].out;
    const PlanarPoint& p = plane_.handles[v]->point();
    const std::int32_t out =
        static_cast<std::int32_t>(in_.lower->points.size() + in_.upper->points.size() + out_.points.size());
    out_.points.push_back({p.x(), p.y(), in_.z_low_mm + height * (in_.z_high_mm - in_.z_low_mm)});
    levels_.push_back({first_level_[v], height, out});
    first_level_[v] = static_cast<std::int32_t>(levels_.size() - 1);
    return out;
  }

  const Copy& copy_of(VertexHandle v, FaceHandle f) {
    for (std::int32_t k = first_copy_[id(v)]; k >= 0; k = copies_[k].next)
      if (copies_[k].sheet == f->info().sheet) return copies_[k];
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
    const PlanarVertex& planar = plane_.vertices[v];
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
    for (const PlanarEdge& e : plane_.edges) {
      const VertexHandle v = plane_.handles[e.a], w = plane_.handles[e.b];
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
  Plane plane_;
  SlabSurface out_;
  std::vector<Sheet> sheets_;
  std::vector<std::pair<std::int32_t, std::int32_t>> renumber_;
  std::vector<Copy> copies_;
  std::vector<int> layers_;
  std::vector<std::int32_t> first_copy_, first_level_;
  std::vector<Level> levels_;
  std::vector<std::pair<double, std::int32_t>> chain_v_, chain_w_;
};

}  // namespace

SlabSurface stitch_slab(const SlabInput& input) {
  return SlabStitcher(input).run();
}

}  // namespace stackmesh
