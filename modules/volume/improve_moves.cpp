#include "volume/improve_moves.h"

#include <algorithm>
#include <cmath>

#include "volume/best_place.h"
#include "volume/label_tets.h"
#include "volume/tet_quality.h"

namespace stackmesh::volume {
namespace {

using Corners = ImproveMesh::Corners;

constexpr double kGain = 1e-3;  // what a change must gain at least, relative
constexpr std::size_t kLongestRing = 9, kLargestCavity = 40;

/// Corner `slot` first, orientation kept.
Corners first(const Corners& v, int slot) {
  switch (slot) {
    case 0:
      return v;
    case 1:
      return {v[1], v[0], v[3], v[2]};
    case 2:
      return {v[2], v[3], v[0], v[1]};
    default:
      return {v[3], v[2], v[1], v[0]};
  }
}

}  // namespace

double ImproveMoves::worst_of(const std::vector<std::int32_t>& tets) const {
  double worst = 2;
  for (const std::int32_t t : tets) worst = std::min(worst, m_.quality[t]);
  return worst;
}

const std::vector<FanTet>& ImproveMoves::places_of_fan() {
  places_.clear();
  for (const Corners& v : fan_) places_.push_back({m_.points[v[1]], m_.points[v[2]], m_.points[v[3]]});
  return places_;
}

bool ImproveMoves::smooth(std::int32_t vertex, double enough) {
  if (!m_.movable[vertex]) return false;
  m_.star(vertex, around_);
  if (around_.empty()) return false;
  fan_.clear();
  for (const std::int32_t t : around_) fan_.push_back(first(m_.tets[t].v, m_.tets[t].slot(vertex)));
  const double before = worst_of(around_);
  double after = before;
  const Vec3 from = m_.points[vertex], to = best_place(places_of_fan(), from, after, enough);
  if (after <= before + kGain * std::abs(before)) return false;
  for (const Corners& v : fan_)
    if (orientation(to, m_.points[v[1]], m_.points[v[2]], m_.points[v[3]]) <= 0) return false;
  m_.points[vertex] = to;
  for (const std::int32_t t : around_) {
    m_.quality[t] = m_.quality_of(m_.tets[t].v);
    m_.note_change(t);
  }
  return true;
}

bool ImproveMoves::remove_edge(std::int32_t t) {
  const Corners v = m_.tets[t].v;
  static constexpr int kEdges[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
  for (const auto& e : kEdges) {
    const std::int32_t a = v[e[0]], b = v[e[1]];
    if (!m_.ring(t, a, b, kLongestRing, around_, ring_)) continue;
    const int n = static_cast<int>(ring_.size());
    const double before = std::min(floor_, worst_of(around_) * (1 + kGain));
    // The best triangulation of the ring (klincsek1980): best[i][j] of the polygon i .. j.
    double best[kLongestRing][kLongestRing];
    int middle[kLongestRing][kLongestRing];
    for (int span = 1; span < n; ++span)
      for (int i = 0; i + span < n; ++i) {
        const int j = i + span;
        best[i][j] = span == 1 ? 2 : -1;
        middle[i][j] = -1;
        for (int k = i + 1; k < j; ++k) {
          double q = std::min(best[i][k], best[k][j]);
          if (q <= before || q <= best[i][j]) continue;
          q = std::min(q, m_.quality_of({ring_[i], ring_[k], ring_[j], b}));
          if (q <= before || q <= best[i][j]) continue;
          q = std::min(q, m_.quality_of({ring_[k], ring_[i], ring_[j], a}));
          if (q > before && q > best[i][j]) best[i][j] = q, middle[i][j] = k;
        }
      }
    if (best[0][n - 1] <= before) continue;
    fresh_.clear();
    int stack[2 * kLongestRing][2], top = 0;
    stack[top][0] = 0, stack[top++][1] = n - 1;
    while (top > 0) {
      --top;
      const int i = stack[top][0], j = stack[top][1];
      if (j - i < 2) continue;
      const int k = middle[i][j];
      fresh_.push_back({ring_[i], ring_[k], ring_[j], b});
      fresh_.push_back({ring_[k], ring_[i], ring_[j], a});
      stack[top][0] = i, stack[top++][1] = k;
      stack[top][0] = k, stack[top++][1] = j;
    }
    if (m_.replace(around_, fresh_)) return true;
  }
  return false;
}

bool ImproveMoves::remove_face(std::int32_t t) {
  for (int i = 0; i < 4; ++i) {
    const std::int32_t n = m_.tets[t].n[i];
    if (n < 0) continue;
    const Corners v = first(m_.tets[t].v, i);  // v[0] above the face v[1] v[2] v[3]
    std::int32_t e = -1;
    for (const std::int32_t u : m_.tets[n].v)
      if (u != v[1] && u != v[2] && u != v[3]) e = u;
    const double before = std::min(floor_, std::min(m_.quality[t], m_.quality[n]) * (1 + kGain));
    fresh_.clear();
    double q = 2;
    for (int k = 1; k <= 3 && q > before; ++k) {
      const Corners fresh = {v[0], e, v[k], v[k % 3 + 1]};
      q = std::min(q, m_.quality_of(fresh));
      fresh_.push_back(fresh);
    }
    if (q <= before) continue;
    around_ = {t, n};
    if (m_.replace(around_, fresh_)) return true;
  }
  return false;
}

bool ImproveMoves::collapse(std::int32_t t) {
  const Corners v = m_.tets[t].v;
  for (const std::int32_t gone : v) {
    if (!m_.movable[gone]) continue;
    m_.star(gone, around_);
    const double before = std::min(floor_, worst_of(around_) * (1 + kGain));
    for (const std::int32_t into : v) {
      if (into == gone) continue;
      fresh_.clear();
      double q = 2;
      for (const std::int32_t s : around_) {
        if (m_.tets[s].has(into)) continue;
        Corners c = m_.tets[s].v;
        c[m_.tets[s].slot(gone)] = into;
        q = std::min(q, m_.quality_of(c));
        if (q <= before) break;
        fresh_.push_back(c);
      }
      if (q <= before || fresh_.empty()) continue;
      if (m_.replace(around_, fresh_)) return true;
    }
  }
  return false;
}

bool ImproveMoves::try_insert(Vec3 p, double enough) {
  // The cavity grows through the inner faces that the point sees worst, as long as that helps.
  m_.begin_marks();
  double old_worst = 2;
  for (const std::int32_t t : cavity_) {
    m_.mark(t);
    old_worst = std::min(old_worst, m_.quality[t]);
  }
  struct Side {
    Corners v;  // v[0] is the cavity's corner, to be replaced by the point
    std::int32_t beyond;
    double quality;
  };
  std::vector<Side> sides;
  const auto add_sides = [&](std::int32_t tet) {
    for (int i = 0; i < 4; ++i) {
      const std::int32_t n = m_.tets[tet].n[i];
      if (n >= 0 && m_.marked(n)) continue;
      const Corners v = first(m_.tets[tet].v, i);
      sides.push_back({v, n, tet_quality(p, m_.points[v[1]], m_.points[v[2]], m_.points[v[3]])});
    }
  };
  for (const std::int32_t t : cavity_) add_sides(t);
  while (cavity_.size() < kLargestCavity) {
    const Side* worst = nullptr;
    for (const Side& s : sides)
      if (s.beyond >= 0 && (worst == nullptr || s.quality < worst->quality)) worst = &s;
    if (worst == nullptr || worst->quality > enough) break;
    // A face beyond which the tet is good enough is better left.
    if (worst->quality > old_worst && m_.quality[worst->beyond] > worst->quality && worst->quality > 0.5 * enough &&
        cavity_.size() > 12)
      break;
    const std::int32_t next = worst->beyond;
    m_.mark(next);
    cavity_.push_back(next);
    old_worst = std::min(old_worst, m_.quality[next]);
    sides.erase(std::remove_if(sides.begin(), sides.end(), [&](const Side& s) { return s.beyond == next; }),
                sides.end());
    add_sides(next);
  }
  fan_.clear();
  double q = 2;
  for (const Side& s : sides) {
    q = std::min(q, s.quality);
    fan_.push_back(s.v);
  }
  if (q <= -0.5) return false;
  p = best_place(places_of_fan(), p, q, enough);
  if (q <= std::min(floor_, old_worst * (1 + 10 * kGain) + 1e-3)) return false;
  const std::int32_t fresh_point = m_.add_point(p);
  fresh_.clear();
  for (const Corners& v : fan_) fresh_.push_back({fresh_point, v[1], v[2], v[3]});
  if (m_.replace(cavity_, fresh_)) return true;
  m_.drop_last_point();
  return false;
}

Vec3 ImproveMoves::centre_of_cavity() const {
  Vec3 sum;
  for (const std::int32_t t : cavity_)
    for (const std::int32_t v : m_.tets[t].v) sum = sum + m_.points[v];
  return (0.25 / static_cast<double>(cavity_.size())) * sum;
}

bool ImproveMoves::insert(std::int32_t t, double enough, bool thorough) {
  const Corners v = m_.tets[t].v;
  cavity_ = {t};
  const Vec3 centre = centre_of_cavity();
  if (try_insert(centre, enough)) return true;
  // The middle of the longest edge opens a cap.
  double longest = 0;
  Vec3 middle;
  for (int i = 0; i < 4; ++i)
    for (int j = i + 1; j < 4; ++j) {
      const double length = norm(m_.points[v[j]] - m_.points[v[i]]);
      if (length > longest) longest = length, middle = 0.5 * (m_.points[v[i]] + m_.points[v[j]]);
    }
  cavity_ = {t};
  if (try_insert(0.7 * middle + 0.3 * centre, enough)) return true;
  if (!thorough) return false;
  // A tet that lies flat on the surface needs a point off it.
  cavity_ = {t};
  for (const std::int32_t n : m_.tets[t].n)
    if (n >= 0) cavity_.push_back(n);
  if (try_insert(centre_of_cavity(), enough)) return true;
  for (int i = 0; i < 4; ++i)
    for (int j = i + 1; j < 4; ++j) {
      if (!m_.ring(t, v[i], v[j], 2 * kLongestRing, around_, ring_)) continue;
      Vec3 sum;
      for (const std::int32_t r : ring_) sum = sum + m_.points[r];
      const Vec3 around = (1 / static_cast<double>(ring_.size())) * sum, on = 0.5 * (m_.points[v[i]] + m_.points[v[j]]);
      for (const double share : {0.5, 0.15}) {
        cavity_ = around_;
        if (try_insert(share * around + (1 - share) * on, enough)) return true;
        m_.ring(t, v[i], v[j], 2 * kLongestRing, around_, ring_);
      }
    }
  return false;
}

}  // namespace stackmesh::volume
