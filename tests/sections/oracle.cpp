#include "oracle.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "sections/extract.h"

namespace stackmesh::contour_tests {
namespace {

using Random = std::mt19937_64;

int below(Random& r, int n) {
  return static_cast<int>(r() % static_cast<std::uint64_t>(n));
}

std::int64_t cross(GridPoint o, GridPoint a, GridPoint b) {
  return (std::int64_t{a.x} - o.x) * (std::int64_t{b.y} - o.y) - (std::int64_t{a.y} - o.y) * (std::int64_t{b.x} - o.x);
}

int sign(std::int64_t v) {
  return v > 0 ? 1 : v < 0 ? -1 : 0;
}

/// Is p, on the line through a and b, within the segment?
bool within(GridPoint a, GridPoint b, GridPoint p) {
  return std::min(a.x, b.x) <= p.x && p.x <= std::max(a.x, b.x) && std::min(a.y, b.y) <= p.y &&
         p.y <= std::max(a.y, b.y);
}

bool shared(const Edge& e, GridPoint p) {
  return e.a == p || e.b == p;
}

bool clash(const Edge& e, const Edge& f) {
  if (std::max(e.a.x, e.b.x) < std::min(f.a.x, f.b.x) || std::max(f.a.x, f.b.x) < std::min(e.a.x, e.b.x) ||
      std::max(e.a.y, e.b.y) < std::min(f.a.y, f.b.y) || std::max(f.a.y, f.b.y) < std::min(e.a.y, e.b.y))
    return false;
  if (shared(e, f.a) && shared(e, f.b)) return true;
  const int fa = sign(cross(e.a, e.b, f.a)), fb = sign(cross(e.a, e.b, f.b));
  const int ea = sign(cross(f.a, f.b, e.a)), eb = sign(cross(f.a, f.b, e.b));
  if (fa * fb < 0 && ea * eb < 0) return true;
  return (fa == 0 && within(e.a, e.b, f.a) && !shared(e, f.a)) ||
         (fb == 0 && within(e.a, e.b, f.b) && !shared(e, f.b)) ||
         (ea == 0 && within(f.a, f.b, e.a) && !shared(f, e.a)) || (eb == 0 && within(f.a, f.b, e.b) && !shared(f, e.b));
}

}  // namespace

Slice random_slice(std::uint64_t seed, int largest) {
  Random r(seed * 2654435761U + 17);
  Slice s;
  s.width = 1 + below(r, largest);
  s.height = 1 + below(r, largest);
  s.pixels.assign(static_cast<std::size_t>(s.width) * s.height, 0);
  const int labels = 1 + below(r, 8), empty = below(r, 101), keep = below(r, 101), kind = static_cast<int>(seed % 6);
  const auto fill = [&](const std::function<int(int, int)>& f) {
    for (int y = 0; y < s.height; ++y)
      for (int x = 0; x < s.width; ++x)
        s.pixels[static_cast<std::size_t>(y) * s.width + x] = static_cast<std::uint16_t>(f(x, y));
  };
  const auto any = [&] { return below(r, 100) < empty ? 0 : 1 + below(r, labels); };
  if (kind == 0) fill([&](int, int) { return any(); });
  if (kind == 1) fill([&](int, int) { return below(r, 100) < empty ? 0 : 1; });
  if (kind == 2)  // runs along x or y
    fill([&](int x, int y) {
      return x > 0 && below(r, 100) < keep ? s.at(x - 1, y) : y > 0 && below(r, 100) < keep ? s.at(x, y - 1) : any();
    });
  if (kind == 3)  // blobs
    for (int b = 0; b < 4 + labels; ++b) {
      const int cx = below(r, s.width), cy = below(r, s.height), radius = 1 + below(r, 7), label = below(r, labels + 1);
      fill([&](int x, int y) {
        return (x - cx) * (x - cx) + (y - cy) * (y - cy) <= radius * radius ? label : s.at(x, y);
      });
    }
  if (kind == 4) {  // a checkerboard with flaws
    const int a = below(r, labels + 1), b = below(r, labels + 1);
    fill([&](int x, int y) { return below(r, 100) < 8 ? any() : (x + y) % 2 ? a : b; });
  }
  if (kind == 5)  // thin boxes and rings
    for (int b = 0; b < 3 + labels; ++b) {
      const int x0 = below(r, s.width), y0 = below(r, s.height), x1 = x0 + below(r, 9), y1 = y0 + below(r, 9),
                label = 1 + below(r, labels);
      const bool ring = below(r, 2) != 0;
      fill([&](int x, int y) {
        const bool in = x >= x0 && x <= x1 && y >= y0 && y <= y1, inner = x > x0 && x < x1 && y > y0 && y < y1;
        return in && !(ring && inner) ? label : s.at(x, y);
      });
    }
  if (std::all_of(s.pixels.begin(), s.pixels.end(), [](auto p) { return p == 0; })) s.pixels[s.pixels.size() / 2] = 1;
  return s;
}

Slice slice_of(const std::vector<std::string>& rows) {
  return slice_of(static_cast<int>(rows[0].size()), static_cast<int>(rows.size()),
                  [&](int x, int y) { return rows[y][x] - '0'; });
}

Slice slice_of(int width, int height, const std::function<int(int, int)>& label) {
  Slice s;
  s.width = width;
  s.height = height;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) s.pixels.push_back(static_cast<std::uint16_t>(label(x, y)));
  return s;
}

