#include "enhance/guard.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/cancel.h"
#include "base/parallel.h"

namespace stackmesh {
namespace {

// Shares of the clearance: nearer is contact, whatever was before; and well above that, and above rounding.
constexpr double kTouching = 1e-9, kClearlyApart = 1e-3;
constexpr double kWide = -0.5;  // cosine: two sheets further apart than this did not just turn through each other

/// On which side of the triangle p q x the point y lies: the sign.
double side_of(const Vec3& p, const Vec3& q, const Vec3& x, const Vec3& y) {
  return dot(cross(q - p, x - p), y - p);
}

/// True when one of two triangles at a common edge turned through the other about it: they are on the other side of
/// each other than before, and not by way of being flat. No exact test of crossings sees that, as both states are free
/// of them.
bool turned_past(double side_before, double cosine_before, double side, double cosine) {
  return (side_before > 0) != (side > 0) && side_before != 0 && side != 0 && cosine_before + cosine > 0;
}

double side_of(const Corners3& s, const Corners3& t, const SharedCorners& h) {
  return side_of(s[h.in_s[0]], s[h.in_s[1]], s[3 - h.in_s[0] - h.in_s[1]], t[3 - h.in_t[0] - h.in_t[1]]);
}

}  // namespace

TriangleGrid::Box TriangleGrid::box_of(const Corners3& c, double margin) {
  Box b;
  const auto set = [&](int k, double x, double y, double z) {
    const float low = static_cast<float>(std::min({x, y, z}) - margin),
                high = static_cast<float>(std::max({x, y, z}) + margin);
    b.low[k] = std::nextafter(low, -std::numeric_limits<float>::infinity());
    b.high[k] = std::nextafter(high, std::numeric_limits<float>::infinity());
  };
  set(0, c[0].x, c[1].x, c[2].x);
  set(1, c[0].y, c[1].y, c[2].y);
  set(2, c[0].z, c[1].z, c[2].z);
  return b;
}

void TriangleGrid::build(const ComplexMesh& mesh, const std::vector<Vec3>& points, double cell_mm,
                         std::vector<float> clearance) {
  inverse_ = static_cast<float>(1 / cell_mm);
  std::size_t size = 1024;
  while (size < mesh.triangles.size()) size *= 2;
  mask_ = size - 1;
  blocks_.assign(size, {});
  spare_.clear();
  boxes_.assign(mesh.triangles.size(), Box());
  clearance_ = std::move(clearance);
  for (std::int32_t t = 0; t < static_cast<std::int32_t>(mesh.triangles.size()); ++t)
    if (mesh.alive(t)) {
      const auto& v = mesh.triangles[t].v;
      insert(t, {points[v[0]], points[v[1]], points[v[2]]});
    }
}

void TriangleGrid::push(std::size_t bucket, std::int32_t t) {
  if (blocks_[bucket].count == static_cast<std::int32_t>(blocks_[bucket].items.size())) {
    std::int32_t n = static_cast<std::int32_t>(blocks_.size());
    if (spare_.empty()) {
      blocks_.emplace_back();
    } else {
      n = spare_.back();
      spare_.pop_back();
    }
    blocks_[n] = blocks_[bucket];
    blocks_[bucket].count = 0;
    blocks_[bucket].next = n;
  }
  Block& head = blocks_[bucket];
  head.items[head.count++] = t;
}

void TriangleGrid::drop(std::size_t bucket, std::int32_t t) {
  Block& head = blocks_[bucket];
  for (auto n = static_cast<std::int32_t>(bucket); n >= 0; n = blocks_[n].next) {
    Block& block = blocks_[n];
    const auto end = block.items.begin() + block.count, it = std::find(block.items.begin(), end, t);
    if (it == end) continue;
    *it = head.items[--head.count];
    if (head.count == 0 && head.next >= 0) {
      spare_.push_back(head.next);
      head = Block(blocks_[head.next]);
    }
    return;
  }
}

void TriangleGrid::insert(std::int32_t t, const Corners3& corners) {
  if (static_cast<std::size_t>(t) >= boxes_.size()) boxes_.resize(t + 1 + t / 4);
  Box& box = boxes_[t] = box_of(corners, clearance_.empty() ? 0.0 : 0.5 * clearance_[t]);
  box.cell = {cell(box.low[0]), cell(box.low[1]), cell(box.low[2])};
  each_cell(boxes_[t], [&](std::size_t b) { push(b, t); });
}

void TriangleGrid::remove(std::int32_t t) {
  each_cell(boxes_[t], [&](std::size_t b) { drop(b, t); });
  boxes_[t] = Box{{1, 1, 1}, {0, 0, 0}, {}};  // covers no cell
}

Guard::Guard(ComplexMesh& mesh, double sheet_angle_deg) : mesh_(mesh) {
  set_sheet_angle(sheet_angle_deg);
}

void Guard::rebuild(double cell_mm) {
  grid_.build(mesh_, mesh_.points, cell_mm);
  known_ = mesh_.triangles.size();
}

Corners3 Guard::corners(const std::array<std::int32_t, 3>& v, const Change* c) const {
  Corners3 out;
  for (int k = 0; k < 3; ++k) out[k] = c && v[k] == c->moved ? c->to : mesh_.points[v[k]];
  return out;
}

double Guard::narrowest_before(const Change& c) const {
  double cosine = -1;
  for (std::int32_t r : *c.removed) {
    const auto& v = mesh_.triangles[r].v;
    const Corners3 s = corners(v, nullptr);
    for (int k = 0; k < 3; ++k)
      for (std::int32_t o : mesh_.star[v[k]]) {
        if (o == r) continue;
        const SharedCorners h = shared_corners(v, mesh_.triangles[o].v);
        if (h.count == 2) cosine = std::max(cosine, sheet_cosine(s, corners(mesh_.triangles[o].v, nullptr), h));
      }
  }
  return cosine;
}

bool Guard::was_as_near(const Change& c, const std::array<std::int32_t, 3>& w, double squared) const {
  const Corners3 t = corners(w, nullptr);
  const double gap = (1 + 1e-6) * std::sqrt(squared);  // often they are exactly as near
  for (std::int32_t r : *c.removed) {
    const Corners3 s = corners(mesh_.triangles[r].v, nullptr);
    if (!certainly_apart(s, t, gap) && squared_distance(s, t) <= squared) return true;
  }
  return false;
}

bool Guard::turned_through(const std::array<std::int32_t, 3>& v, const Corners3& s,
                           const std::array<std::int32_t, 3>& w, const Corners3& t, const SharedCorners& h,
                           double cosine, const Change& c) const {
  if (cosine < kWide) return false;
  const std::int32_t a = v[h.in_s[0]], b = v[h.in_s[1]];
  // their edge moves as well
  if (a == c.moved || b == c.moved || w[0] == c.moved || w[1] == c.moved || w[2] == c.moved) return false;
  for (std::int32_t r : *c.removed) {
    const auto& old = mesh_.triangles[r].v;
    const auto at = [&](std::int32_t x) {
      return static_cast<int>(std::find(old.begin(), old.end(), x) - old.begin());
    };
    const int i = at(a), j = at(b);
    if (i == 3 || j == 3 || mesh_.triangles[r].v == w) continue;
    SharedCorners before = h;
    before.in_s[0] = i;
    before.in_s[1] = j;
    // The edge's only triangle that goes is what the new one stood for.
    const Corners3 o = corners(old, nullptr);
    const Vec3 &y = t[3 - h.in_t[0] - h.in_t[1]], &z = s[3 - h.in_s[0] - h.in_s[1]];
    if (turned_past(side_of(o, t, before), sheet_cosine(o, t, before), side_of(o[i], o[j], z, y), cosine)) return true;
  }
  return false;
}

bool Guard::pair_allowed(const std::array<std::int32_t, 3>& v, const Corners3& s, const std::array<std::int32_t, 3>& w,
                         const Change& c) {
  const SharedCorners h = shared_corners(v, w);
  const Corners3 t = corners(w, &c);
  if (h.count == 0) {
    // Triangles beside those that go were as near, at their common corner: for them it is enough not to touch.
    const bool beside = is_beside_removed(w);
    if (certainly_apart(s, t, (beside ? kClearlyApart : 1) * c.clearance_mm)) return true;
    if (triangles_meet(s, t, h)) return ++refused_contact, false;
    const double d = squared_distance(s, t), floor = kTouching * c.clearance_mm;
    if (d > c.clearance_mm * c.clearance_mm || (d > floor * floor && (beside || was_as_near(c, w, d)))) return true;
    return ++refused_clearance, false;
  }
  if (h.count == 2) {
    const double cosine = sheet_cosine(s, t, h);
    if (turned_through(v, s, w, t, h, cosine, c)) return ++refused_angle, false;
    if (cosine <= cosine_limit_) return true;
    if (cosine > narrowest_before(c) + 1e-9 || triangles_meet(s, t, h)) return ++refused_angle, false;
    return true;
  }
  if (triangles_meet(s, t, h)) return ++refused_contact, false;
  return true;
}

bool Guard::allows(const Change& c) {
  stop_if_cancelled();
  if (stamp_.size() < mesh_.triangles.size()) stamp_.resize(mesh_.triangles.size() * 5 / 4 + 16, 0);
  // A new vertex has no place in the mesh yet.
  if (corner_stamp_.size() < mesh_.points.size() + 1) corner_stamp_.resize(mesh_.points.size() * 5 / 4 + 16, 0);
  ++now_;
  for (std::int32_t r : *c.removed) {
    stamp_[r] = now_;
    for (std::int32_t v : mesh_.triangles[r].v) corner_stamp_[v] = now_;
  }
  const auto& added = *c.added;
  new_corners_.clear();
  new_boxes_.clear();
  for (const auto& v : added) {
    new_corners_.push_back(corners(v, &c));
    new_boxes_.push_back(TriangleGrid::box_of(new_corners_.back(), c.clearance_mm));
  }
  for (std::size_t i = 0; i < added.size(); ++i)
    for (std::size_t j = i + 1; j < added.size(); ++j)
      if (!pair_allowed(added[i], new_corners_[i], added[j], c)) return false;
  if (added.empty()) return true;
  TriangleGrid::Box all = new_boxes_[0];
  for (const TriangleGrid::Box& b : new_boxes_) all.include(b);
  return grid_.query(all, [&](std::int32_t t) {
    if (stamp_[t] == now_) return true;
    const TriangleGrid::Box& box = grid_.box(t);
    for (std::size_t i = 0; i < added.size(); ++i)
      if (box.meets(new_boxes_[i]) && !pair_allowed(added[i], new_corners_[i], mesh_.triangles[t].v, c)) return false;
    return true;
  });
}

void Guard::update(const std::vector<std::int32_t>& touched) {
  const auto known = [&](std::int32_t t) { return static_cast<std::size_t>(t) < known_; };
  for (std::int32_t t : touched) {
    if (known(t)) grid_.remove(t);
    if (mesh_.alive(t)) grid_.insert(t, corners(mesh_.triangles[t].v, nullptr));
  }
  known_ = std::max(known_, mesh_.triangles.size());
}

std::vector<float> clearances(const ComplexMesh& mesh, const MoveLimits& limits) {
  std::vector<float> out(mesh.triangles.size(), static_cast<float>(limits.clearance_mm));
  if (limits.size_mm)
    for (std::size_t t = 0; t < out.size(); ++t) {
      const auto& v = mesh.triangles[t].v;
      const auto& size = *limits.size_mm;
      if (mesh.triangles[t].patch >= 0)
        out[t] = static_cast<float>(
            std::max(limits.clearance_mm, limits.clearance_rel * std::min({size[v[0]], size[v[1]], size[v[2]]})));
    }
  return out;
}

namespace {

/// What triangles and pairs of them must keep when the vertices go from one place to another.
class MoveTest {
 public:
  MoveTest(const ComplexMesh& mesh, const std::vector<float>& clearance, const std::vector<Vec3>& before,
           const std::vector<Vec3>& points, const MoveLimits& limits)
      : mesh_(mesh),
        clearance_(clearance),
        before_(before),
        points_(points),
        sheet_(std::cos(limits.sheet_angle_deg * kDegree)),
        corner_(limits.corner_angle_deg * kDegree),
        turn_(std::cos(limits.turn_deg * kDegree)),
        turns_freely_(limits.turn_deg == 0) {}

