#include "validate/defects.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <numeric>
#include <set>
#include <unordered_map>

#include "validate/boundaries.h"
#include "validate/exact.h"
#include "validate/statistics.h"

namespace stackmesh {
namespace {

constexpr std::size_t kMostEntities = 50;

std::string place_of(const Vec3& p) {
  char text[96];
  std::snprintf(text, sizeof text, "at (%.2f, %.2f, %.2f) mm", p.x, p.y, p.z);
  return text;
}

std::string counted(std::size_t n, const char* one, const char* many) {
  return std::to_string(n) + " " + (n == 1 ? one : many);
}

std::string measured(const char* format, double value) {
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

/// Middle and extent of some points.
struct Extent {
  Vec3 low = {1e300, 1e300, 1e300}, high = {-1e300, -1e300, -1e300};
  void add(const Vec3& p) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  Vec3 middle() const { return 0.5 * (low + high); }
  double size() const { return std::max({high.x - low.x, high.y - low.y, high.z - low.z}); }
};

class DefectFinder {
 public:
  DefectFinder(const InterfaceComplex& complex, const SurfaceCheck& surface, const TetMesh* mesh,
               const VolumeCheck* volume, const std::vector<LabelFidelity>* fidelity, const DefectOptions& options)
      : complex_(complex), surface_(surface), mesh_(mesh), volume_(volume), fidelity_(fidelity), o_(options) {}

  std::vector<Defect> run() {
    open_edges();
    crossings();
    if (mesh_ && volume_) inverted_tets(), nonconforming_faces();
    if (fidelity_) parts(), swapped_labels();
    poor_triangles();
    if (mesh_) poor_tets();
    return std::move(all_);
  }

 private:
  /// Keeps the largest of one kind.
  void keep(std::vector<Defect>& found, std::size_t total) {
    std::stable_sort(found.begin(), found.end(), [](const Defect& a, const Defect& b) {
      return a.count != b.count ? a.count > b.count : a.size_mm > b.size_mm;
    });
    cut(found, total);
  }
  void cut(std::vector<Defect>& found, std::size_t total) {
    if (found.size() > o_.most_of_a_kind) found.resize(o_.most_of_a_kind);
    for (Defect& d : found) {
      if (d.entities.size() > kMostEntities) d.entities.resize(kMostEntities);
      if (o_.section_of && !d.section) d.section = o_.section_of(d.where);
    }
    if (!found.empty() && total > found.size())
      found.back().text += " (" + std::to_string(total - found.size()) + " more of this kind)";
    all_.insert(all_.end(), found.begin(), found.end());
  }

  using Edge = std::array<std::int32_t, 2>;  // its points, ascending
  using TrianglesAt = std::map<Edge, std::vector<std::int32_t>>;

  /// Open edges, joined over their ends; those around a triangle that faces against its neighbours are told as that.
  void open_edges() {
    const auto& edges = surface_.open_edge_list;
    if (edges.empty()) return;
    TrianglesAt triangles_at;
    for (const auto& e : edges) triangles_at[e];
    for (std::size_t t = 0; t < complex_.triangles.size(); ++t)
      for (int k = 0; k < 3; ++k) {
        const std::int32_t a = complex_.triangles[t].v[k], b = complex_.triangles[t].v[(k + 1) % 3];
        const auto it = triangles_at.find({std::min(a, b), std::max(a, b)});
        if (it != triangles_at.end()) it->second.push_back(static_cast<std::int32_t>(t));
      }
    std::set<Edge> told;
    std::vector<Defect> turned = turned_triangles(triangles_at, told);
    keep(turned, turned.size());
    std::vector<Defect> holes;
    for (const auto& [root, loop] : loops_of(edges, told)) holes.push_back(hole(loop, triangles_at));
    const std::size_t total = holes.size();
    keep(holes, total);
  }

  /// Triangles whose three edges are all open, and each is met by another triangle. Their edges are `told`.
  std::vector<Defect> turned_triangles(const TrianglesAt& triangles_at, std::set<Edge>& told) const {
    std::map<std::int32_t, int> met;
    for (const auto& [edge, triangles] : triangles_at)
      if (triangles.size() == 2)
        for (const std::int32_t t : triangles) ++met[t];
    std::vector<Defect> turned;
    for (const auto& [t, count] : met) {
      if (count != 3) continue;
      const InterfaceTriangle& triangle = complex_.triangles[t];
      Defect d;
      d.kind = "flipped_triangle";
      d.label = triangle.below != 0 ? triangle.below : triangle.above;
      Extent e;
      for (const std::int32_t v : triangle.v) e.add(complex_.points[v]);
      d.where = (1.0 / 3) *
                (complex_.points[triangle.v[0]] + complex_.points[triangle.v[1]] + complex_.points[triangle.v[2]]);
      d.size_mm = e.size();
      d.entity_kind = "triangles";
      d.entities = {t};
      d.text = "triangle " + std::to_string(t) + " faces against its neighbours " + place_of(d.where);
      for (int k = 0; k < 3; ++k) {
        const std::int32_t a = triangle.v[k], b = triangle.v[(k + 1) % 3];
        told.insert({std::min(a, b), std::max(a, b)});
      }
      turned.push_back(std::move(d));
    }
    return turned;
  }

  /// The edges that are not told yet, joined over their ends.
  static std::map<std::int32_t, std::vector<Edge>> loops_of(const std::vector<Edge>& edges,
                                                            const std::set<Edge>& told) {
    std::unordered_map<std::int32_t, std::int32_t> number;
    std::vector<std::int32_t> points;
    for (const auto& e : edges)
      for (const std::int32_t p : e)
        if (number.emplace(p, static_cast<std::int32_t>(points.size())).second) points.push_back(p);
    DisjointSets loops(points.size());
    for (const auto& e : edges)
      if (!told.count(e)) loops.join(number[e[0]], number[e[1]]);
    std::map<std::int32_t, std::vector<Edge>> by_loop;
    for (const auto& e : edges)
      if (!told.count(e)) by_loop[loops.find(number[e[0]])].push_back(e);
    return by_loop;
  }

  Defect hole(const std::vector<Edge>& loop, const TrianglesAt& triangles_at) const {
    Defect d;
    Extent extent;
    std::map<std::int32_t, int> degree;
    bool single = true;
    for (const auto& e : loop) {
      for (const std::int32_t p : e) extent.add(complex_.points[p]), ++degree[p];
      single = single && triangles_at.at(e).size() == 1;
    }
    const bool ring = single && std::all_of(degree.begin(), degree.end(), [](const auto& p) { return p.second == 2; });
    const InterfaceTriangle* beside =
        triangles_at.at(loop[0]).empty() ? nullptr : &complex_.triangles[triangles_at.at(loop[0])[0]];
    if (beside) d.label = beside->below != 0 ? beside->below : beside->above;
    d.kind = ring ? "hole" : "open_edge";
    for (const auto& p : degree)
      d.where = d.where + (1.0 / static_cast<double>(degree.size())) * complex_.points[p.first];
    d.size_mm = extent.size();
    d.count = loop.size();
    d.entity_kind = "points";
    for (const auto& p : degree) d.entities.push_back(p.first);
    d.text = (ring ? "a hole of " + counted(loop.size(), "edge", "edges")
                   : counted(loop.size(), "edge", "edges") + " where the surface does not close") +
             measured(", %.2f mm wide, ", d.size_mm) + place_of(d.where);
    return d;
  }

  /// Pairs that share a triangle or whose triangles share a point are one place.
  void crossings() {
    std::vector<Defect> places, flat;
    std::vector<std::array<std::int32_t, 2>> pairs;
    for (const auto& pair : surface_.intersecting_pairs) {
      if (pair[0] != pair[1]) {
        pairs.push_back(pair);
        continue;
      }
      Defect d = of_triangles("degenerate_triangle", {pair[0]});
      d.text = "triangle " + std::to_string(pair[0]) + " has no area " + place_of(d.where);
      flat.push_back(std::move(d));
    }
    std::unordered_map<std::int32_t, std::int32_t> first_pair_at;
    DisjointSets sets(pairs.size());
    for (std::size_t i = 0; i < pairs.size(); ++i)
      for (const std::int32_t t : pairs[i])
        for (const std::int32_t v : complex_.triangles[t].v) {
          const auto [it, is_new] = first_pair_at.emplace(v, static_cast<std::int32_t>(i));
          if (!is_new) sets.join(it->second, static_cast<std::int32_t>(i));
        }
    std::map<std::int32_t, std::vector<std::int32_t>> by_set;
    std::map<std::int32_t, std::size_t> count;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const std::int32_t root = sets.find(static_cast<std::int32_t>(i));
      by_set[root].insert(by_set[root].end(), pairs[i].begin(), pairs[i].end());
      ++count[root];
    }
    for (auto& [root, triangles] : by_set) {
      std::vector<std::int64_t> ids(triangles.begin(), triangles.end());  // pairs, one after the other
      Defect d = of_triangles("self_intersection", ids);
      d.count = count[root];
      d.text = d.count == 1 ? "triangles " + std::to_string(ids[0]) + " and " + std::to_string(ids[1]) + " cross " +
                                  place_of(d.where)
                            : std::to_string(d.count) + " pairs of triangles cross" +
                                  measured(" over %.2f mm ", d.size_mm) + place_of(d.where);
      places.push_back(std::move(d));
    }
    const std::size_t total = places.size(), total_flat = flat.size();
    keep(places, total);
    keep(flat, total_flat);
  }

  Defect of_triangles(const char* kind, std::vector<std::int64_t> triangles) const {
    Defect d;
    d.kind = kind;
    d.entity_kind = "triangles";
    Extent e;
    for (const std::int64_t t : triangles) {
      const InterfaceTriangle& triangle = complex_.triangles[t];
      for (const std::int32_t v : triangle.v) e.add(complex_.points[v]);
      if (d.label == 0) d.label = triangle.below != 0 ? triangle.below : triangle.above;
    }
    d.where = e.middle();
    d.size_mm = e.size();
    d.entities = std::move(triangles);
    return d;
  }

  Defect of_tet(const char* kind, std::size_t t) const {
    Defect d;
    d.kind = kind;
    d.entity_kind = "tets";
    d.entities = {static_cast<std::int64_t>(t)};
    d.label = mesh_->labels[t];
    Extent e;
    Vec3 sum;
    each_corner(*mesh_, t, [&](std::int32_t v) { e.add(mesh_->points[v]), sum = sum + mesh_->points[v]; });
    d.where = (mesh_->is_wedge(t) ? 1.0 / 6 : 0.25) * sum;
    d.size_mm = e.size();
    return d;
  }

  void inverted_tets() {
    if (volume_->inverted == 0) return;
    std::vector<Defect> found;
    for (const std::int32_t t : volume_->inverted_list) {
      if (mesh_->is_wedge(static_cast<std::size_t>(t))) {
        Defect d = of_tet("inverted_tet", static_cast<std::size_t>(t));
        d.text = "wedge " + std::to_string(t - static_cast<std::int64_t>(mesh_->tets.size())) + " is inverted " +
                 place_of(d.where);
        found.push_back(std::move(d));
        continue;
      }
      const auto& v = mesh_->tets[t];
      const auto& p = mesh_->points;
      const int sign = exact_orientation(p[v[0]], p[v[1]], p[v[2]], p[v[3]]);
      Defect d = of_tet("inverted_tet", static_cast<std::size_t>(t));
      d.text = "tet " + std::to_string(t) +
               (sign == 0  ? " is flat "
                : sign < 0 ? " is inverted "
                           : " is turned inside out by its mid-side nodes ") +
               place_of(d.where);
      found.push_back(std::move(d));
    }
    keep(found, volume_->inverted);
  }

  void nonconforming_faces() {
    std::vector<Defect> found;
    for (const auto& face : volume_->nonconforming_list) {
      Defect d;
      d.kind = "nonconforming_face";
      d.entity_kind = "points";
      Extent e;
      for (const std::int32_t v : face) e.add(mesh_->points[v]), d.entities.push_back(v);
      d.where = e.middle();
      d.size_mm = e.size();
      d.text = "a face that neighbouring tetrahedra or the surface do not share as they should " + place_of(d.where);
      found.push_back(std::move(d));
    }
    keep(found, volume_->nonconforming_faces);
  }

  void parts() {
    std::vector<Defect> missing, extra;
    std::size_t all_missing = 0;
    for (const LabelFidelity& f : *fidelity_) {
      all_missing += f.missing_components;
      for (const UnmatchedPart& part : f.missing) {
        Defect d;
        d.kind = "missing_component";
        d.label = f.label;
        d.where = part.where, d.size_mm = part.size_mm, d.section = part.section;
        d.count = part.voxels;
        d.entity_kind = "voxels";
        d.text = "a component of label " + std::to_string(f.label) + " with " +
                 counted(part.voxels, "voxel", "voxels") + measured(" (%.1f mm3) is missing ", part.volume_mm3) +
                 place_of(part.where);
        missing.push_back(std::move(d));
      }
      for (const UnmatchedPart& part : f.unmatched) {
        Defect d;
        d.kind = "unmatched_piece";
        d.label = f.label;
        d.where = part.where, d.size_mm = part.size_mm, d.section = part.section;
        d.text = "a piece of label " + std::to_string(f.label) +
                 measured(" (%.2f mm3) that no voxel centre of the label lies in ", part.volume_mm3) +
                 place_of(part.where);
        extra.push_back(std::move(d));
      }
    }
    keep(missing, all_missing);
    const std::size_t total = extra.size();
    keep(extra, total);
  }

  void swapped_labels() {
    std::vector<Defect> found;
    for (const LabelFidelity& f : *fidelity_) {
      const double own = std::isnan(f.dice) ? 0 : f.dice;
      if (f.mesh_voxels == 0 || f.best_match == f.label || f.best_dice < 0.5 || f.best_dice < 2 * own) continue;
      Defect d;
      d.kind = "swapped_label";
      d.label = f.label;
      d.where = f.middle;
      d.count = f.mesh_voxels;
      d.entity_kind = "voxels";
      d.text = "label " + std::to_string(f.label) + " of the mesh lies where label " + std::to_string(f.best_match) +
               " of the slices is" + measured(" (Dice %.3f", f.best_dice) + measured("; with its own %.3f) ", own) +
               place_of(f.middle);
      found.push_back(std::move(d));
    }
    const std::size_t total = found.size();
    keep(found, total);
  }

  /// The worst of `values` below a limit, worst first.
  template <class Value>
  std::vector<std::pair<double, std::size_t>> worst(std::size_t count, double limit, std::size_t& total,
                                                    Value value) const {
    std::vector<std::pair<double, std::size_t>> list;
    total = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const double v = value(i);
      if (v < limit) list.push_back({v, i});
    }
    total = list.size();
    const std::size_t most = std::min(list.size(), std::min<std::size_t>(20, o_.most_of_a_kind));
    std::partial_sort(list.begin(), list.begin() + static_cast<std::ptrdiff_t>(most), list.end());
    list.resize(most);
    return list;
  }

