#include "volume/relax_surface.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <unordered_map>

#include "model/triangle_contact.h"
#include "volume/best_place.h"
#include "volume/label_tets.h"
#include "volume/tet_quality.h"

namespace stackmesh::volume {
namespace {

constexpr double kReach = 0.15;        // of the mean length of the surface's edges at a point: how far it may go
constexpr double kVolumeShare = 1e-3;  // of a label's volume: how much it may change in all
constexpr int kPasses = 12;
constexpr std::size_t kFew = 100;   // tets, or one in a thousand, are worked on at most
constexpr double kGain = 1e-3;      // what a move must gain at least
constexpr double kNarrow_deg = 20;  // triangles do not get narrower than this, unless one at the point was

class Relaxation {
 public:
  Relaxation(TetMesh& mesh, std::size_t kept, double goal_deg, bool outer)
      : m_(mesh), kept_(kept), goal_(std::sin(goal_deg * M_PI / 180)), outer_(outer) {}

  std::vector<std::int32_t> run() {
    find_bad();
    // A mesh that is bad in many places is no matter of a few points: only its worst tets are worked on.
    if (const std::size_t most = std::max(kFew, m_.tets.size() / 1000); bad_.size() > most) {
      goal_ = bad_[most].first;
      bad_.resize(most);
    }
    if (bad_.empty()) return {};
    filled_.insert(m_.labels.begin(), m_.labels.end());
    volumes_ = tet_volumes(m_);
    find_stars();
    for (int pass = 0; pass < kPasses && !bad_.empty(); ++pass) {
      bool any = false;
      for (const auto& [quality, t] : bad_) {
        for (const std::int32_t v : m_.tets[t]) {
          if (quality_of(t) >= goal_) break;
          any = move(v) || any;
        }
      }
      if (!any) break;
      find_bad();
    }
    std::vector<std::int32_t> moved;
    for (const auto& [v, p] : origin_)
      if (static_cast<std::size_t>(v) < kept_ && norm(m_.points[v] - p) > 0) moved.push_back(v);
    std::sort(moved.begin(), moved.end());
    return moved;
  }

 private:
  struct OuterFace {
    std::int32_t a, b, beside;  // the other corners, and the corner of its tet inside
    std::array<std::int32_t, 3> corners;
  };

  double quality_of(std::int32_t t) const {
    const auto& v = m_.tets[t];
    return tet_quality(m_.points[v[0]], m_.points[v[1]], m_.points[v[2]], m_.points[v[3]]);
  }

  /// Worst first.
  void find_bad() {
    bad_.clear();
    for (std::size_t t = 0; t < m_.tets.size(); ++t)
      if (const double q = quality_of(static_cast<std::int32_t>(t)); q < goal_)
        bad_.emplace_back(q, static_cast<std::int32_t>(t));
    std::sort(bad_.begin(), bad_.end());
  }

  /// Of all points that a few passes may reach.
  void find_stars() {
    std::vector<char> near(m_.points.size(), 0);
    for (const auto& [quality, t] : bad_)
      for (const std::int32_t v : m_.tets[t]) near[v] = 1;
    for (int ring = 0; ring < 2; ++ring) {
      const std::vector<char> before = near;
      for (const auto& t : m_.tets)
        if (before[t[0]] || before[t[1]] || before[t[2]] || before[t[3]])
          for (const std::int32_t v : t) near[v] = 1;
    }
    for (std::size_t t = 0; t < m_.tets.size(); ++t)
      for (const std::int32_t v : m_.tets[t])
        if (near[v]) tets_[v].push_back(static_cast<std::int32_t>(t));
    for (std::size_t f = 0; f < m_.faces.size(); ++f)
      for (const std::int32_t v : m_.faces[f].v)
        if (near[v]) faces_[v].push_back(static_cast<std::int32_t>(f));
  }

  Corners3 places(const std::array<std::int32_t, 3>& c, std::int32_t moved, const Vec3& to) const {
    Corners3 out;
    for (int k = 0; k < 3; ++k) out[k] = c[k] == moved ? to : m_.points[c[k]];
    return out;
  }

  /// True if the outer faces of v stay clear of all others when it goes to `to`: by going inwards; or by going less far
  /// than others are away, so that none can be passed, and by meeting no face with a common corner (exactly).
  bool keeps_apart(std::int32_t v, const Vec3& to, const std::vector<OuterFace>& outer) {
    const Vec3 from = m_.points[v];
    const bool inwards = std::all_of(outer.begin(), outer.end(), [&](const OuterFace& f) {
      const Vec3 &a = m_.points[f.a], &b = m_.points[f.b];
      return orientation(from, a, b, to) * orientation(from, a, b, m_.points[f.beside]) >= 0;
    });
    if (inwards) return true;
    const double way = 1.01 * norm(to - from);
    Vec3 low = from, high = from;
    for (const OuterFace& f : outer)
      for (const std::int32_t x : {f.a, f.b}) {
        const Vec3& p = m_.points[x];
        low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
      }
    for (const InterfaceTriangle& other : m_.faces) {
      // tets on both sides
      if (other.below != 0 && other.above != 0 && filled_.count(other.below) && filled_.count(other.above)) continue;
      const Corners3 t = places(other.v, v, to);
      const auto beyond = [&](double x, double y, double z, double l, double h) {
        return (x < l - way && y < l - way && z < l - way) || (x > h + way && y > h + way && z > h + way);
      };
      if (beyond(t[0].x, t[1].x, t[2].x, low.x, high.x) || beyond(t[0].y, t[1].y, t[2].y, low.y, high.y) ||
          beyond(t[0].z, t[1].z, t[2].z, low.z, high.z))
        continue;
      for (const OuterFace& f : outer) {
        const SharedCorners shared = shared_corners(f.corners, other.v);
        if (shared.count == 3) continue;
        if (shared.count > 0 ? triangles_meet(places(f.corners, v, to), t, shared)
                             : squared_distance(places(f.corners, v, from), t) < way * way)
          return false;
      }
    }
    return true;
  }

