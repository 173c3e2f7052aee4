#include "volume/layer_columns.h"

#include <algorithm>
#include <cmath>
#include <queue>

#include "base/parallel.h"
#include "model/triangle_contact.h"
#include "volume/label_tets.h"
#include "volume/triangle_grid.h"

namespace stackmesh::volume {
namespace {

constexpr double kFacing = 0.4;     // of the way to an outer face opposite, which may have a layer of its own
constexpr double kOpposite = 0.7;   // of the way to any other face opposite
constexpr double kRise = 0.6;       // of an edge: how much thicker a layer may be at its other end
constexpr double kThinnest = 0.15;  // of the thickness: below it there is no layer
constexpr double kSeen = 0.2;       // cosine between a column and the normals of the faces about it
constexpr double kUpright = 0.3;    // the same of the elements' ends
constexpr double kNarrower = 0.25;  // a face's inner end over the face, by area
// of the thickness, or an inner end's shortest edge: how far inner ends stay apart
constexpr double kClear = 0.3;
constexpr double kFolded = 0.9;  // cosine between inner ends at their common edge
constexpr double kLess = 0.7;
constexpr int kRounds = 200;
constexpr std::size_t kChunk = 256;

Vec3 unit(Vec3 v) {
  const double length = norm(v);
  return length > 0 ? (1 / length) * v : Vec3{};
}

/// Distance along a unit ray to a triangle; infinite where it is not met.
double hit(const Vec3& from, const Vec3& ray, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 u = b - a, v = c - a, n = cross(ray, v), s = from - a, q = cross(s, u);
  const double det = dot(u, n);
  if (det == 0) return 1e300;
  const double x = dot(s, n) / det, y = dot(ray, q) / det, t = dot(v, q) / det;
  return x >= -1e-9 && y >= -1e-9 && x + y <= 1 + 1e-9 && t > 0 ? t : 1e300;
}

class ColumnFinder {
 public:
  ColumnFinder(const std::vector<Vec3>& points, const std::vector<InterfaceTriangle>& faces, Label label,
               const LayerSize& size, int threads)
      : points_(points), faces_(faces), label_(label), size_(size), threads_(threads) {}

  Columns run() {
    out_.way.resize(points_.size());
    out_.thickness.assign(points_.size(), 0);
    out_.why.assign(points_.size(), LayerLimit::none);
    collect();
    find_ways();
    smooth_ways();
    for (const std::int32_t v : corners_)
      if (norm(out_.way[v]) > 0) out_.thickness[v] = size_.thickness_mm;
    limit_by_room();
    changed_.assign(points_.size(), 1);
    for (int round = 0; settle(), draw_back(round); ++round) {
    }
    return std::move(out_);
  }

 private:
  bool is_outer(const InterfaceTriangle& f) const {
    return (f.below == label_ && f.above == 0) || (f.below == 0 && f.above == label_);
  }

  /// Outer faces with their normals, all faces of the label, the corners of outer faces with their neighbours.
  void collect() {
    around_.resize(points_.size());
    std::vector<char> other(points_.size(), 0), corner(points_.size(), 0);
    for (std::size_t i = 0; i < faces_.size(); ++i) {
      const InterfaceTriangle& f = faces_[i];
      if (f.below == f.above) continue;
      if (f.below == label_ || f.above == label_) bound_.push_back(static_cast<std::int32_t>(i));
      const bool outer = is_outer(f);
      if (outer) outer_.push_back(static_cast<std::int32_t>(i));
      for (const std::int32_t v : f.v) {
        if (outer) around_[v].push_back(static_cast<std::int32_t>(i)), corner[v] = 1;
        else other[v] = 1;
      }
    }
    normals_.resize(faces_.size());
    for (const std::int32_t i : outer_) {
      const auto& v = faces_[i].v;
      const Vec3 n = unit(cross(points_[v[1]] - points_[v[0]], points_[v[2]] - points_[v[0]]));
      normals_[i] = faces_[i].below == 0 ? n : -1.0 * n;
    }
    for (std::size_t v = 0; v < points_.size(); ++v) {
      if (!corner[v]) continue;
      corners_.push_back(static_cast<std::int32_t>(v));
      if (other[v] || !is_disc(static_cast<std::int32_t>(v))) out_.why[v] = LayerLimit::junction;
    }
    neighbours_.resize(points_.size());
    for (const std::int32_t v : corners_) {
      for (const std::int32_t f : around_[v])
        for (const std::int32_t w : faces_[f].v)
          if (w != v) neighbours_[v].push_back(w);
      std::sort(neighbours_[v].begin(), neighbours_[v].end());
      neighbours_[v].erase(std::unique(neighbours_[v].begin(), neighbours_[v].end()), neighbours_[v].end());
    }
  }

