#include "validate/check_topology.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <queue>

#include "base/disjoint_sets.h"
#include "base/parallel.h"

namespace stackmesh {
namespace {

constexpr int kAcross = 600;  // pixels over drawn sections

/// One label's pixels in the box that holds it.
struct Mask {
  int width = 0, height = 0;  // with a rim of background
  std::vector<std::uint8_t> in;
};

/// How deep each pixel lies: how many outlines of the label go round it.
std::vector<std::int16_t> depths(const Mask& m) {
  std::vector<std::int16_t> depth(m.in.size(), -1);
  std::vector<std::int32_t> front = {0}, next;
  depth[0] = 0;
  // From the outside in: a region takes over its depth, the regions beside it lie one deeper. Background joins over
  // corners.
  while (!front.empty()) {
    next.clear();
    while (!front.empty()) {
      const std::int32_t p = front.back();
      front.pop_back();
      const int x = p % m.width, y = p / m.width;
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          const int u = x + dx, v = y + dy;
          if ((dx == 0 && dy == 0) || u < 0 || v < 0 || u >= m.width || v >= m.height) continue;
          const std::int32_t q = v * m.width + u;
          if (depth[q] >= 0) continue;
          const bool straight = dx == 0 || dy == 0;
          if (m.in[q] == m.in[p] && (straight || !m.in[p])) {
            depth[q] = depth[p];
            front.push_back(q);
          } else if (m.in[q] != m.in[p] && straight) {
            next.push_back(q);
          }
        }
    }
    // Of what lies beside, all that is still unknown starts one deeper than its known neighbour of the other kind.
    for (std::int32_t q : next) {
      if (depth[q] >= 0) continue;
      const int x = q % m.width, y = q / m.width;
      std::int16_t out = std::numeric_limits<std::int16_t>::max();
      for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
        const int u = x + dx, v = y + dy;
        if (u < 0 || v < 0 || u >= m.width || v >= m.height) continue;
        const std::int32_t p = v * m.width + u;
        if (depth[p] >= 0 && m.in[p] != m.in[q]) out = std::min(out, depth[p]);
      }
      depth[q] = static_cast<std::int16_t>(out + 1);
      front.push_back(q);
    }
  }
  return depth;
}

/// Components of the pixels at a depth or deeper; -1: none.
int components(const std::vector<char>& in, int width, std::vector<std::int32_t>& of) {
  DisjointSets sets(in.size());
  for (std::size_t p = 0; p < in.size(); ++p) {
    if (!in[p]) continue;
    if (p % width != 0 && in[p - 1]) sets.join(static_cast<std::int32_t>(p - 1), static_cast<std::int32_t>(p));
    if (p >= static_cast<std::size_t>(width) && in[p - width])
      sets.join(static_cast<std::int32_t>(p - width), static_cast<std::int32_t>(p));
  }
  of.assign(in.size(), -1);
  int count = 0;
  for (std::size_t p = 0; p < in.size(); ++p)
    if (in[p]) {
      const std::int32_t root = sets.find(static_cast<std::int32_t>(p));
      if (of[root] < 0) of[root] = count++;
      of[p] = of[root];
    }
  return count;
}