  /// The two meet beyond what they share, turned through each other, or are nearer or narrower than they must be and
  /// were.
  bool offends(std::int32_t i, std::int32_t j) const {
    const SharedCorners h = shared_corners(mesh_.triangles[i].v, mesh_.triangles[j].v);
    const Corners3 s = at(points_, i), t = at(points_, j);
    if (h.count == 0) {
      const double gap = 0.5 * (clearance_[i] + clearance_[j]);
      if (certainly_apart(s, t, gap)) return false;
      if (triangles_meet(s, t, h)) return true;
      const double d = squared_distance(s, t);
      return d < gap * gap && d < squared_distance(at(before_, i), at(before_, j));
    }
    if (h.count == 2) {
      const double cosine = sheet_cosine(s, t, h);
      if (cosine < kWide) return false;
      const Corners3 s_before = at(before_, i), t_before = at(before_, j);
      const double cosine_before = sheet_cosine(s_before, t_before, h);
      if (turned_past(side_of(s_before, t_before, h), cosine_before, side_of(s, t, h), cosine)) return true;
      if (cosine <= sheet_) return false;
      return cosine > cosine_before || triangles_meet(s, t, h);
    }
    return triangles_meet(s, t, h);
  }

  /// The triangle has no area, a narrower angle than it may have and had, or turned too far.
  bool is_spoiled(std::int32_t i) const {
    const Corners3 s = at(points_, i);
    const Vec3 area = cross(s[1] - s[0], s[2] - s[0]);
    if (!(dot(area, area) > 0)) return true;
    if (corner_ == 0 && turns_freely_) return false;
    const Corners3 b = at(before_, i);
    if (corner_ > 0) {
      const double angle = smallest_angle(s[0], s[1], s[2]);
      if (angle < corner_ && angle < smallest_angle(b[0], b[1], b[2])) return true;
    }
    if (turns_freely_) return false;
    const Vec3 old = cross(b[1] - b[0], b[2] - b[0]);
    return dot(old, area) < turn_ * std::sqrt(dot(old, old) * dot(area, area)) * (1 - 1e-12);
  }