  /// The faces about a point follow each other once round.
  bool is_disc(std::int32_t v) const {
    std::map<std::int32_t, std::int32_t> next;
    for (const std::int32_t f : around_[v]) {
      const auto& c = faces_[f].v;
      const int k = c[0] == v ? 0 : c[1] == v ? 1 : 2;
      const bool as_is = faces_[f].below == 0;
      const std::int32_t from = c[(k + (as_is ? 1 : 2)) % 3], to = c[(k + (as_is ? 2 : 1)) % 3];
      if (!next.insert({from, to}).second) return false;
    }
    std::size_t steps = 0;
    std::int32_t at = next.begin()->first;
    do {
      const auto found = next.find(at);
      if (found == next.end()) return false;
      at = found->second;
    } while (++steps < next.size() && at != next.begin()->first);
    return steps == next.size() && at == next.begin()->first;
  }

  double angle_at(std::int32_t face, std::int32_t v) const {
    const auto& c = faces_[face].v;
    const int k = c[0] == v ? 0 : c[1] == v ? 1 : 2;
    const Vec3 a = unit(points_[c[(k + 1) % 3]] - points_[v]), b = unit(points_[c[(k + 2) % 3]] - points_[v]);
    return std::acos(std::clamp(dot(a, b), -1.0, 1.0));
  }

  double least_cosine(std::int32_t v, const Vec3& way) const {
    double least = 1;
    for (const std::int32_t f : around_[v]) least = std::min(least, dot(way, normals_[f]));
    return least;
  }

  /// A direction and how far to go along it for a millimetre at right angles to the faces (their mean by angle).
  Vec3 measured(std::int32_t v, const Vec3& way) const {
    double sum = 0, angles = 0;
    for (const std::int32_t f : around_[v]) {
      const double angle = angle_at(f, v);
      sum += angle * dot(way, normals_[f]);
      angles += angle;
    }
    return std::min(2.0, angles / sum) * way;
  }

  /// The direction that all faces about a point see best.
  void find_ways() {
    for (const std::int32_t v : corners_) {
      if (out_.why[v] == LayerLimit::junction) continue;
      Vec3 way;
      for (const std::int32_t f : around_[v]) way = way + angle_at(f, v) * normals_[f];
      way = unit(way);
      Vec3 best = way;
      double seen = least_cosine(v, way);
      for (int step = 0; step < 40 && seen < 0.95; ++step) {
        std::int32_t worst = around_[v][0];
        for (const std::int32_t f : around_[v])
          if (dot(way, normals_[f]) < dot(way, normals_[worst])) worst = f;
        way = unit(way + (0.4 / (1 + step)) * normals_[worst]);
        if (const double now = least_cosine(v, way); now > seen + 1e-6) seen = now, best = way;
      }
      if (seen < kSeen) out_.why[v] = LayerLimit::shape;
      else out_.way[v] = measured(v, best);
    }
  }

  /// Where the layer is thicker than edges are long, columns near a ridge lean with those on it.
  void smooth_ways() {
    double length = 0;
    std::size_t count = 0;
    for (const std::int32_t v : corners_)
      for (const std::int32_t w : neighbours_[v]) length += norm(points_[w] - points_[v]), ++count;
    if (count == 0) return;
    const int passes =
        std::min(10, static_cast<int>(std::ceil(2 * size_.thickness_mm * static_cast<double>(count) / length)));
    for (int pass = 0; pass < passes; ++pass) {
      std::vector<Vec3> next(corners_.size());
      for (std::size_t i = 0; i < corners_.size(); ++i) {
        const std::int32_t v = corners_[i];
        next[i] = out_.way[v];
        const Vec3 own = unit(out_.way[v]);
        if (norm(own) == 0 || least_cosine(v, own) < 0.85) continue;  // on a ridge
        Vec3 sum = own;
        for (const std::int32_t w : neighbours_[v])
          sum = sum + (1.0 / static_cast<double>(neighbours_[v].size())) * unit(out_.way[w]);
        if (const Vec3 way = unit(sum); least_cosine(v, way) >= 0.8) next[i] = measured(v, way);
      }
      for (std::size_t i = 0; i < corners_.size(); ++i) out_.way[corners_[i]] = next[i];
    }
  }

