#include "volume/label_tets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "base/parallel.h"

namespace stackmesh::volume {
namespace {

using Triple = std::array<std::int32_t, 3>;

Triple sorted(Triple t) {
  if (t[0] > t[1]) std::swap(t[0], t[1]);
  if (t[1] > t[2]) std::swap(t[1], t[2]);
  if (t[0] > t[1]) std::swap(t[0], t[1]);
  return t;
}

/// Triangles by their corners, in any order; open addressing.
class TriangleTable {
 public:
  explicit TriangleTable(const std::vector<InterfaceTriangle>& triangles) : triangles_(triangles) {
    while (slots_.size() < 2 * triangles.size() + 1) slots_.resize(2 * slots_.size());
    std::fill(slots_.begin(), slots_.end(), -1);
  }

  /// Adds triangle i; false (and not added) when one with these corners is there.
  bool insert(std::int32_t i) {
    const std::size_t at = slot(triangles_[i].v);
    if (slots_[at] >= 0) return false;
    slots_[at] = i;
    return true;
  }

  std::int32_t find(const Triple& corners) const { return slots_[slot(corners)]; }

 private:
  std::size_t slot(const Triple& corners) const {
    const Triple key = sorted(corners);
    std::uint64_t h = 0;
    for (const std::int32_t v : key) {
      h = (h ^ static_cast<std::uint32_t>(v)) * 0x9e3779b97f4a7c15u;
      h ^= h >> 29;
    }
    const std::size_t mask = slots_.size() - 1;
    std::size_t at = h & mask;
    while (slots_[at] >= 0 && sorted(triangles_[slots_[at]].v) != key) at = (at + 1) & mask;
    return at;
  }

  const std::vector<InterfaceTriangle>& triangles_;
  std::vector<std::int32_t> slots_ = std::vector<std::int32_t>(16);
};

// Face i, opposite corner i, seen with that corner on the side of its normal.
constexpr int kFace[4][3] = {{1, 3, 2}, {0, 2, 3}, {0, 3, 1}, {0, 1, 2}};

bool same_turn(const Triple& a, const Triple& b) {
  return (a[0] == b[0] && a[1] == b[1]) || (a[0] == b[1] && a[1] == b[2]) || (a[0] == b[2] && a[1] == b[0]);
}

constexpr Label kUnknown = INT32_MIN;

std::string count_of(std::size_t n, const char* one, const char* many) {
  return std::to_string(n) + " " + (n == 1 ? one : many);
}

/// One run of labelling.
class Flood {
 public:
  Flood(const RawTets& raw, const TetMesh& mesh)
      : raw_(raw), faces_(mesh.faces), count_(raw.corners.size() / 4), labels_(count_, kUnknown), walls_(count_, 0) {}

  Finding run() {
    seed();
    if (finding_.message.empty()) spread();
    if (finding_.message.empty()) check_sides();
    finding_.of_input = fits_ && std::find(sides_.begin(), sides_.end(), 0) == sides_.end();
    return std::move(finding_);
  }
  const std::vector<Label>& labels() const { return labels_; }

 private:
  Triple face(std::size_t t, int i) const {
    const std::int32_t* c = raw_.corners.data() + 4 * t;
    return {c[kFace[i][0]], c[kFace[i][1]], c[kFace[i][2]]};
  }

  void seed() {
    TriangleTable table(faces_);
    std::int32_t top = -1;
    for (std::size_t i = 0; i < faces_.size(); ++i) {
      table.insert(static_cast<std::int32_t>(i));
      for (const std::int32_t v : faces_[i].v) top = std::max(top, v);
    }
    sides_.assign(faces_.size(), 0);
    for (std::size_t t = 0; t < count_; ++t) {
      for (int i = 0; i < 4; ++i) {
        const Triple f = face(t, i);
        if (f[0] > top || f[1] > top || f[2] > top) continue;
        const std::int32_t at = table.find(f);
        if (at < 0) continue;
        walls_[t] = static_cast<std::uint8_t>(walls_[t] | (1 << i));
        const InterfaceTriangle& wall = faces_[at];
        const bool above = same_turn(f, wall.v);
        sides_[at] = static_cast<std::uint8_t>(sides_[at] | (above ? 2 : 1));
        give(t, above ? wall.above : wall.below, at);
      }
    }
  }

  void give(std::size_t t, Label label, std::int32_t wall) {
    if (labels_[t] == kUnknown) {
      labels_[t] = label;
      queue_.push_back(static_cast<std::int32_t>(t));
    } else if (labels_[t] != label && finding_.message.empty()) {
      finding_.message = "a region is labelled both " + std::to_string(labels_[t]) + " and " + std::to_string(label);
      if (wall >= 0) finding_.triangles.push_back(wall);
    }
  }

