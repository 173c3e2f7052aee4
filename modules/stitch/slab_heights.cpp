#include "stitch/slab_heights.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace stackmesh {
namespace {

constexpr double kRimRise = 0.45, kPeakRise = 0.95;  // limits of a round end's rim and peak, in gaps
constexpr double kMostBulge = 2.5;                   // limit of the exponent of equation (1), and of its inverse
constexpr double kLowest = 0.02, kHighest = 0.98;    // clamp of equation (1)

class HeightPlacer {
 public:
  HeightPlacer(const SlabInput& input, SlabPlane& plane) : in_(input), p_(plane) {}

  void run() {
    for (const SheetVertex& c : p_.copies)
      if (p_.is_inner(c)) p_.sheets[c.sheet].has_inner = true;
    collect_rims();
    const std::size_t n = p_.plane.vertices.size();
    for (std::size_t v = 0; v < n; ++v)
      for (std::int32_t k = p_.first_copy[v]; k >= 0; k = p_.copies[k].next)
        if (p_.is_inner(p_.copies[k])) {
          Sheet& s = p_.sheets[p_.copies[k].sheet];
          const PlanarPoint& p = p_.plane.handles[v]->point();
          if (s.is_single()) s.reach = std::max(s.reach, (s.rims == kRimLower ? s.lower : s.upper)(p.x(), p.y()));
        }
    keep_volumes();
    for (std::size_t v = 0; v < n; ++v) place_vertex(static_cast<std::int32_t>(v));
  }

 private:
  Cdt& cdt() { return p_.plane.cdt; }
  static std::int32_t id(VertexHandle v) { return v->info(); }

  /// 0 on the rim of a round end, 1 where it is widest: a dome.
  double dome_profile(const SheetVertex& c, const PlanarPoint& p) {
    if (!p_.is_inner(c)) return 0;
    Sheet& s = p_.sheets[c.sheet];
    const double d = (s.rims == kRimLower ? s.lower : s.upper)(p.x(), p.y());
    const double r = s.reach > 0 ? 1 - d / s.reach : 0;
    return std::sqrt(std::max(0.0, 1 - r * r));
  }

  /// May this vertex of a round end leave its section? Not on the rim where anything else meets it.
  bool may_rise(std::int32_t v, const SheetVertex& c) const {
    return p_.is_inner(c) ||
           (!p_.plane.vertices[v].is_double() && p_.copies[p_.first_copy[v]].next < 0 && c.rim_edges == 2);
  }