  void limit_by_room() {
    std::vector<BoxGrid::Box> boxes(bound_.size());
    for (std::size_t i = 0; i < bound_.size(); ++i)
      for (const std::int32_t v : faces_[bound_[i]].v) boxes[i].add(points_[v]);
    const BoxGrid grid(std::move(boxes));
    parallel_for((corners_.size() + kChunk - 1) / kChunk, threads_, [&](std::size_t chunk) {
      std::vector<std::int32_t> near;
      for (std::size_t i = chunk * kChunk; i < std::min(corners_.size(), (chunk + 1) * kChunk); ++i) {
        const std::int32_t v = corners_[i];
        if (out_.thickness[v] == 0) continue;
        const Vec3 ray = unit(out_.way[v]);
        BoxGrid::Box box;
        box.add(points_[v]);
        box.add(points_[v] + (size_.thickness_mm / kFacing * norm(out_.way[v])) * ray);
        grid.near(box, near);
        for (const std::int32_t b : near) {
          const InterfaceTriangle& f = faces_[bound_[b]];
          if (f.v[0] == v || f.v[1] == v || f.v[2] == v) continue;
          const double room = (is_outer(f) ? kFacing : kOpposite) *
                              hit(points_[v], ray, points_[f.v[0]], points_[f.v[1]], points_[f.v[2]]) /
                              norm(out_.way[v]);
          if (room < out_.thickness[v]) out_.thickness[v] = room, out_.why[v] = LayerLimit::room;
        }
      }
    });
  }

  void give_up(std::int32_t v) {
    out_.thickness[v] = 0;
    changed_[v] = 1;
    if (out_.why[v] == LayerLimit::none) out_.why[v] = LayerLimit::beside;
  }

  /// Thickness rises gently from where it is small; what is very thin, or stands alone, is given up; until nothing
  /// changes.
  void settle() {
    for (bool again = true; again;) {
      again = false;
      rise();
      for (const std::int32_t v : corners_)
        if (out_.thickness[v] > 0 && out_.thickness[v] < kThinnest * size_.thickness_mm) give_up(v), again = true;
      for (const std::int32_t v : corners_) {
        if (out_.thickness[v] == 0) continue;
        if (std::none_of(neighbours_[v].begin(), neighbours_[v].end(),
                         [&](std::int32_t w) { return out_.thickness[w] > 0; }))
          give_up(v), again = true;
      }
    }
  }

  void rise() {
    using Entry = std::pair<double, std::int32_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    for (const std::int32_t v : corners_)
      if (out_.thickness[v] < size_.thickness_mm) queue.push({out_.thickness[v], v});
    while (!queue.empty()) {
      const auto [t, v] = queue.top();
      queue.pop();
      if (t > out_.thickness[v]) continue;
      for (const std::int32_t w : neighbours_[v]) {
        const double most = t + kRise * norm(points_[w] - points_[v]);
        if (!(most < out_.thickness[w])) continue;
        out_.thickness[w] = most;
        changed_[w] = 1;
        out_.why[w] = LayerLimit::beside;
        queue.push({most, w});
      }
    }
  }

  Vec3 level(std::int32_t v, int k) const {
    return level_of_column(points_[v], out_.way[v], out_.thickness[v], k, size_.count);
  }
  Vec3 foot(std::int32_t v) const { return level(v, size_.count); }

  bool has_changed(const InterfaceTriangle& f) const {
    return changed_[f.v[0]] || changed_[f.v[1]] || changed_[f.v[2]];
  }