  void spread() {
    for (std::size_t at = 0; at < queue_.size(); ++at) {
      const auto t = static_cast<std::size_t>(queue_[at]);
      for (int i = 0; i < 4; ++i) {
        const std::int32_t next = raw_.neighbours[4 * t + static_cast<std::size_t>(i)];
        if (walls_[t] & (1 << i)) continue;
        if (next < 0) {
          if (labels_[t] != 0) {
            finding_.message = "label " + std::to_string(labels_[t]) + " reaches the outside where it has no surface";
            return;
          }
          continue;
        }
        if (!shares(static_cast<std::size_t>(next), face(t, i))) {
          finding_.message = "TetGen's tetrahedra do not fit together";
          fits_ = false;
          return;
        }
        give(static_cast<std::size_t>(next), labels_[t], -1);
        if (!finding_.message.empty()) return;
      }
    }
    if (queue_.size() != count_) finding_.message = "a region is not bounded by any surface triangle";
  }

  bool shares(std::size_t t, const Triple& f) const {
    if (t >= count_) return false;
    const std::int32_t* c = raw_.corners.data() + 4 * t;
    return std::all_of(f.begin(), f.end(), [&](std::int32_t v) { return std::find(c, c + 4, v) != c + 4; });
  }

  void check_sides() {
    for (std::size_t i = 0; i < faces_.size(); ++i) {
      const bool below = sides_[i] & 1, above = sides_[i] & 2;
      if ((!below && !above) || (!below && faces_[i].below != 0) || (!above && faces_[i].above != 0))
        finding_.triangles.push_back(static_cast<std::int32_t>(i));
    }
    if (!finding_.triangles.empty())
      finding_.message = count_of(finding_.triangles.size(), "surface triangle was", "surface triangles were") +
                         " not kept as faces of the tetrahedra";
  }

