#include "validate/boundaries.h"

#include <algorithm>
#include <limits>
#include <string>

#include "base/error.h"
#include "validate/exact.h"

namespace stackmesh {
namespace {

/// One side of a triangle at an edge (low, high): `sign` is +1 when the side runs low -> high.
struct EdgeSide {
  std::int32_t row, side, apex;  // side: 2 * triangle + (0 below, 1 above)
  int sign;
};

class BoundaryFinder {
 public:
  BoundaryFinder(const InterfaceComplex& complex, std::size_t limit, bool neighbours, Boundaries& out)
      : complex_(complex),
        limit_(limit),
        neighbours_(neighbours),
        out_(out),
        sides_(2 * complex.triangles.size()),
        fans_(6 * complex.triangles.size()) {}

  void run() {
    check_input();
    assign_rows();
    count_vertices();
    walk_edges();
    measure();
  }

 private:
  void check_input() const {
    const std::int64_t n = static_cast<std::int64_t>(complex_.points.size());
    for (std::size_t t = 0; t < complex_.triangles.size(); ++t)
      for (const std::int32_t v : complex_.triangles[t].v)
        if (v < 0 || v >= n)
          fail_input("a triangle names a point that does not exist",
                     "triangle " + std::to_string(t) + ", point " + std::to_string(v), "write the mesh again");
    for (std::size_t p = 0; p < complex_.points.size(); ++p) {
      const Vec3& v = complex_.points[p];
      if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z))
        fail_input("a coordinate is not a finite number", "point " + std::to_string(p), "write the mesh again");
    }
  }

  void assign_rows() {
    std::vector<Label> labels;
    for (const auto& t : complex_.triangles)
      for (const Label l : {t.below, t.above})
        if (l != 0 && (labels.empty() || labels.back() != l)) labels.push_back(l);
    std::sort(labels.begin(), labels.end());
    labels.erase(std::unique(labels.begin(), labels.end()), labels.end());
    out_.labels.resize(labels.size());
    for (std::size_t i = 0; i < labels.size(); ++i) out_.labels[i].label = labels[i];
    const auto row_of = [&](Label l) -> std::int32_t {
      return l == 0 ? -1
                    : static_cast<std::int32_t>(std::lower_bound(labels.begin(), labels.end(), l) - labels.begin());
    };
    out_.row.assign(complex_.triangles.size(), {-1, -1});
    for (std::size_t t = 0; t < complex_.triangles.size(); ++t) {
      const auto& triangle = complex_.triangles[t];
      if (triangle.below == triangle.above) continue;
      out_.row[t] = {row_of(triangle.below), row_of(triangle.above)};
      for (const std::int32_t row : out_.row[t])
        if (row >= 0) ++out_.labels[row].triangles;
    }
  }

  void count_vertices() {
    const std::size_t n = complex_.points.size();
    std::vector<std::int64_t> start(n + 1, 0);
    for (const auto& t : complex_.triangles)
      for (const std::int32_t v : t.v) ++start[v + 1];
    for (std::size_t p = 0; p < n; ++p) start[p + 1] += start[p];
    std::vector<std::int32_t> at(start[n]);
    for (std::size_t t = 0; t < complex_.triangles.size(); ++t)
      for (const std::int32_t v : complex_.triangles[t].v) at[start[v]++] = static_cast<std::int32_t>(t);
    std::vector<std::int64_t> seen(out_.labels.size(), -1);
    std::int64_t k = 0;
    for (std::size_t p = 0; p < n; ++p)
      for (; k < start[p]; ++k)
        for (const std::int32_t row : out_.row[at[k]])
          if (row >= 0 && seen[row] != static_cast<std::int64_t>(p)) {
            seen[row] = static_cast<std::int64_t>(p);
            ++out_.labels[row].vertices;
          }
  }

