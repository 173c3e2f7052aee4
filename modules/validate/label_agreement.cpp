#include "validate/label_agreement.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/disjoint_sets.h"
#include "base/parallel.h"
#include "validate/box_tree.h"
#include "validate/exact.h"

namespace stackmesh {
namespace {

using Pair = std::array<std::int32_t, 2>;

/// A triangle at an edge a b, a < b.
struct EdgeUse {
  std::int32_t a, b, triangle, apex;
  bool forward;  // the triangle runs from a to b
};

std::vector<EdgeUse> sorted_uses(const InterfaceComplex& complex) {
  std::vector<EdgeUse> uses;
  uses.reserve(3 * complex.triangles.size());
  for (std::size_t t = 0; t < complex.triangles.size(); ++t) {
    const auto& v = complex.triangles[t].v;
    for (int k = 0; k < 3; ++k) {
      const std::int32_t a = v[k], b = v[(k + 1) % 3];
      uses.push_back({std::min(a, b), std::max(a, b), static_cast<std::int32_t>(t), v[(k + 2) % 3], a < b});
    }
  }
  std::sort(uses.begin(), uses.end(), [](const EdgeUse& x, const EdgeUse& y) {
    return x.a != y.a ? x.a < y.a : x.b != y.b ? x.b < y.b : x.triangle < y.triangle;
  });
  return uses;
}

class Agreement {
 public:
  Agreement(const InterfaceComplex& complex, int threads, std::size_t limit)
      : c_(complex), threads_(threads), limit_(limit), pieces_(complex.triangles.size()) {}

  LabelConflicts run() {
    edges();
    rays();
    std::sort(out_.pairs.begin(), out_.pairs.end());
    if (out_.pairs.size() > limit_) out_.pairs.resize(limit_);
    return std::move(out_);
  }

 private:
  void conflict(std::int32_t s, std::int32_t t) {
    ++out_.count;
    out_.pairs.push_back({std::min(s, t), std::max(s, t)});
  }

  void edges() {
    const std::vector<EdgeUse> uses = sorted_uses(c_);
    for (std::size_t first = 0, end = 0; first < uses.size(); first = end) {
      while (end < uses.size() && uses[end].a == uses[first].a && uses[end].b == uses[first].b) ++end;
      for (std::size_t i = first + 1; i < end; ++i) pieces_.join(uses[first].triangle, uses[i].triangle);
      if (end - first > 2)
        around({uses.begin() + static_cast<std::ptrdiff_t>(first), uses.begin() + static_cast<std::ptrdiff_t>(end)});
    }
  }

  /// The triangles of an edge, turned about it by the right hand from the first one on.
  void around(std::vector<EdgeUse> uses) {
    const Vec3 &a = c_.points[uses[0].a], &b = c_.points[uses[0].b];
    const auto side = [&](const EdgeUse& from, const EdgeUse& to) {
      return exact_orientation(a, b, c_.points[from.apex], c_.points[to.apex]);
    };
    const EdgeUse zero = uses[0];
    // 0 the first one, 1 less than half a turn from it, 2 half a turn, 3 more
    const auto half = [&](const EdgeUse& u) {
      if (u.triangle == zero.triangle) return 0;
      const int s = side(zero, u);
      return s > 0 ? 1 : s == 0 ? 2 : 3;
    };
    std::sort(uses.begin(), uses.end(), [&](const EdgeUse& x, const EdgeUse& y) {
      const int hx = half(x), hy = half(y);
      return hx != hy ? hx < hy : (hx & 1) != 0 && side(x, y) > 0;
    });
    for (std::size_t i = 0; i < uses.size(); ++i) {
      const EdgeUse &u = uses[i], &next = uses[(i + 1) % uses.size()];
      const InterfaceTriangle &t = c_.triangles[u.triangle], &n = c_.triangles[next.triangle];
      if ((u.forward ? t.above : t.below) != (next.forward ? n.below : n.above)) conflict(u.triangle, next.triangle);
    }
  }

  struct Hit {
    double at;
    std::int32_t triangle;
    bool upwards;  // from its `below` into its `above`
  };

