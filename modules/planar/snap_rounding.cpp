#include "planar/snap_rounding.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <optional>

#include "base/disjoint_sets.h"
#include "base/error.h"
#include "base/parallel.h"
#include "base/warning.h"

namespace stackmesh {
namespace {

std::uint64_t key_of(GridPoint p) {
  return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(p.x)) << 32) | static_cast<std::uint32_t>(p.y);
}

/// A set of grid points with dense ids, by open addressing.
class PointSet {
 public:
  explicit PointSet(std::size_t expected) {
    std::size_t capacity = 16;
    while (capacity < 2 * expected) capacity *= 2;
    slots_.assign(capacity, -1);
  }
  /// The id of p, and whether it is new.
  std::pair<std::int32_t, bool> insert(GridPoint p) {
    if (2 * points_.size() >= slots_.size()) grow();
    std::size_t i = slot(p);
    if (slots_[i] >= 0) return {slots_[i], false};
    slots_[i] = static_cast<std::int32_t>(points_.size());
    points_.push_back(p);
    return {slots_[i], true};
  }
  const std::vector<GridPoint>& points() const { return points_; }

 private:
  std::size_t slot(GridPoint p) const {
    std::uint64_t h = key_of(p) * 0x9E3779B97F4A7C15ull;
    std::size_t i = (h ^ (h >> 29)) & (slots_.size() - 1);
    while (slots_[i] >= 0 && points_[slots_[i]] != p) i = (i + 1) & (slots_.size() - 1);
    return i;
  }
  void grow() {
    std::vector<std::int32_t> old(2 * slots_.size(), -1);
    old.swap(slots_);
    for (std::size_t k = 0; k < points_.size(); ++k) slots_[slot(points_[k])] = static_cast<std::int32_t>(k);
  }
  std::vector<std::int32_t> slots_;
  std::vector<GridPoint> points_;
};

/// Does s meet the half-open pixel [p.x - 1/2, p.x + 1/2) x [p.y - 1/2, p.y + 1/2)? Exact.
bool traverses(const GridSegment& s, GridPoint p) {
  if (std::max(s.a.x, s.b.x) < p.x || std::min(s.a.x, s.b.x) > p.x || std::max(s.a.y, s.b.y) < p.y ||
      std::min(s.a.y, s.b.y) > p.y)
    return false;
  // In doubled coordinates the pixel's borders are odd and the end points even: no end point lies on a border.
  const std::int64_t dx = 2 * (static_cast<std::int64_t>(s.b.x) - s.a.x),
                     dy = 2 * (static_cast<std::int64_t>(s.b.y) - s.a.y);
  if (dx == 0 || dy == 0) return true;
  const std::int64_t px = 2 * (static_cast<std::int64_t>(p.x) - s.a.x),
                     py = 2 * (static_cast<std::int64_t>(p.y) - s.a.y);
  const auto side = [&](int ox, int oy) { return dx * (py + oy) - dy * (px + ox); };
  if ((dx > 0) == (dy > 0)) {  // the corners that such a line can graze are both outside the half-open pixel
    const std::int64_t u = side(-1, 1), v = side(1, -1);
    return u != 0 && v != 0 && (u > 0) != (v > 0);
  }
  const std::int64_t u = side(-1, -1), v = side(1, 1);
  return u == 0 || (v != 0 && (u > 0) != (v > 0));
}

/// The pixel that holds the crossing of s and t, which properly cross.
GridPoint crossing_pixel(const GridSegment& s, const GridSegment& t) {
  std::int64_t num = orientation(t.a, t.b, s.a);
  std::int64_t den = num - orientation(t.a, t.b, s.b);
  if (den < 0) {
    den = -den;
    num = -num;
  }
  const auto round_at = [&](std::int64_t from, std::int64_t to) {
    const __int128 top = 2 * static_cast<__int128>(to - from) * num + den, bottom = 2 * static_cast<__int128>(den);
    __int128 q = top / bottom;
    if (top % bottom != 0 && top < 0) --q;
    return static_cast<std::int32_t>(from + static_cast<std::int64_t>(q));
  };
  return {round_at(s.a.x, s.b.x), round_at(s.a.y, s.b.y)};
}

/// One section at work: its original segments, its hot pixels, and what each segment is routed through.
struct Routing {
  const std::vector<GridSegment>* segments = nullptr;
  std::optional<EdgeGrid> grid;
  std::optional<PointSet> hot;
  std::vector<std::pair<std::int32_t, GridPoint>> via;  // (segment, hot pixel that it traverses)
  std::vector<GridPoint> fresh, next_fresh;             // hot pixels found in the last, in this round
  std::vector<GridPoint> crossings;                     // with itself and with the section above
};