  /// Slices stand for half a gap on either side, so a sheet should divide the gap in halves on average (a round end:
  /// hold its share). Few points, and rims of unequal length, make it hold less. Round ends: the rim is raised, and
  /// the peak if that is not enough. Other sheets with points inside: equation (1) gets an exponent.
  void keep_volumes() {
    struct Sums {
      double area = 0, may_rise = 0, height = 0;     // height: without the inner points of a sheet that is no end
      std::vector<std::pair<double, double>> inner;  // their heights and areas
    };
    std::vector<Sums> sums(p_.sheets.size());
    std::vector<double> around(p_.copies.size(), 0);  // area that a copy's height counts for
    for (const FaceHandle f : cdt().finite_face_handles()) {
      if (!f->info().in_domain() || p_.sheets[f->info().sheet].flat || !p_.sheets[f->info().sheet].has_inner) continue;
      const double third = cdt().triangle(f).area() / 3;
      sums[f->info().sheet].area += 3 * third;
      for (int i = 0; i < 3; ++i) around[p_.copy_index(id(f->vertex(i)), f->info().sheet)] += third;
    }
    for (std::size_t v = 0; v < p_.plane.vertices.size(); ++v)
      for (std::int32_t k = p_.first_copy[v]; k >= 0; k = p_.copies[k].next) {
        SheetVertex& c = p_.copies[k];
        if (around[k] == 0) continue;
        Sums& sum = sums[c.sheet];
        if (p_.sheets[c.sheet].is_round_end()) {
          c.height = dome_profile(c, p_.plane.handles[v]->point());
          sum.height += around[k] * c.height;
          if (may_rise(static_cast<std::int32_t>(v), c)) sum.may_rise += around[k];
        } else if (p_.is_inner(c)) {
          c.height = inner_height(c, p_.plane.handles[v]->point());
          sum.inner.emplace_back(c.height, around[k]);
        } else {
          sum.height += around[k] * SlabPlane::rim_height(c);
        }
      }
    for (std::size_t s = 0; s < p_.sheets.size(); ++s) {
      if (!(sums[s].area > 0)) continue;
      if (!p_.sheets[s].is_round_end()) {
        p_.sheets[s].exponent = exponent_for(0.5 * sums[s].area - sums[s].height, sums[s].inner);
        continue;
      }
      // a dome holds two thirds of its height
      const double holds = p_.sheets[s].scale * in_.round_holds_rel, peak = 1.5 * holds;
      const double profile = sums[s].height / sums[s].area, rising = sums[s].may_rise / sums[s].area;
      const double rim =
          rising > profile ? std::clamp((holds - peak * profile) / (rising - profile), 0.0, kRimRise) : 0;
      const double dome = profile > 0 ? std::min((holds - rim * rising) / profile, kPeakRise - rim) : peak - rim;
      p_.sheets[s].rim_rise = rim;
      p_.sheets[s].dome_rise = std::max(dome, kLowest);
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
      if (!f->info().in_domain() || !p_.sheets[f->info().sheet].has_inner) continue;
      Sheet& s = p_.sheets[f->info().sheet];
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

  double inner_height(const SheetVertex& c, const PlanarPoint& p) {
    Sheet& s = p_.sheets[c.sheet];
    if (s.lower.empty() || s.upper.empty()) return kHalfGap;
    const double low = s.lower(p.x(), p.y()), high = s.upper(p.x(), p.y());
    return low + high > 0 ? std::clamp(low / (low + high), kLowest, kHighest) : kHalfGap;  // equation (1)
  }

  /// c.height holds the dome's profile so far.
  double round_height(std::int32_t v, const SheetVertex& c) const {
    const Sheet& s = p_.sheets[c.sheet];
    const bool upward = s.rims == kRimLower;
    double rise = may_rise(v, c) ? s.rim_rise + s.dome_rise * c.height : 0;
    if (p_.is_inner(c)) rise = std::max(rise, kLowest);
    // not above a flat end beside it: their seam is a wall
    for (std::int32_t k = p_.first_copy[v]; k >= 0; k = p_.copies[k].next) {
      const Sheet& other = p_.sheets[p_.copies[k].sheet];
      if (other.flat && other.rims == s.rims && other.end == EndShape::flat) rise = std::min(rise, kHalfGap);
    }
    return upward ? rise : 1 - rise;
  }

  double flat_height(const Sheet& s) const {
    const double rise = s.end == EndShape::flat ? kHalfGap : 0;
    return s.rims == kRimLower ? rise : 1 - rise;
  }

  void place_vertex(std::int32_t v) {
    if (p_.first_copy[v] < 0) return;
    // The layers of the sheets that meet here between the sections share out the gap.
    layers_.clear();
    for (std::int32_t k = p_.first_copy[v]; k >= 0; k = p_.copies[k].next) {
      const SheetVertex& c = p_.copies[k];
      if (p_.is_inner(c) || p_.sheets[c.sheet].flat || p_.sheets[c.sheet].is_single() ||
          SlabPlane::rim_height(c) != kHalfGap)
        continue;
      const int layer = p_.sheets[c.sheet].layer;
      if (std::find(layers_.begin(), layers_.end(), layer) == layers_.end()) layers_.push_back(layer);
    }
    std::sort(layers_.begin(), layers_.end());
    for (std::int32_t k = p_.first_copy[v]; k >= 0; k = p_.copies[k].next) {
      SheetVertex& c = p_.copies[k];
      const Sheet& s = p_.sheets[c.sheet];
      if (s.flat) {
        c.height = flat_height(s);
      } else if (s.is_single()) {
        c.height = round_height(v, c);
      } else if (p_.is_inner(c)) {
        c.height = std::clamp(std::pow(c.height, s.exponent), kLowest, kHighest);
      } else {
        c.height = SlabPlane::rim_height(c);
        if (c.height == kHalfGap) {
          const auto rank = std::lower_bound(layers_.begin(), layers_.end(), s.layer) - layers_.begin();
          c.height = (static_cast<double>(rank) + 1) / (static_cast<double>(layers_.size()) + 1);
        }
      }
    }
  }

  const SlabInput& in_;
  SlabPlane& p_;
  std::vector<int> layers_;
};

}  // namespace

void place_heights(const SlabInput& input, SlabPlane& plane) {
  HeightPlacer(input, plane).run();
}

}  // namespace stackmesh