LabelVolume volume_of(const std::vector<Slice>& slices) {
  LabelVolume v;
  v.size = {slices[0].width, slices[0].height, static_cast<int>(slices.size())};
  for (int l = 0; l <= 8; ++l) v.labels.push_back({l * 3, ""});  // numbers that are no indices
  for (const Slice& s : slices) v.voxels.insert(v.voxels.end(), s.pixels.begin(), s.pixels.end());
  return v;
}

std::vector<std::int64_t> count_pixels(const Slice& slice) {
  std::vector<std::int64_t> counts(9, 0);
  for (std::uint16_t p : slice.pixels) ++counts[p];
  return counts;
}

std::int64_t count_cracks(const Slice& slice) {
  std::int64_t cracks = 0;
  for (int y = 0; y <= slice.height; ++y)
    for (int x = 0; x <= slice.width; ++x)
      cracks += (slice.at(x, y) != slice.at(x - 1, y)) + (slice.at(x, y) != slice.at(x, y - 1));
  return cracks;
}

SliceArcs trace(const Slice& slice, bool joined, bool part) {
  CornerRules rules;
  rules.same_component = [joined](int, int, int, int) { return joined; };
  rules.part = part;
  return trace_arcs(slice, rules);
}

std::vector<Edge> edges_of(const SliceArcs& traced, double simplify_px) {
  std::vector<Edge> edges;
  const auto kept = simplify_arcs(traced.arcs, simplify_px);
  for (std::size_t a = 0; a < kept.size(); ++a)
    for (std::size_t i = 0; i + 1 < kept[a].size(); ++i)
      edges.push_back({kept[a][i], kept[a][i + 1], traced.arcs[a].left, traced.arcs[a].right});
  return edges;
}

std::vector<Edge> edges_of(const Section& section) {
  std::vector<Edge> edges;
  for (const SectionEdge& e : section.edges)
    edges.push_back({section.points[e.a], section.points[e.b], e.left, e.right});
  return edges;
}

std::int64_t count_relabelled_centres(const Slice& slice, const std::vector<Edge>& edges) {
  std::int64_t wrong = 0;
  const std::set<std::uint16_t> labels(slice.pixels.begin(), slice.pixels.end());
  for (int y = 0; y < slice.height; ++y) {
    const std::int64_t row = std::int64_t{y} * kGridPerPixel + kGridPerPixel / 2;
    std::map<int, std::vector<long double>> crossings;  // of each label's boundary with the row of centres
    for (const Edge& e : edges) {
      if ((e.a.y <= row) == (e.b.y <= row)) continue;
      // Exact: the products stay below 2^60, and a long double divides them to far less than a grid unit.
      const long double x =
          e.a.x + static_cast<long double>((row - e.a.y) * (std::int64_t{e.b.x} - e.a.x)) / (e.b.y - e.a.y);
      crossings[e.left].push_back(x);
      crossings[e.right].push_back(x);
    }
    for (auto& [label, xs] : crossings) std::sort(xs.begin(), xs.end());
    for (int x = 0; x < slice.width; ++x) {
      const long double centre = static_cast<long double>(x) * kGridPerPixel + kGridPerPixel / 2;
      for (std::uint16_t label : labels) {
        if (label == 0) continue;
        const auto& xs = crossings[label];
        const bool inside = (xs.end() - std::upper_bound(xs.begin(), xs.end(), centre)) % 2 == 1;
        const bool on = std::binary_search(xs.begin(), xs.end(), centre);
        if (on || inside != (slice.at(x, y) == label)) ++wrong;
      }
    }
  }
  return wrong;
}

std::int64_t count_clashes(const std::vector<Edge>& edges) {
  std::int64_t clashes = 0;
  for (std::size_t i = 0; i < edges.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) clashes += clash(edges[i], edges[j]);
  return clashes;
}

std::size_t smallest_boundary(const std::vector<Edge>& edges) {
  std::set<int> labels;
  for (const Edge& e : edges) labels.insert({e.left, e.right});
  labels.erase(0);
  std::size_t smallest = ~std::size_t{0};
  for (int label : labels) {
    std::map<GridPoint, std::vector<GridPoint>> next;
    for (const Edge& e : edges)
      if (e.left == label || e.right == label) {
        next[e.a].push_back(e.b);
        next[e.b].push_back(e.a);
      }
    std::set<GridPoint> seen;
    for (const auto& [start, unused] : next) {
      if (!seen.insert(start).second) continue;
      std::vector<GridPoint> piece = {start};
      for (std::size_t i = 0; i < piece.size(); ++i)
        for (GridPoint p : next[piece[i]])
          if (seen.insert(p).second) piece.push_back(p);
      smallest = std::min(smallest, piece.size());
    }
  }
  return smallest;
}

std::size_t count_vertices(const std::vector<Edge>& edges) {
  std::set<GridPoint> points;
  for (const Edge& e : edges) points.insert({e.a, e.b});
  return points.size();
}

}  // namespace stackmesh::contour_tests