void find_crossings(const Routing& upper, Routing& lower, bool same) {
  const std::vector<GridSegment>& s = *lower.segments;
  const std::vector<GridSegment>& t = *upper.segments;
  for (std::size_t j = 0; j < t.size(); ++j)
    lower.grid->near_segment(t[j], [&](std::int32_t i) {
      if (same && static_cast<std::size_t>(i) >= j) return;
      if (properly_cross(s[i], t[j])) lower.crossings.push_back(crossing_pixel(s[i], t[j]));
    });
}

/// Routes the section's segments through those of `pixels` that they traverse.
void route(Routing& r, const std::vector<GridPoint>& pixels) {
  for (GridPoint p : pixels)
    r.grid->near_point(p, [&](std::int32_t i) {
      const GridSegment& s = (*r.segments)[i];
      if (s.a == p || s.b == p || !traverses(s, p)) return;
      r.via.emplace_back(i, p);
      if (r.hot->insert(p).second) r.next_fresh.push_back(p);
    });
}

NodedSegments assemble(Routing& r) {
  const std::vector<GridSegment>& segments = *r.segments;
  // Hot pixels that a segment traverses come in the order of its own steps in x, then in y.
  std::sort(r.via.begin(), r.via.end(), [&](const auto& u, const auto& v) {
    if (u.first != v.first) return u.first < v.first;
    const GridSegment& s = segments[u.first];
    const std::int64_t ux = s.b.x >= s.a.x ? u.second.x : -static_cast<std::int64_t>(u.second.x);
    const std::int64_t vx = s.b.x >= s.a.x ? v.second.x : -static_cast<std::int64_t>(v.second.x);
    if (ux != vx) return ux < vx;
    return s.b.y >= s.a.y ? u.second.y < v.second.y : u.second.y > v.second.y;
  });
  NodedSegments out;
  out.edges.reserve(segments.size() + r.via.size());
  PointSet points(r.hot->points().size());
  std::size_t k = 0;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    std::int32_t last = points.insert(segments[i].a).first;
    const auto step = [&](GridPoint p) {
      const std::int32_t id = points.insert(p).first;
      if (id != last) out.edges.push_back({last, id, static_cast<std::int32_t>(i)});
      last = id;
    };
    for (; k < r.via.size() && static_cast<std::size_t>(r.via[k].first) == i; ++k) step(r.via[k].second);
    step(segments[i].b);
  }
  out.points = points.points();
  return out;
}

}  // namespace

std::vector<NodedSegments> node_segments(const std::vector<std::vector<GridSegment>>& sections, int threads) {
  const std::size_t n = sections.size();
  std::vector<Routing> routing(n);
  parallel_for(n, threads, [&](std::size_t i) {
    Routing& r = routing[i];
    r.segments = &sections[i];
    r.grid.emplace(sections[i]);
    r.hot.emplace(sections[i].size() + 16);
    for (const GridSegment& s : sections[i]) {
      r.hot->insert(s.a);
      r.hot->insert(s.b);
    }
  });
  parallel_for(n, threads, [&](std::size_t i) {
    find_crossings(routing[i], routing[i], true);
    if (i + 1 < n) find_crossings(routing[i + 1], routing[i], false);
  });
  parallel_for(n, threads, [&](std::size_t i) {
    for (GridPoint p : routing[i].crossings) routing[i].hot->insert(p);
    if (i > 0)
      for (GridPoint p : routing[i - 1].crossings) routing[i].hot->insert(p);
    routing[i].fresh = routing[i].hot->points();
  });
  for (bool any = true; any;) {
    parallel_for(n, threads, [&](std::size_t i) {
      if (i > 0) route(routing[i], routing[i - 1].fresh);
      route(routing[i], routing[i].fresh);
      if (i + 1 < n) route(routing[i], routing[i + 1].fresh);
    });
    any = false;
    for (Routing& r : routing) {
      r.fresh.swap(r.next_fresh);
      r.next_fresh.clear();
      any = any || !r.fresh.empty();
    }
  }
  std::vector<NodedSegments> out(n);
  parallel_for(n, threads, [&](std::size_t i) {
    out[i] = assemble(routing[i]);
    routing[i] = Routing();
  });
  return out;
}