  /// Where a ray from a triangle's middle meets others, in order; nothing when it passes too near to an edge to tell.
  std::optional<std::vector<Hit>> hits(const BoxTree& tree, std::int32_t start, const Vec3& along, double reach) const {
    constexpr double kNear = 1e-7;
    const Vec3 from = middle(start);
    std::vector<Hit> found;
    bool clear = true;
    tree.along_ray(from, along, reach, [&](std::int32_t t, double*) {
      if (t == start || !clear) return;
      const auto& v = c_.triangles[t].v;
      const Vec3 &p = c_.points[v[0]], e = c_.points[v[1]] - p, f = c_.points[v[2]] - p, normal = cross(e, f);
      const double slope = dot(normal, along), size = norm(normal);
      if (std::abs(slope) < 1e-9 * size) {  // nearly along the triangle: tell by its distance whether it matters
        clear = std::abs(dot(normal, from - p)) > 1e-3 * std::sqrt(size) * size;
        return;
      }
      const double at = dot(normal, p - from) / slope;
      const Vec3 q = from + at * along - p;
      const double w = dot(normal, normal), y = dot(cross(q, f), normal) / w, z = dot(cross(e, q), normal) / w,
                   x = 1 - y - z;
      const double least = std::min({x, y, z});
      if (least < -kNear) return;
      if (least < kNear || std::abs(at) < 1e-9 * reach) {
        clear = at < -1e-9 * reach;
        return;
      }
      if (at > 0) found.push_back({at, t, slope > 0});
    });
    if (!clear) return std::nullopt;
    std::sort(found.begin(), found.end(), [](const Hit& x, const Hit& y) { return x.at < y.at; });
    return found;
  }

  Vec3 middle(std::int32_t t) const {
    const auto& v = c_.triangles[t].v;
    return (1 / 3.0) * (c_.points[v[0]] + c_.points[v[1]] + c_.points[v[2]]);
  }

  /// One ray from the largest triangle of each piece.
  void rays() {
    std::vector<std::int32_t> largest(c_.triangles.size(), -1);
    std::vector<double> area(c_.triangles.size(), -1);
    std::vector<Box> boxes(c_.triangles.size());
    Box all;
    for (std::size_t i = 0; i < c_.triangles.size(); ++i) {
      const auto& v = c_.triangles[i].v;
      for (std::int32_t p : v) {
        boxes[i].add(c_.points[p]);
        all.add(c_.points[p]);
      }
      const double a = norm(cross(c_.points[v[1]] - c_.points[v[0]], c_.points[v[2]] - c_.points[v[0]]));
      const std::int32_t piece = pieces_.find(static_cast<std::int32_t>(i));
      if (a <= area[piece]) continue;
      area[piece] = a;
      largest[piece] = static_cast<std::int32_t>(i);
    }
    std::vector<std::int32_t> starts;
    for (std::int32_t t : largest)
      if (t >= 0) starts.push_back(t);
    if (starts.empty()) return;
    const BoxTree tree(boxes);
    const double reach = 2 * ((all.high[0] - all.low[0]) + (all.high[1] - all.low[1]) + (all.high[2] - all.low[2]));
    std::vector<Pair> found(starts.size(), {-1, -1});
    parallel_for(starts.size(), threads_, [&](std::size_t i) { found[i] = follow(tree, starts[i], reach); });
    for (const Pair& p : found)
      if (p[0] >= 0) conflict(p[0], p[1]);
  }

  /// The first two triangles along a ray that contradict each other; (-1, -1): none.
  Pair follow(const BoxTree& tree, std::int32_t start, double reach) const {
    for (int turn = 0; turn < 16; ++turn) {
      // spread over the sphere, along no axis
      const double phi = 0.7 + 2.399963 * turn, z = 0.85 - 0.11 * turn, r = std::sqrt(1 - z * z);
      const Vec3 along{r * std::cos(phi), r * std::sin(phi), z};
      const auto& v = c_.triangles[start].v;
      const Vec3 normal = cross(c_.points[v[1]] - c_.points[v[0]], c_.points[v[2]] - c_.points[v[0]]);
      const double slope = dot(normal, along);
      if (std::abs(slope) < 0.05 * norm(normal)) continue;
      const auto met = hits(tree, start, along, reach);
      if (!met) continue;
      Label here = slope > 0 ? c_.triangles[start].above : c_.triangles[start].below;
      std::int32_t last = start;
      for (const Hit& h : *met) {
        const InterfaceTriangle& t = c_.triangles[h.triangle];
        if ((h.upwards ? t.below : t.above) != here) return {last, h.triangle};
        here = h.upwards ? t.above : t.below;
        last = h.triangle;
      }
      return here == 0 ? Pair{-1, -1} : Pair{last, last};
    }
    return {-1, -1};
  }

  const InterfaceComplex& c_;
  int threads_;
  std::size_t limit_;
  DisjointSets pieces_;  // triangles that hang together by edges
  LabelConflicts out_;
};

}  // namespace

LabelConflicts find_label_conflicts(const InterfaceComplex& complex, int threads, std::size_t limit) {
  return Agreement(complex, threads, limit).run();
}

}  // namespace stackmesh
