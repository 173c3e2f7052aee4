#include "report/polylines.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace stackmesh {
namespace {

using Point = std::array<std::int32_t, 2>;

double segment_distance(const Point& p, const Point& a, const Point& b) {
  const double ex = static_cast<double>(b[0]) - a[0], ey = static_cast<double>(b[1]) - a[1];
  const double px = static_cast<double>(p[0]) - a[0], py = static_cast<double>(p[1]) - a[1];
  const double length2 = ex * ex + ey * ey;
  const double s = length2 > 0 ? std::clamp((px * ex + py * ey) / length2, 0.0, 1.0) : 0;
  return std::hypot(px - s * ex, py - s * ey);
}

/// Douglas and Peucker's rule; a closed line keeps its end point and the one farthest from it.
std::vector<Point> simplified(const std::vector<Point>& line, double tolerance) {
  if (line.size() < 3) return line;
  std::vector<char> keep(line.size(), 0);
  keep.front() = keep.back() = 1;
  std::vector<std::pair<std::size_t, std::size_t>> spans = {{0, line.size() - 1}};
  const bool closed = line.front() == line.back();
  while (!spans.empty()) {
    const auto [first, last] = spans.back();
    spans.pop_back();
    const bool whole_loop = closed && first == 0 && last == line.size() - 1;
    double worst = whole_loop ? -1 : tolerance;
    std::size_t at = 0;
    for (std::size_t i = first + 1; i < last; ++i) {
      const double d = segment_distance(line[i], line[first], line[last]);
      if (d > worst) worst = d, at = i;
    }
    if (at == 0) continue;
    keep[at] = 1;
    spans.push_back({first, at});
    spans.push_back({at, last});
  }
  std::vector<Point> out;
  for (std::size_t i = 0; i < line.size(); ++i)
    if (keep[i]) out.push_back(line[i]);
  return out;
}

}  // namespace

std::vector<Polyline> join_segments(std::vector<CurveSegment> segments, double unit, double tolerance) {
  segments.erase(
      std::remove_if(segments.begin(), segments.end(), [](const CurveSegment& s) { return s.left == s.right; }),
      segments.end());
  for (CurveSegment& s : segments)
    if (s.left > s.right) std::swap(s.left, s.right), std::swap(s.from, s.to), std::swap(s.a, s.b);
  const auto start_key = [](const CurveSegment& s) { return std::tie(s.left, s.right, s.from); };
  std::stable_sort(segments.begin(), segments.end(),
                   [&](const CurveSegment& s, const CurveSegment& t) { return start_key(s) < start_key(t); });
  std::vector<std::size_t> by_end(segments.size());
  for (std::size_t i = 0; i < segments.size(); ++i) by_end[i] = i;
  const auto end_key = [](const CurveSegment& s) { return std::tie(s.left, s.right, s.to); };
  std::stable_sort(by_end.begin(), by_end.end(),
                   [&](std::size_t i, std::size_t j) { return end_key(segments[i]) < end_key(segments[j]); });

  std::vector<char> used(segments.size(), 0);
  constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  const auto next = [&](const CurveSegment& s) {
    const auto key = std::tie(s.left, s.right, s.to);
    auto it = std::lower_bound(segments.begin(), segments.end(), key,
                               [&](const CurveSegment& t, const auto& k) { return start_key(t) < k; });
    for (; it != segments.end() && start_key(*it) == key; ++it)
      if (!used[it - segments.begin()]) return static_cast<std::size_t>(it - segments.begin());
    return kNone;
  };
  const auto previous = [&](const CurveSegment& s) {
    const auto key = std::tie(s.left, s.right, s.from);
    auto it = std::lower_bound(by_end.begin(), by_end.end(), key,
                               [&](std::size_t t, const auto& k) { return end_key(segments[t]) < k; });
    for (; it != by_end.end() && end_key(segments[*it]) == key; ++it)
      if (!used[*it]) return *it;
    return kNone;
  };
  const auto rounded = [unit](const std::array<double, 2>& p) {
    return Point{static_cast<std::int32_t>(std::lround(p[0] / unit)),
                 static_cast<std::int32_t>(std::lround(p[1] / unit))};
  };

  std::vector<Polyline> lines;
  std::vector<Point> before;
  for (std::size_t first = 0; first < segments.size(); ++first) {
    if (used[first]) continue;
    Polyline line{segments[first].left, segments[first].right, {}};
    std::vector<Point> after;
    before.clear();
    for (std::size_t s = first; s != kNone; s = next(segments[s])) {
      used[s] = 1;
      if (after.empty()) after.push_back(rounded(segments[s].a));
      after.push_back(rounded(segments[s].b));
    }
    for (std::size_t s = previous(segments[first]); s != kNone; s = previous(segments[s])) {
      used[s] = 1;
      before.push_back(rounded(segments[s].a));
    }
    std::reverse(before.begin(), before.end());
    before.insert(before.end(), after.begin(), after.end());
    before.erase(std::unique(before.begin(), before.end()), before.end());
    if (before.size() < 2) continue;
    line.points = simplified(before, tolerance / unit);
    lines.push_back(std::move(line));
  }
  return lines;
}

void pack(const std::vector<Polyline>& lines, Bytes& bytes) {
  bytes.number(lines.size());
  for (const Polyline& line : lines) {
    bytes.number(static_cast<std::uint64_t>(line.left));
    bytes.number(static_cast<std::uint64_t>(line.right));
    bytes.number(line.points.size());
    Point last = {0, 0};
    for (const Point& p : line.points) {
      bytes.signed_number(static_cast<std::int64_t>(p[0]) - last[0]);
      bytes.signed_number(static_cast<std::int64_t>(p[1]) - last[1]);
      last = p;
    }
  }
}

}  // namespace stackmesh