  void walk_edges() {
    struct Item {
      std::int32_t high, triangle, corner;  // the edge from this corner to the next
    };
    const std::size_t n = complex_.points.size();
    std::vector<std::int64_t> start(n + 1, 0);
    const auto each = [&](auto visit) {
      for (std::size_t t = 0; t < complex_.triangles.size(); ++t)
        for (int c = 0; c < 3; ++c) {
          const std::int32_t a = complex_.triangles[t].v[c], b = complex_.triangles[t].v[(c + 1) % 3];
          if (a != b) visit(std::min(a, b), Item{std::max(a, b), static_cast<std::int32_t>(t), c});
        }
    };
    each([&](std::int32_t low, const Item&) { ++start[low + 1]; });
    for (std::size_t p = 0; p < n; ++p) start[p + 1] += start[p];
    std::vector<Item> items(start[n]);
    each([&](std::int32_t low, const Item& item) { items[start[low]++] = item; });
    std::vector<EdgeSide> group;
    std::int64_t begin = 0;
    for (std::size_t low = 0; low < n; ++low) {
      const std::int64_t end = start[low];
      std::sort(items.begin() + begin, items.begin() + end, [](const Item& a, const Item& b) {
        return a.high != b.high           ? a.high < b.high
               : a.triangle != b.triangle ? a.triangle < b.triangle
                                          : a.corner < b.corner;
      });
      for (std::int64_t i = begin; i < end;) {
        group.clear();
        const std::int32_t high = items[i].high;
        for (; i < end && items[i].high == high; ++i) {
          const auto& v = complex_.triangles[items[i].triangle].v;
          const int sign = v[items[i].corner] == static_cast<std::int32_t>(low) ? 1 : -1;
          for (int s = 0; s < 2; ++s)
            if (const std::int32_t row = out_.row[items[i].triangle][s]; row >= 0)
              group.push_back({row, 2 * items[i].triangle + s, v[(items[i].corner + 2) % 3], s == 0 ? sign : -sign});
        }
        edge(static_cast<std::int32_t>(low), high, group);
      }
      begin = end;
    }
  }

  void edge(std::int32_t low, std::int32_t high, std::vector<EdgeSide>& group) {
    out_.edge_lengths_mm.push_back(norm(complex_.points[high] - complex_.points[low]));
    std::stable_sort(group.begin(), group.end(), [](const EdgeSide& a, const EdgeSide& b) { return a.row < b.row; });
    bool open = false, nonmanifold = false;
    edge_entries_ = out_.neighbours.size();
    for (std::size_t i = 0, j = 0; i < group.size(); i = j) {
      int sum = 0;
      for (j = i; j < group.size() && group[j].row == group[i].row; ++j) sum += group[j].sign;
      LabelBoundary& label = out_.labels[group[i].row];
      ++label.edges;
      if (sum != 0) open = true, label.closed = false;
      if (j - i > 2)
        nonmanifold = true, ++label.nonmanifold_edges, pair_across_solid(low, high, &group[i], &group[i] + (j - i));
      if (j - i == 2) join(low, high, group[i], group[i + 1]);
    }
    out_.nonmanifold_edges += nonmanifold;
    out_.open_edges += open;
    if (open && out_.open_edge_list.size() < limit_) out_.open_edge_list.push_back({low, high});
  }

  /// Two sides are neighbours at an edge: so are their corners at its ends.
  void join(std::int32_t low, std::int32_t high, const EdgeSide& a, const EdgeSide& b) {
    sides_.join(a.side, b.side);
    for (const std::int32_t p : {low, high}) fans_.join(corner(a.side, p), corner(b.side, p));
    if (!neighbours_) return;
    const std::pair<std::int32_t, std::int32_t> triangles = std::minmax(a.side / 2, b.side / 2);
    bool first = true;
    for (std::size_t k = edge_entries_; k < out_.neighbours.size(); ++k)
      if (std::pair<std::int32_t, std::int32_t>(
              std::minmax(out_.neighbours[k].side / 2, out_.neighbours[k].other / 2)) == triangles)
        first = false;
    out_.neighbours.push_back(
        {a.row, a.side, b.side, static_cast<std::int32_t>(out_.edge_lengths_mm.size()) - 1, first});
  }

  std::int32_t corner(std::int32_t side, std::int32_t point) const {
    const auto& v = complex_.triangles[side / 2].v;
    return 3 * side + (v[0] == point ? 0 : v[1] == point ? 1 : 2);
  }