  void poor_triangles() {
    if (surface_.triangles == 0 || surface_.angle_min_deg >= o_.poor_angle_deg) return;
    std::size_t total = 0;
    std::vector<Defect> found;
    const auto list = worst(complex_.triangles.size(), o_.poor_angle_deg, total, [&](std::size_t t) {
      const auto& v = complex_.triangles[t].v;
      return smallest_angle_deg(complex_.points[v[0]], complex_.points[v[1]], complex_.points[v[2]]);
    });
    for (const auto& [angle, t] : list) {
      Defect d = of_triangles("poor_triangle", {static_cast<std::int64_t>(t)});
      d.text = "triangle " + std::to_string(t) + measured(" has an angle of %.2f degrees ", angle) + place_of(d.where);
      found.push_back(std::move(d));
    }
    cut(found, total);
  }

  void poor_tets() {
    if (!volume_ || volume_->tets == 0 || volume_->dihedral_min_deg >= o_.poor_dihedral_deg) return;
    std::size_t total = 0;
    std::vector<Defect> found;
    const auto list = worst(mesh_->tets.size(), o_.poor_dihedral_deg, total,
                            [&](std::size_t t) { return smallest_dihedral_deg(*mesh_, t); });
    for (const auto& [angle, t] : list) {
      Defect d = of_tet("poor_tet", t);
      d.text =
          "tet " + std::to_string(t) + measured(" has a dihedral angle of %.2f degrees ", angle) + place_of(d.where);
      found.push_back(std::move(d));
    }
    cut(found, total);
  }

