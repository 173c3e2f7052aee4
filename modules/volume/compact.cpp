#include "volume/compact.h"

#include <algorithm>
#include <map>
#include <utility>

namespace stackmesh::volume {

Compact compact(const InterfaceComplex& complex) {
  std::vector<std::int32_t> used;
  std::vector<std::int32_t> place(complex.points.size(), -1);  // first point at the same place
  for (const InterfaceTriangle& t : complex.triangles)
    for (const std::int32_t v : t.v)
      if (place[v] < 0) {
        place[v] = v;
        used.push_back(v);
      }
  const auto less = [&](std::int32_t i, std::int32_t j) {
    const Vec3 &a = complex.points[i], &b = complex.points[j];
    if (a.x != b.x) return a.x < b.x;
    if (a.y != b.y) return a.y < b.y;
    if (a.z != b.z) return a.z < b.z;
    return i < j;
  };
  std::sort(used.begin(), used.end(), less);
  for (std::size_t i = 1; i < used.size(); ++i) {
    const Vec3 &a = complex.points[used[i - 1]], &b = complex.points[used[i]];
    if (a.x == b.x && a.y == b.y && a.z == b.z) place[used[i]] = place[used[i - 1]];
  }
  Compact out;
  std::vector<std::int32_t> number(complex.points.size(), -1);
  for (std::size_t i = 0; i < complex.points.size(); ++i) {
    if (place[i] != static_cast<std::int32_t>(i)) continue;
    number[i] = static_cast<std::int32_t>(out.points.size());
    out.original.push_back(static_cast<std::int32_t>(i));
    out.points.push_back(complex.points[i]);
  }
  out.welded = complex.triangles;
  out.corners.reserve(3 * complex.triangles.size());
  for (InterfaceTriangle& t : out.welded) {
    for (std::int32_t& v : t.v) {
      v = place[v];
      out.corners.push_back(number[v]);
    }
  }
  return out;
}

Compact part_of(const Compact& whole, const std::set<Label>& labels) {
  Compact out;
  std::vector<std::int32_t> number(whole.points.size(), -1);
  const auto kept = [&](Label l) { return labels.count(l) > 0 ? l : 0; };
  for (std::size_t i = 0; i < whole.welded.size(); ++i) {
    InterfaceTriangle t = whole.welded[i];
    t.below = kept(t.below), t.above = kept(t.above);
    if (t.below == t.above) continue;
    out.welded.push_back(t);
    for (int k = 0; k < 3; ++k) {
      const std::int32_t v = whole.corners[3 * i + k];
      if (number[v] < 0) {
        number[v] = static_cast<std::int32_t>(out.points.size());
        out.points.push_back(whole.points[v]);
        out.original.push_back(whole.original[v]);
      }
      out.corners.push_back(number[v]);
    }
  }
  return out;
}

std::vector<std::set<Label>> halves(const Compact& whole) {
  constexpr std::size_t kWorthIt = 10000;  // triangles
  if (whole.welded.size() < kWorthIt) return {};
  struct Row {
    double sides = 0, at[3] = {0, 0, 0};
  };
  std::map<Label, Row> rows;
  double low[3] = {1e300, 1e300, 1e300}, high[3] = {-1e300, -1e300, -1e300};
  for (std::size_t i = 0; i < whole.welded.size(); ++i) {
    const InterfaceTriangle& t = whole.welded[i];
    if (t.below == t.above) continue;
    const Vec3& p = whole.points[whole.corners[3 * i]];
    const double at[3] = {p.x, p.y, p.z};
    for (int k = 0; k < 3; ++k) low[k] = std::min(low[k], at[k]), high[k] = std::max(high[k], at[k]);
    for (const Label l : {t.below, t.above}) {
      if (l == 0) continue;
      Row& row = rows[l];
      ++row.sides;
      for (int k = 0; k < 3; ++k) row.at[k] += at[k];
    }
  }
  if (rows.size() < 2) return {};
  int axis = 0;
  for (int k = 1; k < 3; ++k)
    if (high[k] - low[k] > high[axis] - low[axis]) axis = k;
  std::vector<std::pair<double, Label>> order;
  double all = 0;
  for (const auto& [label, row] : rows) order.emplace_back(row.at[axis] / row.sides, label), all += row.sides;
  std::sort(order.begin(), order.end());
  double before = 0;
  std::size_t first = 0;
  while (before + 0.5 * rows[order[first].second].sides < 0.5 * all) before += rows[order[first++].second].sides;
  if (std::min(before, all - before) < 0.2 * all) return {};
  std::vector<std::set<Label>> sets(2);
  for (std::size_t i = 0; i < order.size(); ++i) sets[i < first ? 0 : 1].insert(order[i].second);
  return sets;
}

}  // namespace stackmesh::volume