/// A label's slices, one after the other, to what they imply.
void imply(const std::vector<Mask>& slices, LabelTopology& out) {
  std::vector<std::vector<std::int16_t>> depth;
  int deepest = 0;
  for (const Mask& m : slices) {
    depth.push_back(depths(m));
    deepest = std::max<int>(deepest, *std::max_element(depth.back().begin(), depth.back().end()));
  }
  const auto at_least = [&](std::size_t k, int d) {
    std::vector<char> in(depth[k].size());
    for (std::size_t p = 0; p < in.size(); ++p) in[p] = depth[k][p] >= d;
    return in;
  };
  for (int d = 1; d <= deepest; ++d) {
    const bool hollow = d % 2 == 0;
    DisjointSets bodies;
    long nodes = 0, edges = 0;
    std::vector<long> openings;  // by node
    std::vector<std::int32_t> below, here, common;
    std::vector<char> in_below;
    std::int32_t first_below = 0;
    int count_below = 0;
    for (std::size_t k = 0; k <= slices.size(); ++k) {
      std::vector<char> in;
      int count = 0;
      const std::int32_t first = static_cast<std::int32_t>(nodes);
      if (k < slices.size()) {
        in = at_least(k, d);
        count = components(in, slices[k].width, here);
      }
      for (int i = 0; i < count; ++i) bodies.add(), openings.push_back(0);
      nodes += count;
      std::vector<char> goes_up(count_below, 0), comes_up(count, 0);
      if (k > 0 && k < slices.size()) {
        std::vector<char> both(in.size());
        for (std::size_t p = 0; p < both.size(); ++p) both[p] = in[p] && in_below[p];
        edges += components(both, slices[k].width, common);
        for (std::size_t p = 0; p < both.size(); ++p)
          if (both[p]) {
            bodies.join(first_below + below[p], first + here[p]);
            goes_up[below[p]] = comes_up[here[p]] = 1;
          }
      }
      if (hollow) {  // a hollow that does not go on is open where no wall closes it
        const auto open = [&](const std::vector<std::int32_t>& of, int n, const std::vector<char>& on,
                              std::int32_t base, std::size_t other, bool exists) {
          std::vector<std::size_t> all(n, 0), bare(n, 0);
          for (std::size_t p = 0; p < of.size(); ++p)
            if (of[p] >= 0) {
              ++all[of[p]];
              bare[of[p]] += !exists || depth[other][p] < d - 1;
            }
          for (int i = 0; i < n; ++i)
            if (!on[i] && 2 * bare[i] > all[i]) ++openings[base + i];
        };
        if (k > 0) open(below, count_below, goes_up, first_below, k, k < slices.size());
        if (k < slices.size()) open(here, count, comes_up, first, k - 1, k > 0);
      }
      below = here;
      in_below = std::move(in);
      first_below = first;
      count_below = count;
    }
    std::map<std::int32_t, long> open_of;
    for (std::int32_t i = 0; i < nodes; ++i) open_of[bodies.find(i)] += openings[i];
    const long parts = static_cast<long>(open_of.size());
    out.implied_handles += edges - nodes + parts;
    if (hollow)
      for (const auto& [body, n] : open_of) out.implied_handles += std::max(0L, n - 1);
    else out.implied_pieces += static_cast<int>(parts);
  }
}

struct Drawn {
  double ax, ay, bx, by;
  Label left, right;
};

/// A label's pixels in a section, by crossings along the rows.
Mask raster(const std::vector<Drawn>& edges, Label label, double x0, double y0, double pixel, int width, int height) {
  Mask m;
  m.width = width;
  m.height = height;
  m.in.assign(static_cast<std::size_t>(width) * height, 0);
  std::vector<std::vector<double>> crossings(height);
  for (const Drawn& e : edges) {
    if ((e.left == label) == (e.right == label) || e.ay == e.by) continue;
    const double low = std::min(e.ay, e.by), high = std::max(e.ay, e.by);
    const int from = std::max(0, static_cast<int>(std::ceil((low - y0) / pixel))),
              to = std::min(height - 1, static_cast<int>(std::ceil((high - y0) / pixel)) - 1);
    for (int y = from; y <= to; ++y)
      crossings[y].push_back(e.ax + (e.bx - e.ax) * (y0 + y * pixel - e.ay) / (e.by - e.ay));
  }
  for (int y = 0; y < height; ++y) {
    std::sort(crossings[y].begin(), crossings[y].end());
    for (std::size_t i = 0; i + 1 < crossings[y].size(); i += 2) {
      const int from = std::max(0, static_cast<int>(std::ceil((crossings[y][i] - x0) / pixel))),
                to = std::min(width - 1, static_cast<int>(std::floor((crossings[y][i + 1] - x0) / pixel)));
      for (int x = from; x <= to; ++x) m.in[static_cast<std::size_t>(y) * width + x] = 1;
    }
  }
  return m;
}

LabelTopology found(const LabelSurface& s) {
  LabelTopology t;
  t.label = s.label;
  t.handles = s.genus;
  t.pieces = s.components;
  return t;
}

using Edge = std::pair<std::int32_t, std::int32_t>;  // its vertices, ascending

/// The shortest ways over a shell's edges, as trees: for each vertex the length of its way in mm, and the vertex before
/// it, -1 at a tree's start.
using Ways = std::map<std::int32_t, std::pair<double, std::int32_t>>;

Ways shortest_ways(const InterfaceComplex& c, const std::map<std::int32_t, std::vector<std::int32_t>>& beside) {
  Ways way;
  for (const auto& start : beside) {
    if (way.count(start.first)) continue;
    std::priority_queue<std::pair<double, std::int32_t>, std::vector<std::pair<double, std::int32_t>>, std::greater<>>
        queue;
    queue.push({0, start.first});
    way[start.first] = {0, -1};
    while (!queue.empty()) {
      const auto [length, v] = queue.top();
      queue.pop();
      if (length > way[v].first) continue;
      for (std::int32_t w : beside.at(v)) {
        const double to = length + norm(c.points[w] - c.points[v]);
        const auto it = way.find(w);
        if (it != way.end() && it->second.first <= to) continue;
        way[w] = {to, v};
        queue.push({to, w});
      }
    }
  }
  return way;
}