  /// Are a face's elements sound, and not too flat?
  bool stands(const InterfaceTriangle& face) const {
    const LayerFace f = layer_face(face, out_.thickness);
    if (f.columns == 0) return true;
    std::array<Vec3, 3> low, high, top;
    for (int k = 0; k < 3; ++k) low[k] = points_[f.v[k]], top[k] = foot(f.v[k]);
    const Vec3 n = cross(low[1] - low[0], low[2] - low[0]), m = cross(top[1] - top[0], top[2] - top[0]);
    if (!(dot(n, m) >= kNarrower * dot(n, n))) return false;
    for (int k = 0; k < f.columns; ++k) {
      const Vec3 d = top[k] - low[k];
      if (!(dot(d, n) >= kUpright * norm(d) * norm(n)) || !(dot(d, m) >= kUpright * norm(d) * norm(m))) return false;
    }
    for (int s = 0; s < size_.count; ++s) {
      for (int k = 0; k < 3; ++k) low[k] = level(f.v[k], s), high[k] = level(f.v[k], s + 1);
      if (!sheet_is_positive(low, high, f.columns)) return false;
    }
    return true;
  }

  /// Marks what is wrong with changed faces and shortens the columns there; true when there was anything.
  bool draw_back(int round) {
    std::vector<std::int32_t> active;
    for (const std::int32_t i : outer_)
      if (has_changed(faces_[i])) active.push_back(i);
    std::vector<char> bad(faces_.size(), 0);
    parallel_for((active.size() + kChunk - 1) / kChunk, threads_, [&](std::size_t chunk) {
      for (std::size_t i = chunk * kChunk; i < std::min(active.size(), (chunk + 1) * kChunk); ++i)
        bad[active[i]] = !stands(faces_[active[i]]);
    });
    if (std::none_of(bad.begin(), bad.end(), [](char b) { return b != 0; })) find_crossings(active, bad);
    std::fill(changed_.begin(), changed_.end(), 0);
    std::vector<char> shorter(points_.size(), 0);
    bool any = false;
    for (const std::int32_t i : bound_)
      if (bad[i])
        for (const std::int32_t v : faces_[i].v)
          if (out_.thickness[v] > 0) shorter[v] = 1, any = true;
    for (const std::int32_t v : corners_) {
      if (!shorter[v]) continue;
      changed_[v] = 1;
      out_.why[v] = LayerLimit::shape;
      out_.thickness[v] = round < kRounds ? kLess * out_.thickness[v] : 0;
    }
    // Faces that were found sound but hang on those are looked at again; what was never looked at for crossings, too.
    if (any)
      for (const std::int32_t i : active)
        for (const std::int32_t v : faces_[i].v) changed_[v] = 1;
    return any;
  }

  void find_crossings(const std::vector<std::int32_t>& active, std::vector<char>& bad) const {
    const auto n = static_cast<std::int32_t>(points_.size());
    std::vector<std::array<std::int32_t, 3>> ids(bound_.size());
    std::vector<Corners3> at(bound_.size());
    std::vector<double> clear(bound_.size(), 0);  // of a face: wanted about it
    std::vector<BoxGrid::Box> boxes(bound_.size());
    std::vector<std::int32_t> place(faces_.size(), -1);
    for (std::size_t i = 0; i < bound_.size(); ++i) {
      const InterfaceTriangle& f = faces_[bound_[i]];
      place[bound_[i]] = static_cast<std::int32_t>(i);
      double least = 1e300;
      for (int k = 0; k < 3; ++k) {
        const bool moved = out_.thickness[f.v[k]] > 0;
        ids[i][k] = f.v[k] + (moved ? n : 0);
        at[i][k] = moved ? foot(f.v[k]) : points_[f.v[k]];
        boxes[i].add(at[i][k]);
        if (moved) least = std::min(least, out_.thickness[f.v[k]]);
      }
      double shortest = 1e300;
      for (int k = 0; k < 3; ++k) shortest = std::min(shortest, norm(at[i][(k + 1) % 3] - at[i][k]));
      clear[i] = least < 1e300 ? kClear * std::min(least, shortest) : 0;
    }
    const BoxGrid grid(std::move(boxes));
    std::vector<std::vector<std::int32_t>> found((active.size() + kChunk - 1) / kChunk);
    parallel_for(found.size(), threads_, [&](std::size_t chunk) {
      std::vector<std::int32_t> near;
      for (std::size_t a = chunk * kChunk; a < std::min(active.size(), (chunk + 1) * kChunk); ++a) {
        const std::int32_t i = place[active[a]];
        if (clear[i] == 0) continue;
        BoxGrid::Box box;
        for (const Vec3& p : at[i]) box.add(p);
        box.widen(clear[i]);
        grid.near(box, near);
        for (const std::int32_t j : near) {
          if (j == i) continue;
          const double gap = clear[j] > 0 ? std::min(clear[i], clear[j]) : clear[i];
          if (too_near(ids[i], at[i], ids[j], at[j], bound_[i], bound_[j], gap))
            found[chunk].push_back(i), found[chunk].push_back(j);
        }
      }
    });
    for (const auto& list : found)
      for (const std::int32_t i : list) bad[bound_[i]] = 1;
  }