  static double smallest_dihedral_deg(const TetMesh& mesh, std::size_t t) {
    const auto& v = mesh.tets[t];
    const Vec3 a = mesh.points[v[0]], b = mesh.points[v[1]], c = mesh.points[v[2]], d = mesh.points[v[3]];
    Vec3 n[4] = {cross(c - b, d - b), cross(d - a, c - a), cross(b - a, d - a), cross(c - a, b - a)};
    for (Vec3& m : n) {
      const double length = norm(m);
      if (length == 0) return 0;
      m = (1 / length) * m;
    }
    double largest = -1;
    for (int i = 0; i < 4; ++i)
      for (int j = i + 1; j < 4; ++j) largest = std::max(largest, -dot(n[i], n[j]));
    return kDegrees * std::acos(std::clamp(largest, -1.0, 1.0));
  }

  const InterfaceComplex& complex_;
  const SurfaceCheck& surface_;
  const TetMesh* mesh_;
  const VolumeCheck* volume_;
  const std::vector<LabelFidelity>* fidelity_;
  const DefectOptions& o_;
  std::vector<Defect> all_;
};

}  // namespace

std::vector<Defect> find_defects(const InterfaceComplex& complex, const SurfaceCheck& surface, const TetMesh* mesh,
                                 const VolumeCheck* volume, const std::vector<LabelFidelity>* fidelity,
                                 const DefectOptions& options) {
  return DefectFinder(complex, surface, mesh, volume, fidelity, options).run();
}