  static double volume(const FanTet& t, const Vec3& p) { return dot(t.b - p, cross(t.c - p, t.d - p)) / 6; }

  /// Moves v, unless a label's volume would change by more than its share with all that moved before.
  bool keep_volumes(std::int32_t v, const Vec3& to, const std::vector<std::int32_t>& tets) {
    std::map<Label, double> change;
    for (std::size_t i = 0; i < tets.size(); ++i)
      change[m_.labels[tets[i]]] += volume(fan_[i], to) - volume(fan_[i], m_.points[v]);
    for (const auto& [label, mm3] : change)
      if (std::abs(changed_[label] + mm3) > kVolumeShare * volumes_.at(label).mm3) return false;
    for (const auto& [label, mm3] : change) changed_[label] += mm3;
    m_.points[v] = to;
    return true;
  }

  bool move(std::int32_t v) {
    const auto tets = tets_.find(v);
    if (tets == tets_.end()) return false;
    fan_.clear();
    double before = 2;
    for (const std::int32_t t : tets->second) {
      std::array<std::int32_t, 4> c = m_.tets[t];
      const int slot = static_cast<int>(std::find(c.begin(), c.end(), v) - c.begin());
      if (slot != 0) {  // v first, orientation kept
        std::swap(c[0], c[slot]);
        const int other = slot == 1 ? 2 : 1, last = 6 - slot - other;
        std::swap(c[other], c[last]);
      }
      fan_.push_back({m_.points[c[1]], m_.points[c[2]], m_.points[c[3]]});
      before = std::min(before, quality_of(t));
    }
    const Vec3 from = m_.points[v];
    const Vec3 start = origin_.emplace(v, from).first->second;
    const auto faces = faces_.find(v);
    double after = before;
    Vec3 to;
    if (faces == faces_.end()) {
      to = best_place(fan_, from, after, goal_);
    } else {
      std::vector<OuterFace> outer;
      double length = 0, narrowest = kNarrow_deg * M_PI / 180;
      for (const std::int32_t f : faces->second) {
        const auto& c = m_.faces[f].v;
        const int k = c[0] == v ? 0 : c[1] == v ? 1 : 2;
        const std::int32_t a = c[(k + 1) % 3], b = c[(k + 2) % 3];
        length +=
            0.5 * (norm(m_.points[a] - from) + norm(m_.points[b] - from)) / static_cast<double>(faces->second.size());
        narrowest = std::min(narrowest, smallest_angle(from, m_.points[a], m_.points[b]));
        int sides = 0;
        std::int32_t beside = -1;
        for (const std::int32_t t : tets->second) {
          const auto& w = m_.tets[t];
          if (std::find(w.begin(), w.end(), a) == w.end() || std::find(w.begin(), w.end(), b) == w.end()) continue;
          ++sides;
          for (const std::int32_t x : w)
            if (x != v && x != a && x != b) beside = x;
        }
        if (sides != 1) continue;
        if (!outer_ || (from.z == m_.points[a].z && from.z == m_.points[b].z)) return false;  // a flat end
        outer.push_back({a, b, beside, c});
      }
      const double reach = kReach * length;
      const auto allowed = [&](const Vec3& p) {
        if (norm(p - start) > reach) return false;
        for (const std::int32_t f : faces->second) {
          const auto& c = m_.faces[f].v;
          const int k = c[0] == v ? 0 : c[1] == v ? 1 : 2;
          if (smallest_angle(p, m_.points[c[(k + 1) % 3]], m_.points[c[(k + 2) % 3]]) < narrowest) return false;
        }
        return true;
      };
      to = best_place(fan_, from, after, goal_, allowed);
      // Where other faces are in the way, a part of the way.
      const Vec3 way = to - from;
      for (double share = 1; after > before && !keeps_apart(v, to, outer); share /= 2) {
        if (share < 0.1) return false;
        to = from + (share / 2) * way;
        after = allowed(to) ? fan_quality(fan_, to, before) : before;
      }
    }
    if (after <= before + kGain * std::abs(before)) return false;
    for (const FanTet& t : fan_)
      if (orientation(to, t.b, t.c, t.d) <= 0) return false;
    return faces == faces_.end() ? (m_.points[v] = to, true) : keep_volumes(v, to, tets->second);
  }

  TetMesh& m_;
  const std::size_t kept_;
  double goal_;
  const bool outer_;
  std::vector<std::pair<double, std::int32_t>> bad_;
  std::unordered_map<std::int32_t, std::vector<std::int32_t>> tets_, faces_;  // of each point near a bad tet
  std::unordered_map<std::int32_t, Vec3> origin_;
  std::vector<FanTet> fan_;
  std::set<Label> filled_;
  std::map<Label, Volume> volumes_;
  std::map<Label, double> changed_;  // mm3
};

}  // namespace

std::vector<std::int32_t> relax_surface(TetMesh& mesh, std::size_t kept, double goal_deg, bool outer) {
  return Relaxation(mesh, kept, goal_deg, outer).run();
}

}  // namespace stackmesh::volume