/// The loop that an edge closes with the ways to its ends: its place and size.
HandlePlace loop_over(const InterfaceComplex& c, const Edge& edge, const Ways& way) {
  std::vector<std::int32_t> a = {edge.first}, b = {edge.second};
  for (std::vector<std::int32_t>* path : {&a, &b})
    while (way.at(path->back()).second >= 0) path->push_back(way.at(path->back()).second);
  while (a.size() > 1 && b.size() > 1 && a[a.size() - 2] == b[b.size() - 2]) a.pop_back(), b.pop_back();
  a.insert(a.end(), b.begin(), b.end());
  HandlePlace p;
  Vec3 low = c.points[a[0]], high = low;
  for (std::int32_t v : a) {
    const Vec3& q = c.points[v];
    low = {std::min(low.x, q.x), std::min(low.y, q.y), std::min(low.z, q.z)};
    high = {std::max(high.x, q.x), std::max(high.y, q.y), std::max(high.z, q.z)};
  }
  p.where = 0.5 * (low + high);
  p.size_mm = std::max({high.x - low.x, high.y - low.y, high.z - low.z});
  return p;
}

/// The smallest places, without those that lie within another one: the loop round a tunnel and the one through it lie
/// at one place.
std::vector<HandlePlace> smallest(std::vector<HandlePlace> places, std::size_t most) {
  std::stable_sort(places.begin(), places.end(),
                   [](const HandlePlace& a, const HandlePlace& b) { return a.size_mm < b.size_mm; });
  std::vector<HandlePlace> out;
  for (HandlePlace& p : places) {
    if (out.size() == most) break;
    const bool same = std::any_of(out.begin(), out.end(),
                                  [&](const HandlePlace& q) { return norm(q.where - p.where) < 0.5 * q.size_mm; });
    if (!same) out.push_back(std::move(p));
  }
  return out;
}

}  // namespace

std::vector<LabelTopology> check_topology(const SurfaceCheck& surface, const LabelVolume& volume,
                                          const TopologyOptions& o) {
  std::vector<LabelTopology> out;
  for (const LabelSurface& s : surface.labels)
    if (s.closed && s.genus > 0) out.push_back(found(s));
  if (out.empty() || volume.voxels.empty()) return {};
  const int u = (o.axis + 1) % 3, v = (o.axis + 2) % 3;
  struct Box {
    std::array<int, 3> low = {1 << 30, 1 << 30, 1 << 30}, high = {-1, -1, -1};
  };
  std::vector<Box> boxes(volume.labels.size());
  for (int k = 0; k < volume.size[2]; ++k)
    for (int j = 0; j < volume.size[1]; ++j)
      for (int i = 0; i < volume.size[0]; ++i) {
        Box& b = boxes[volume.voxels[volume.index(i, j, k)]];
        const std::array<int, 3> at = {i, j, k};
        for (int d = 0; d < 3; ++d) b.low[d] = std::min(b.low[d], at[d]), b.high[d] = std::max(b.high[d], at[d]);
      }
  const auto index_of = [&](Label l) {
    for (std::size_t k = 1; k < volume.labels.size(); ++k)
      if (volume.labels[k].number == l) return k;
    return std::size_t{0};
  };
  double pixels = 0;
  for (const LabelTopology& t : out) {
    const Box& b = boxes[index_of(t.label)];
    pixels += std::max(0.0, (b.high[0] - b.low[0] + 3.0) * (b.high[1] - b.low[1] + 3.0) * (b.high[2] - b.low[2] + 3.0));
  }
  if (pixels > o.most_pixels) return {};
  parallel_for(out.size(), o.threads, [&](std::size_t n) {
    const std::size_t index = index_of(out[n].label);
    const Box& b = boxes[index];
    if (index == 0 || b.high[0] < 0) return;
    std::vector<Mask> slices;
    for (int k = b.low[o.axis]; k <= b.high[o.axis]; ++k) {
      Mask m;
      m.width = b.high[u] - b.low[u] + 3;
      m.height = b.high[v] - b.low[v] + 3;
      m.in.assign(static_cast<std::size_t>(m.width) * m.height, 0);
      for (int y = 0; y + 2 < m.height; ++y)
        for (int x = 0; x + 2 < m.width; ++x) {
          std::array<int, 3> at{};
          at[o.axis] = k, at[u] = b.low[u] + x, at[v] = b.low[v] + y;
          m.in[static_cast<std::size_t>(y + 1) * m.width + x + 1] =
              volume.voxels[volume.index(at[0], at[1], at[2])] == index;
        }
      slices.push_back(std::move(m));
    }
    imply(slices, out[n]);
  });
  return out;
}