  bool too_near(const std::array<std::int32_t, 3>& si, const Corners3& s, const std::array<std::int32_t, 3>& ti,
                const Corners3& t, std::int32_t face_s, std::int32_t face_t, double gap) const {
    const SharedCorners shared = shared_corners(si, ti);
    if (shared.count == 0)
      return !certainly_apart(s, t, gap) && (triangles_meet(s, t, shared) || squared_distance(s, t) < gap * gap);
    if (triangles_meet(s, t, shared)) return true;
    if (shared.count != 2) return false;
    const double cosine = sheet_cosine(s, t, shared);
    if (cosine < kFolded) return false;
    Corners3 a, b;
    for (int k = 0; k < 3; ++k) a[k] = points_[faces_[face_s].v[k]], b[k] = points_[faces_[face_t].v[k]];
    return cosine > sheet_cosine(a, b, shared) + 1e-9;
  }

  const std::vector<Vec3>& points_;
  const std::vector<InterfaceTriangle>& faces_;
  const Label label_;
  const LayerSize size_;
  const int threads_;
  Columns out_;
  std::vector<std::int32_t> outer_, bound_, corners_;
  std::vector<Vec3> normals_;  // of outer faces, into the label
  std::vector<std::vector<std::int32_t>> around_, neighbours_;
  std::vector<char> changed_;
};

}  // namespace

Vec3 level_of_column(const Vec3& point, const Vec3& way, double thickness_mm, int level, int count) {
  if (level == 0 || thickness_mm == 0) return point;
  return point + (level == count ? thickness_mm : thickness_mm * level / count) * way;
}

LayerFace layer_face(const InterfaceTriangle& face, const std::vector<double>& thickness) {
  LayerFace out;
  out.v = face.below == 0 ? face.v : std::array<std::int32_t, 3>{face.v[0], face.v[2], face.v[1]};
  for (const std::int32_t v : out.v) out.columns += thickness[v] > 0;
  const auto turn = [&] { out.v = {out.v[1], out.v[2], out.v[0]}; };
  if (out.columns == 2)
    while (thickness[out.v[2]] > 0) turn();
  if (out.columns == 1)
    while (thickness[out.v[0]] == 0) turn();
  return out;
}

bool sheet_is_positive(const std::array<Vec3, 3>& low, const std::array<Vec3, 3>& high, int columns) {
  const auto positive = [](const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    return orientation(a, b, c, d) > 0;
  };
  const auto& [a, b, c] = low;
  const auto& [d, e, f] = high;  // over a, b, c
  if (columns == 1) return positive(a, b, c, d);
  if (columns == 2) return positive(a, b, c, d) && positive(a, b, c, e) && positive(d, c, e, a) && positive(d, c, e, b);
  // All tets of four corners but the three sides: those at the corners, and those of an edge below and one above.
  return positive(a, b, c, d) && positive(a, b, c, e) && positive(a, b, c, f) && positive(d, f, e, a) &&
         positive(d, f, e, b) && positive(d, f, e, c) && positive(a, b, f, d) && positive(a, b, f, e) &&
         positive(b, c, d, e) && positive(b, c, d, f) && positive(c, a, e, f) && positive(c, a, e, d);
}

Columns find_columns(const std::vector<Vec3>& points, const std::vector<InterfaceTriangle>& faces, Label label,
                     const LayerSize& size, int threads) {
  return ColumnFinder(points, faces, label, size, threads).run();
}

}  // namespace stackmesh::volume