namespace {

/// A noded piece with its end points in ascending order.
struct Piece {
  std::int32_t a, b;
  Label left, right;
  std::int32_t source;
};

/// The labels beside coincident pieces: each label's boundary is a chain, and chains add.
/// False when the pieces cancel. @throws Error(input) when the sum is no boundary between two labels.
bool compose(const Piece* first, const Piece* last, const Stack& stack, std::size_t section, Piece& out) {
  out = *first;
  if (last - first == 1) return out.left != out.right;
  std::vector<std::pair<Label, int>> sum;
  const auto add = [&](Label label, int amount) {
    for (auto& s : sum)
      if (s.first == label) {
        s.second += amount;
        return;
      }
    sum.emplace_back(label, amount);
  };
  for (const Piece* p = first; p != last; ++p) {
    add(p->left, 1);
    add(p->right, -1);
  }
  int lefts = 0, rights = 0;
  bool simple = true;
  for (const auto& s : sum) {
    if (s.second == 1) {
      out.left = s.first;
      ++lefts;
    } else if (s.second == -1) {
      out.right = s.first;
      ++rights;
    } else if (s.second != 0) {
      simple = false;
    }
  }
  if (!simple || lefts != rights || lefts > 1)
    fail_input(
        "contours overlap so that labels contradict each other",
        "section " + std::to_string(section + 1) + " at z = " + std::to_string(stack.sections[section].z_mm) + " mm",
        "mend the contours so that they do not cross");
  return lefts == 1;
}

/// Contour components (connected sets of edges) of the original section, as an id per edge.
std::vector<std::int32_t> edge_components(const Section& section) {
  DisjointSets sets(section.points.size());
  for (const SectionEdge& e : section.edges) sets.join(e.a, e.b);
  std::vector<std::int32_t> out;
  out.reserve(section.edges.size());
  for (const SectionEdge& e : section.edges) out.push_back(sets.find(e.a));
  return out;
}

/// Rebuilds a section from its noded pieces; returns a warning if a contour vanished.
std::string rebuild(Stack& stack, std::size_t index, NodedSegments&& noded, std::size_t& added) {
  Section& section = stack.sections[index];
  std::vector<Piece> pieces;
  pieces.reserve(noded.edges.size());
  for (const NodedEdge& e : noded.edges) {
    const SectionEdge& s = section.edges[e.source];
    if (e.a < e.b) pieces.push_back({e.a, e.b, s.left, s.right, e.source});
    else pieces.push_back({e.b, e.a, s.right, s.left, e.source});
  }
  std::sort(pieces.begin(), pieces.end(), [](const Piece& p, const Piece& q) {
    return p.a != q.a ? p.a < q.a : p.b != q.b ? p.b < q.b : p.source < q.source;
  });
  std::vector<SectionEdge> edges;
  edges.reserve(pieces.size());
  bool cancelled = false;
  std::vector<std::int32_t> kept_sources;
  for (std::size_t i = 0, j; i < pieces.size(); i = j) {
    for (j = i + 1; j < pieces.size() && pieces[j].a == pieces[i].a && pieces[j].b == pieces[i].b;) ++j;
    Piece sum{};
    if (compose(&pieces[i], &pieces[i] + (j - i), stack, index, sum)) {
      edges.push_back({sum.a, sum.b, sum.left, sum.right});
      for (std::size_t k = i; k < j; ++k) kept_sources.push_back(pieces[k].source);
    } else {
      cancelled = true;
    }
  }
  std::string warning;
  if (cancelled || noded.edges.empty()) {
    const std::vector<std::int32_t> component = edge_components(section);
    std::vector<char> alive(section.points.size(), 0), seen(section.points.size(), 0);
    for (std::int32_t s : kept_sources) alive[component[s]] = 1;
    std::size_t lost = 0;
    for (std::int32_t c : component)
      if (!alive[c] && !seen[c]) {
        seen[c] = 1;
        ++lost;
      }
    if (lost > 0)
      warning = std::to_string(lost) + " contour(s) thinner than the rounding grid vanished in section " +
                std::to_string(index + 1) + " at z = " + std::to_string(section.z_mm) + " mm";
  }
  // Points that no edge uses any more are dropped.
  std::vector<std::int32_t> id(noded.points.size(), -1);
  std::vector<GridPoint> points;
  points.reserve(noded.points.size());
  for (SectionEdge& e : edges)
    for (std::int32_t* end : {&e.a, &e.b}) {
      if (id[*end] < 0) {
        id[*end] = static_cast<std::int32_t>(points.size());
        points.push_back(noded.points[*end]);
      }
      *end = id[*end];
    }
  added = points.size() > section.points.size() ? points.size() - section.points.size() : 0;
  section.points = std::move(points);
  section.edges = std::move(edges);
  return warning;
}

}  // namespace

SnapRoundingReport snap_round(Stack& stack, int threads) {
  const std::size_t n = stack.sections.size();
  std::vector<std::vector<GridSegment>> segments(n);
  for (std::size_t i = 0; i < n; ++i) {
    const Section& s = stack.sections[i];
    segments[i].reserve(s.edges.size());
    for (const SectionEdge& e : s.edges) segments[i].push_back({s.points[e.a], s.points[e.b]});
  }
  std::vector<NodedSegments> noded = node_segments(segments, threads);
  std::vector<std::string> warnings(n);
  std::vector<std::size_t> added(n, 0);
  parallel_for(n, threads, [&](std::size_t i) { warnings[i] = rebuild(stack, i, std::move(noded[i]), added[i]); });
  SnapRoundingReport report;
  for (std::size_t i = 0; i < n; ++i) {
    report.added_vertices += added[i];
    if (!warnings[i].empty())
      report.warnings.push_back({WarningCode::vanished, "section " + std::to_string(i + 1), warnings[i]});
  }
  return report;
}

}  // namespace stackmesh