InterfaceComplex defect_triangles(const InterfaceComplex& complex, const TetMesh* mesh,
                                  const std::vector<Defect>& defects) {
  InterfaceComplex out;
  out.space = complex.space;
  std::unordered_map<std::int64_t, std::int32_t> number;
  const auto add = [&](const std::vector<Vec3>& points, std::array<std::int32_t, 3> v, std::int64_t offset,
                       Label label) {
    InterfaceTriangle t;
    for (int k = 0; k < 3; ++k) {
      const auto [it, is_new] = number.emplace(offset + v[k], static_cast<std::int32_t>(out.points.size()));
      if (is_new) out.points.push_back(points[v[k]]);
      t.v[k] = it->second;
    }
    t.below = label;
    out.triangles.push_back(t);
  };
  // Points: the triangles at them. Voxels: nothing to draw.
  std::unordered_map<std::int32_t, Label> at_point;
  for (std::size_t i = 0; i < defects.size(); ++i) {
    const Defect& d = defects[i];
    const Label label = static_cast<Label>(i + 1);
    for (const std::int64_t e : d.entities) {
      if (d.entity_kind == "triangles") add(complex.points, complex.triangles[e].v, 0, label);
      if (d.entity_kind == "points" && d.kind != "nonconforming_face")
        at_point.emplace(static_cast<std::int32_t>(e), label);
      if (d.entity_kind == "tets" && mesh && mesh->is_wedge(static_cast<std::size_t>(e))) {
        const std::int64_t offset =
            mesh->points.data() == complex.points.data() ? 0 : static_cast<std::int64_t>(complex.points.size());
        const auto& w = mesh->wedges[static_cast<std::size_t>(e) - mesh->tets.size()];
        add(mesh->points, {w[0], w[2], w[1]}, offset, label);
        add(mesh->points, {w[3], w[4], w[5]}, offset, label);
      } else if (d.entity_kind == "tets" && mesh) {
        const auto& v = mesh->tets[e];
        const std::int64_t offset =
            mesh->points.data() == complex.points.data() ? 0 : static_cast<std::int64_t>(complex.points.size());
        for (const auto& f : {std::array<int, 3>{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}})
          add(mesh->points, {v[f[0]], v[f[1]], v[f[2]]}, offset, label);
      }
    }
    if (d.kind == "nonconforming_face" && mesh && d.entities.size() == 3)
      add(mesh->points,
          {static_cast<std::int32_t>(d.entities[0]), static_cast<std::int32_t>(d.entities[1]),
           static_cast<std::int32_t>(d.entities[2])},
          static_cast<std::int64_t>(complex.points.size()), label);
  }
  if (!at_point.empty())
    for (const InterfaceTriangle& t : complex.triangles)
      for (const std::int32_t v : t.v)
        if (const auto it = at_point.find(v); it != at_point.end()) {
          add(complex.points, t.v, 0, it->second);
          break;
        }
  return out;
}

}  // namespace stackmesh