std::vector<LabelTopology> check_topology(const SurfaceCheck& surface, const Stack& stack, const TopologyOptions& o) {
  std::vector<LabelTopology> out;
  for (const LabelSurface& s : surface.labels)
    if (s.closed) out.push_back(found(s));
  std::vector<std::vector<Drawn>> sections;
  double x0 = 1e300, y0 = 1e300, x1 = -1e300, y1 = -1e300;
  for (const Section& s : stack.sections) {
    if (s.interpolated) continue;
    sections.emplace_back();
    for (const SectionEdge& e : s.edges) {
      const GridPoint a = s.points[e.a], b = s.points[e.b];
      sections.back().push_back({a.x * stack.grid_x_mm, a.y * stack.grid_y_mm, b.x * stack.grid_x_mm,
                                 b.y * stack.grid_y_mm, e.left, e.right});
      for (const GridPoint p : {a, b}) {
        x0 = std::min(x0, p.x * stack.grid_x_mm), x1 = std::max(x1, p.x * stack.grid_x_mm);
        y0 = std::min(y0, p.y * stack.grid_y_mm), y1 = std::max(y1, p.y * stack.grid_y_mm);
      }
    }
  }
  if (!(x1 > x0) || !(y1 > y0)) return {};
  const double pixel = 1.0001 * std::max(x1 - x0, y1 - y0) / kAcross;
  const int width = static_cast<int>((x1 - x0) / pixel) + 5, height = static_cast<int>((y1 - y0) / pixel) + 5;
  if (static_cast<double>(width) * height * static_cast<double>(sections.size() * out.size()) > o.most_pixels)
    return {};
  parallel_for(out.size(), o.threads, [&](std::size_t n) {
    std::vector<Mask> slices;
    for (const std::vector<Drawn>& edges : sections)
      slices.push_back(raster(edges, out[n].label, x0 - 1.53 * pixel, y0 - 1.53 * pixel, pixel, width, height));
    imply(slices, out[n]);
  });
  return out;
}

std::vector<HandlePlace> find_handles(const InterfaceComplex& c, Label label, std::size_t most) {
  // Tree and cotree [Eppstein 2003]: shortest ways to the vertices of a shell, then a tree of triangles that crosses
  // none of them; each edge in neither closes a loop round a handle.
  std::vector<std::int32_t> faces;
  for (std::size_t t = 0; t < c.triangles.size(); ++t)
    if ((c.triangles[t].below == label) != (c.triangles[t].above == label))
      faces.push_back(static_cast<std::int32_t>(t));
  std::map<Edge, std::vector<std::int32_t>> edges;
  std::map<std::int32_t, std::vector<std::int32_t>> beside;
  for (std::int32_t t : faces)
    for (int i = 0; i < 3; ++i) {
      const auto key = std::minmax(c.triangles[t].v[i], c.triangles[t].v[(i + 1) % 3]);
      auto& list = edges[key];
      if (list.empty()) beside[key.first].push_back(key.second), beside[key.second].push_back(key.first);
      list.push_back(t);
    }
  Ways way = shortest_ways(c, beside);
  const auto in_tree = [&](const Edge& e) {
    return way[e.first].second == e.second || way[e.second].second == e.first;
  };
  // The longest loops leave first: a spanning forest of triangles over the edges in falling order of the loop they
  // would close.
  struct Loop {
    double length;
    Edge edge;
  };
  std::vector<Loop> loops;
  for (const auto& [e, sides] : edges)
    if (!in_tree(e))
      loops.push_back({way[e.first].first + way[e.second].first + norm(c.points[e.first] - c.points[e.second]), e});
  std::stable_sort(loops.begin(), loops.end(), [](const Loop& a, const Loop& b) { return a.length > b.length; });
  DisjointSets joined(c.triangles.size());
  std::vector<Loop> left;
  for (const Loop& l : loops) {
    const auto& sides = edges[l.edge];
    if (sides.size() == 2 && joined.find(sides[0]) != joined.find(sides[1])) joined.join(sides[0], sides[1]);
    else if (sides.size() == 2) left.push_back(l);
  }
  std::vector<HandlePlace> places;
  for (const Loop& l : left) {
    HandlePlace p = loop_over(c, l.edge, way);
    p.triangles = edges[l.edge];
    places.push_back(std::move(p));
  }
  return smallest(std::move(places), most);
}

}  // namespace stackmesh