 private:
  static constexpr double kDegree = M_PI / 180;
  Corners3 at(const std::vector<Vec3>& p, std::int32_t t) const {
    const auto& v = mesh_.triangles[t].v;
    return Corners3{p[v[0]], p[v[1]], p[v[2]]};
  }

  const ComplexMesh& mesh_;
  const std::vector<float>& clearance_;
  const std::vector<Vec3>&before_, &points_;
  double sheet_, corner_, turn_;  // cosine; radians; cosine
  bool turns_freely_;
};

}  // namespace

std::vector<std::int32_t> find_offenders(const ComplexMesh& mesh, const TriangleGrid& grid,
                                         const std::vector<float>& clearance, const std::vector<Vec3>& before,
                                         const std::vector<Vec3>& points, const std::vector<std::int32_t>& suspects,
                                         const MoveLimits& limits, int threads) {
  const MoveTest moves(mesh, clearance, before, points, limits);
  std::vector<char> is_suspect(mesh.triangles.size(), 0);
  for (std::int32_t t : suspects) is_suspect[t] = 1;
  // Where most are suspects, the buckets are gone through for pairs; else each suspect asks for its own.
  const bool by_bucket = 3 * suspects.size() > mesh.triangles.size();
  constexpr std::size_t kRun = 1024;
  const std::size_t asked = (suspects.size() + kRun - 1) / kRun,
                    swept = by_bucket ? (grid.bucket_count() + kRun - 1) / kRun : 0;
  std::vector<std::vector<std::int32_t>> found(asked + swept);
  parallel_for(asked + swept, threads, [&](std::size_t run) {
    auto& mine = found[run];
    const auto test = [&](std::int32_t i, std::int32_t j) {
      if (moves.offends(i, j)) {
        mine.push_back(i);
        mine.push_back(j);
      }
    };
    if (run >= asked) {
      std::vector<std::int32_t> buffer;
      const std::size_t first = (run - asked) * kRun;
      grid.pairs(first, std::min(grid.bucket_count(), first + kRun), buffer, [&](std::int32_t i, std::int32_t j) {
        if (is_suspect[i] || is_suspect[j]) test(i, j);
      });
      return;
    }
    for (std::size_t n = run * kRun; n < std::min(suspects.size(), (run + 1) * kRun); ++n) {
      const std::int32_t i = suspects[n];
      if (moves.is_spoiled(i)) mine.push_back(i);
      if (by_bucket) continue;
      grid.query(grid.box(i), [&](std::int32_t j) {
        if (j != i && !(is_suspect[j] && j < i)) test(std::min(i, j), std::max(i, j));
        return true;
      });
    }
  });
  std::vector<std::int32_t> out;
  for (const auto& f : found) out.insert(out.end(), f.begin(), f.end());
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

std::size_t count_contacts(const ComplexMesh& mesh, int threads) {
  double sum = 0;
  std::vector<std::int32_t> all;
  for (std::int32_t t = 0; t < static_cast<std::int32_t>(mesh.triangles.size()); ++t)
    if (mesh.alive(t)) {
      all.push_back(t);
      sum += norm(mesh.points[mesh.triangles[t].v[0]] - mesh.points[mesh.triangles[t].v[1]]);
    }
  if (all.empty()) return 0;
  TriangleGrid grid;
  grid.build(mesh, mesh.points, 1.5 * sum / static_cast<double>(all.size()));
  MoveLimits none;
  none.sheet_angle_deg = 0.01;
  return find_offenders(mesh, grid, clearances(mesh, none), mesh.points, mesh.points, all, none, threads).size();
}

}  // namespace stackmesh