  /// Sorts the sides counter-clockwise around low -> high; from a side whose solid follows it, the next one
  /// bounds the same solid.
  void pair_across_solid(std::int32_t low, std::int32_t high, EdgeSide* begin, EdgeSide* end) {
    const auto& p = complex_.points;
    const std::int32_t reference = begin->apex;
    const auto half = [&](std::int32_t apex) {
      if (apex == reference) return 0;
      const int o = exact_orientation(p[low], p[high], p[reference], p[apex]);
      if (o != 0) return o > 0 ? 1 : 3;
      const Vec3 e = p[high] - p[low];
      return dot(cross(e, p[reference] - p[low]), cross(e, p[apex] - p[low])) > 0 ? 0 : 2;
    };
    std::vector<int> halves;
    std::vector<std::size_t> order(end - begin);
    for (std::size_t i = 0; i < order.size(); ++i) {
      order[i] = i;
      halves.push_back(half(begin[i].apex));
    }
    std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
      if (halves[i] != halves[j]) return halves[i] < halves[j];
      if (halves[i] % 2 == 0) return false;
      return exact_orientation(p[low], p[high], p[begin[i].apex], p[begin[j].apex]) > 0;
    });
    for (std::size_t k = 0; k < order.size(); ++k) {
      const EdgeSide &a = begin[order[k]], &b = begin[order[(k + 1) % order.size()]];
      if (a.sign < 0 && b.sign > 0) join(low, high, a, b);
    }
  }

  void measure() {
    const auto& p = complex_.points;
    constexpr double inf = std::numeric_limits<double>::infinity();
    struct Extent {
      Vec3 low = {inf, inf, inf}, high = {-inf, -inf, -inf};
    };
    std::vector<Extent> extents(out_.labels.size());
    for (std::size_t t = 0; t < out_.row.size(); ++t)
      for (const std::int32_t row : out_.row[t]) {
        if (row < 0) continue;
        Extent& e = extents[row];
        for (const std::int32_t v : complex_.triangles[t].v) {
          e.low = {std::min(e.low.x, p[v].x), std::min(e.low.y, p[v].y), std::min(e.low.z, p[v].z)};
          e.high = {std::max(e.high.x, p[v].x), std::max(e.high.y, p[v].y), std::max(e.high.z, p[v].z)};
        }
      }
    std::vector<long> fans(out_.labels.size(), 0);
    for (std::size_t t = 0; t < out_.row.size(); ++t)
      for (int s = 0; s < 2; ++s)
        if (out_.row[t][s] >= 0)
          for (int c = 0; c < 3; ++c) {
            const std::int32_t id = static_cast<std::int32_t>(3 * (2 * t + s) + c);
            fans[out_.row[t][s]] += fans_.find(id) == id;
          }
    std::vector<std::int32_t> number(2 * out_.row.size(), -1);
    out_.piece.assign(out_.row.size(), {-1, -1});
    std::vector<long double> piece_volume, volume(out_.labels.size()), area(out_.labels.size());
    for (std::size_t t = 0; t < out_.row.size(); ++t)
      for (int s = 0; s < 2; ++s) {
        const std::int32_t row = out_.row[t][s];
        if (row < 0) continue;
        std::int32_t& piece = number[sides_.find(static_cast<std::int32_t>(2 * t + s))];
        if (piece < 0) {
          piece = static_cast<std::int32_t>(piece_volume.size());
          piece_volume.push_back(0);
          out_.piece_row.push_back(row);
          ++out_.labels[row].shells;
        }
        out_.piece[t][s] = piece;
        const Vec3 centre = 0.5 * (extents[row].low + extents[row].high);
        const auto& v = complex_.triangles[t].v;
        const Vec3 a = p[v[0]] - centre, b = p[v[1]] - centre, c = p[v[2]] - centre;
        const long double part = (s == 0 ? 1.0L : -1.0L) * dot(a, cross(b, c)) / 6;
        piece_volume[piece] += part;
        volume[row] += part;
        area[row] += 0.5L * norm(cross(b - a, c - a));
      }
    for (std::size_t row = 0; row < out_.labels.size(); ++row) {
      out_.labels[row].volume_mm3 = static_cast<double>(volume[row]);
      out_.labels[row].area_mm2 = static_cast<double>(area[row]);
      if (out_.labels[row].closed)
        out_.labels[row].genus = out_.labels[row].shells - (2 * fans[row] - out_.labels[row].triangles) / 4;
    }
    for (std::size_t i = 0; i < piece_volume.size(); ++i) {
      out_.piece_volume_mm3.push_back(static_cast<double>(piece_volume[i]));
      if (piece_volume[i] > 0) ++out_.labels[out_.piece_row[i]].outer_pieces;
    }
  }

  const InterfaceComplex& complex_;
  const std::size_t limit_;
  const bool neighbours_;
  std::size_t edge_entries_ = 0;  // of the list of neighbours, before the edge at hand
  Boundaries& out_;
  DisjointSets sides_, fans_;  // of 2 * triangle + side, and of 3 * side + corner
};

}  // namespace

Boundaries find_boundaries(const InterfaceComplex& complex, std::size_t limit, bool neighbours) {
  Boundaries result;
  BoundaryFinder(complex, limit, neighbours, result).run();
  return result;
}

}  // namespace stackmesh