  const RawTets& raw_;
  const std::vector<InterfaceTriangle>& faces_;
  std::size_t count_;
  std::vector<Label> labels_;
  std::vector<std::uint8_t> walls_,
      sides_;  // bits: tet faces that lie on a triangle; triangle sides that were met
  std::vector<std::int32_t> queue_;
  Finding finding_;
  bool fits_ = true;
};

void add(Volume& volume, double term) {
  volume.mm3 += term;
  volume.terms += std::abs(term);
}

constexpr std::size_t kChunk = 1 << 13;  // tets, or points, that one thread takes at once

std::size_t chunks(std::size_t n) {
  return (n + kChunk - 1) / kChunk;
}

std::size_t count_inverted(const TetMesh& mesh, int threads) {
  std::vector<std::size_t> flat(chunks(mesh.tets.size()), 0);
  parallel_for(flat.size(), threads, [&](std::size_t i) {
    for (std::size_t t = i * kChunk; t < std::min(mesh.tets.size(), (i + 1) * kChunk); ++t) {
      const auto& v = mesh.tets[t];
      flat[i] += orientation(mesh.points[v[0]], mesh.points[v[1]], mesh.points[v[2]], mesh.points[v[3]]) <= 0;
    }
  });
  return std::accumulate(flat.begin(), flat.end(), std::size_t{0});
}

/// A face of a tet, or one side of a triangle of the surface, without its smallest corner.
struct HalfFace {
  std::int32_t middle, high, triangle;  // its other corners, ascending; its triangle, -1: a tet's face
  Label label;
  bool even;  // the label lies on the side to which the ascending corners turn their normal
};

std::pair<std::int32_t, HalfFace> half_face(Triple v, Label label, std::int32_t triangle) {
  bool even = true;
  const auto order = [&](int i, int j) {
    if (v[i] > v[j]) std::swap(v[i], v[j]), even = !even;
  };
  order(0, 1), order(1, 2), order(0, 1);
  return {v[0], {v[1], v[2], triangle, label, even}};
}

/// Half faces by their smallest corner: those of point p are begin[p] .. begin[p + 1] - 1.
struct HalfFaces {
  std::vector<HalfFace> all;
  std::vector<std::int64_t> begin;
};

HalfFaces half_faces_of(const TetMesh& mesh) {
  HalfFaces out;
  out.begin.assign(mesh.points.size() + 1, 0);
  for (const auto& t : mesh.tets)  // how often each corner is the smallest of a tet's faces
    for (const auto& f : kFace) ++out.begin[std::min({t[f[0]], t[f[1]], t[f[2]]}) + 1];
  for (const InterfaceTriangle& f : mesh.faces) out.begin[std::min({f.v[0], f.v[1], f.v[2]}) + 1] += 2;
  for (std::size_t p = 0; p < mesh.points.size(); ++p) out.begin[p + 1] += out.begin[p];
  out.all.resize(out.begin.back());
  std::vector<std::int64_t> next(out.begin.begin(), out.begin.end() - 1);
  const auto add = [&](const std::pair<std::int32_t, HalfFace>& h) { out.all[next[h.first]++] = h.second; };
  for (std::size_t t = 0; t < mesh.tets.size(); ++t)
    for (const auto& f : kFace)
      add(half_face({mesh.tets[t][f[0]], mesh.tets[t][f[1]], mesh.tets[t][f[2]]}, mesh.labels[t], -1));
  for (std::size_t i = 0; i < mesh.faces.size(); ++i) {
    const InterfaceTriangle& f = mesh.faces[i];
    add(half_face(f.v, f.above, static_cast<std::int32_t>(i)));
    add(half_face({f.v[0], f.v[2], f.v[1]}, f.below, static_cast<std::int32_t>(i)));
  }
  return out;
}

/// Whether half faces on the same corners fit: two tets of one label, or a triangle's two sides and the tets on them.
/// @param wall the triangle, -1: none
bool fit_together(std::vector<HalfFace>::const_iterator from, std::vector<HalfFace>::const_iterator to,
                  std::int32_t& wall) {
  int tets[2] = {0, 0}, walls = 0;
  Label of_tet[2] = {0, 0}, of_wall[2] = {0, 0};
  wall = -1;
  for (auto j = from; j != to; ++j) {
    if (j->triangle < 0) {
      ++tets[j->even], of_tet[j->even] = j->label;
    } else {
      ++walls, of_wall[j->even] = j->label, wall = j->triangle;
    }
  }
  return tets[0] <= 1 && tets[1] <= 1 &&
         (walls == 0 ? tets[0] == 1 && tets[1] == 1 && of_tet[0] == of_tet[1]
                     : walls == 2 && of_tet[0] == of_wall[0] && of_tet[1] == of_wall[1]);
}

}  // namespace

Finding check_closed(const InterfaceComplex& complex) {
  Finding finding;
  TriangleTable table(complex.triangles);
  for (std::size_t i = 0; i < complex.triangles.size(); ++i) {
    const Triple& v = complex.triangles[i].v;
    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) {
      finding.triangles.push_back(static_cast<std::int32_t>(i));
    } else if (!table.insert(static_cast<std::int32_t>(i))) {
      finding.triangles.push_back(table.find(v));
      finding.triangles.push_back(static_cast<std::int32_t>(i));
    }
  }
  if (!finding.triangles.empty()) {
    finding.message = "the surface has triangles that are degenerate or repeated";
  } else {
    struct Edge {
      std::uint64_t key;
      std::int32_t triangle;
      bool forward;
    };
    std::vector<Edge> edges;
    edges.reserve(3 * complex.triangles.size());
    for (std::size_t i = 0; i < complex.triangles.size(); ++i) {
      for (int k = 0; k < 3; ++k) {
        const auto a = static_cast<std::uint64_t>(complex.triangles[i].v[k]);
        const auto b = static_cast<std::uint64_t>(complex.triangles[i].v[(k + 1) % 3]);
        edges.push_back({std::min(a, b) << 32 | std::max(a, b), static_cast<std::int32_t>(i), a < b});
      }
    }
    std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) { return a.key < b.key; });
    std::size_t open = 0;
    std::vector<std::pair<Label, int>> around;
    for (std::size_t from = 0, to = 0; from < edges.size(); from = to) {
      around.clear();
      for (; to < edges.size() && edges[to].key == edges[from].key; ++to) {
        const InterfaceTriangle& t = complex.triangles[edges[to].triangle];
        const int sign = edges[to].forward ? 1 : -1;
        around.emplace_back(t.below, sign);
        around.emplace_back(t.above, -sign);
      }
      std::sort(around.begin(), around.end());
      bool closed = true;
      for (std::size_t i = 0, j = 0; i < around.size(); i = j) {
        int sum = 0;
        for (; j < around.size() && around[j].first == around[i].first; ++j) sum += around[j].second;
        closed = closed && sum == 0;
      }
      if (closed) continue;
      ++open;
      for (std::size_t i = from; i < to; ++i) finding.triangles.push_back(edges[i].triangle);
    }
    if (open > 0) finding.message = "the surface is open along " + count_of(open, "edge", "edges");
  }
  std::sort(finding.triangles.begin(), finding.triangles.end());
  finding.triangles.erase(std::unique(finding.triangles.begin(), finding.triangles.end()), finding.triangles.end());
  return finding;
}

Finding label_tets(RawTets raw, TetMesh& mesh) {
  const std::size_t count = raw.corners.size() / 4;
  const auto points = static_cast<std::int32_t>(mesh.points.size());
  std::size_t flat = 0;
  int turned = 0;  // TetGen orients all tets alike: which way, the first one says
  for (std::size_t t = 0; t < count; ++t) {
    std::int32_t* c = raw.corners.data() + 4 * t;
    if (std::any_of(c, c + 4, [&](std::int32_t v) { return v < 0 || v >= points; }))
      return {"TetGen's answer names points that do not exist", {}};
    const int sign = orientation(mesh.points[c[0]], mesh.points[c[1]], mesh.points[c[2]], mesh.points[c[3]]);
    if (turned == 0) turned = sign;
    if (sign == 0 || sign != turned) ++flat;
    if (turned < 0) {
      std::swap(c[0], c[1]);
      std::swap(raw.neighbours[4 * t], raw.neighbours[4 * t + 1]);
    }
  }
  if (flat > 0) return {count_of(flat, "tetrahedron is", "tetrahedra are") + " flat or inverted", {}};

  Flood flood(raw, mesh);
  Finding finding = flood.run();
  if (!finding.message.empty()) return finding;
  mesh.tets.clear();
  mesh.labels.clear();
  for (std::size_t t = 0; t < count; ++t) {
    if (flood.labels()[t] == 0) continue;
    const std::int32_t* c = raw.corners.data() + 4 * t;
    mesh.tets.push_back({c[0], c[1], c[2], c[3]});
    mesh.labels.push_back(flood.labels()[t]);
  }
  return {};
}

Finding check_filled(const TetMesh& mesh, int threads) {
  if (const std::size_t n = count_inverted(mesh, threads); n > 0)
    return {count_of(n, "tetrahedron is", "tetrahedra are") + " flat or inverted", {}};
  HalfFaces halves = half_faces_of(mesh);
  std::vector<Finding> findings(chunks(mesh.points.size()));
  std::vector<std::size_t> loose(findings.size(), 0);
  parallel_for(findings.size(), threads, [&](std::size_t chunk) {
    for (std::size_t p = chunk * kChunk; p < std::min(mesh.points.size(), (chunk + 1) * kChunk); ++p) {
      const auto from = halves.all.begin() + halves.begin[p], to = halves.all.begin() + halves.begin[p + 1];
      std::sort(from, to, [](const HalfFace& a, const HalfFace& b) {
        return a.middle != b.middle ? a.middle < b.middle
               : a.high != b.high   ? a.high < b.high
               : a.even != b.even   ? a.even
                                    : a.triangle < b.triangle;
      });
      for (auto i = from, j = from; i != to; i = j) {
        while (j != to && j->middle == i->middle && j->high == i->high) ++j;
        std::int32_t wall = -1;
        if (fit_together(i, j, wall)) continue;
        if (wall >= 0) findings[chunk].triangles.push_back(wall);
        else ++loose[chunk];
      }
    }
  });
  Finding out;
  for (const Finding& f : findings) out.triangles.insert(out.triangles.end(), f.triangles.begin(), f.triangles.end());
  std::sort(out.triangles.begin(), out.triangles.end());
  if (const std::size_t n = std::accumulate(loose.begin(), loose.end(), std::size_t{0}); n > 0)
    out.message = count_of(n, "face of the tetrahedra fits", "faces of the tetrahedra fit") + " to no other";
  else if (!out.triangles.empty())
    out.message = count_of(out.triangles.size(), "surface triangle was", "surface triangles were") +
                  " not kept as faces of the tetrahedra";
  return out;
}

std::map<Label, Volume> surface_volumes(const InterfaceComplex& complex) {
  std::map<Label, Volume> volumes;
  if (complex.triangles.empty()) return volumes;
  const Vec3 origin = complex.points[complex.triangles.front().v[0]];
  for (const InterfaceTriangle& t : complex.triangles) {
    if (t.below == t.above) continue;
    const Vec3 a = complex.points[t.v[0]] - origin, b = complex.points[t.v[1]] - origin,
               c = complex.points[t.v[2]] - origin;
    const double term = dot(cross(a, b), c) / 6;
    if (t.below != 0) add(volumes[t.below], term);
    if (t.above != 0) add(volumes[t.above], -term);
  }
  return volumes;
}

std::map<Label, Volume> tet_volumes(const TetMesh& mesh) {
  std::map<Label, Volume> volumes;
  for (std::size_t i = 0; i < mesh.tets.size(); ++i) {
    const auto& t = mesh.tets[i];
    const Vec3 a = mesh.points[t[0]];
    add(volumes[mesh.labels[i]], dot(cross(mesh.points[t[1]] - a, mesh.points[t[2]] - a), mesh.points[t[3]] - a) / 6);
  }
  return volumes;
}

}  // namespace stackmesh::volume
