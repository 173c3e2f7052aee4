#include "meshio/prepared_mesh.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "base/error.h"
#include "base/text.h"

namespace stackmesh {
namespace {

using Pair = std::pair<Label, Label>;

std::string space_name(Space space) {
  return space == Space::lps ? "LPS" : space == Space::ras ? "RAS" : "";
}

/// A stable order by key: `order` lists the items, `begins` the first of each key (and the end).
template <class Key>
struct Grouping {
  std::vector<Key> keys;
  std::vector<std::size_t> order, begins;

  template <class KeyOf>
  Grouping(std::size_t count, const KeyOf& key_of) {
    std::map<Key, std::size_t> groups;
    for (std::size_t i = 0; i < count; ++i)
      if (i == 0 || key_of(i) != key_of(i - 1)) groups.emplace(key_of(i), 0);
    for (auto& [key, group] : groups) {
      group = keys.size();
      keys.push_back(key);
    }
    begins.assign(keys.size() + 1, 0);
    std::vector<std::size_t> group_of(count);
    for (std::size_t i = 0; i < count; ++i) {
      group_of[i] = i > 0 && key_of(i) == key_of(i - 1) ? group_of[i - 1] : groups.at(key_of(i));
      ++begins[group_of[i] + 1];
    }
    for (std::size_t g = 0; g < keys.size(); ++g) begins[g + 1] += begins[g];
    std::vector<std::size_t> next(begins.begin(), begins.end() - 1);
    order.resize(count);
    for (std::size_t i = 0; i < count; ++i) order[next[group_of[i]]++] = i;
  }
};

/// The names of the labels as the user gave them, made unique; label_<n> and "background" where there is
/// none.
class LabelNames {
 public:
  LabelNames(const std::vector<LabelInfo>& infos, std::set<Label> labels) : names_(127) {
    labels.insert(0);
    for (const Label label : labels) {
      std::string name = label == 0 ? "background" : "label_" + std::to_string(label);
      for (const LabelInfo& info : infos)
        if (info.number == label && label != 0 && !info.name.empty()) name = info.name;
      for (char& c : name)
        if (static_cast<unsigned char>(c) < ' ' || c == '"' || c == '|') c = '_';
      by_label_[label] = names_.add(name);
      if (label == 0) continue;
      infos_.push_back({label, by_label_[label]});
      for (const LabelInfo& info : infos)
        if (info.number == label) infos_.back().colour = info.colour;
    }
  }
  const std::vector<LabelInfo>& infos() const { return infos_; }
  const std::string& operator[](Label label) const { return by_label_.at(label); }

 private:
  UniqueNames names_;
  std::map<Label, std::string> by_label_;
  std::vector<LabelInfo> infos_;
};

/// Turns a triangle so that its normal points out of `below`.
void flip(InterfaceTriangle& t) {
  std::swap(t.v[1], t.v[2]);
  std::swap(t.below, t.above);
}

bool wants_flip(const InterfaceTriangle& t) {
  if (t.below == 0 || t.above == 0) return t.below == 0 && t.above != 0;
  return t.below > t.above;
}

void group_triangles(std::vector<InterfaceTriangle> triangles, const LabelNames& names, PreparedMesh& mesh) {
  mesh.named = names.infos();
  const Grouping<Pair> groups(triangles.size(),
                              [&](std::size_t i) { return Pair(triangles[i].below, triangles[i].above); });
  mesh.triangles.reserve(triangles.size());
  for (const std::size_t i : groups.order) mesh.triangles.push_back(triangles[i]);
  for (std::size_t g = 0; g < groups.keys.size(); ++g) {
    const auto [below, above] = groups.keys[g];
    mesh.pairs.push_back({below, above, groups.begins[g], groups.begins[g + 1], names[below] + "|" + names[above]});
  }
}

template <std::size_t N>
void check(const std::array<std::int32_t, N>& corners, std::size_t points, const std::string& path) {
  for (const std::int32_t v : corners)
    if (v < 0 || static_cast<std::size_t>(v) >= points)
      fail_internal("a mesh to be written names point " + std::to_string(v) + " of " + std::to_string(points), path);
}

/// Takes over the points that are used, in their order, and renumbers the corners.
void take_points(const std::vector<Vec3>& points, const std::string& path, PreparedMesh& mesh) {
  std::vector<std::int32_t> number(points.size(), -1);
  for (const InterfaceTriangle& t : mesh.triangles) {
    check(t.v, points.size(), path);
    for (const std::int32_t v : t.v) number[v] = 0;
  }
  for (const auto& t : mesh.tets) {
    check(t, points.size(), path);
    for (const std::int32_t v : t) number[v] = 0;
  }
  const auto use = [&](const auto& elements) {
    for (const auto& t : elements) {
      check(t, points.size(), path);
      for (const std::int32_t v : t) number[v] = 0;
    }
  };
  use(mesh.tet_mids), use(mesh.wedges), use(mesh.wedge_mids);
  mesh.points.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (number[i] < 0) continue;
    const Vec3 p = points[i];
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
      fail_internal("point " + std::to_string(i) + " of a mesh to be written is not finite", path);
    number[i] = static_cast<std::int32_t>(mesh.points.size());
    mesh.points.push_back(p);
  }
  if (mesh.points.size() == points.size()) return;
  for (InterfaceTriangle& t : mesh.triangles)
    for (std::int32_t& v : t.v) v = number[v];
  for (auto& t : mesh.tets)
    for (std::int32_t& v : t) v = number[v];
  for (auto& t : mesh.tet_mids)
    for (std::int32_t& v : t) v = number[v];
  for (auto& t : mesh.wedges)
    for (std::int32_t& v : t) v = number[v];
  for (auto& t : mesh.wedge_mids)
    for (std::int32_t& v : t) v = number[v];
}

/// The mid-side nodes of the triangles, from the tets that have their edges.
void find_triangle_mids(const std::string& path, PreparedMesh& mesh) {
  std::vector<char> on_triangle(mesh.points.size(), 0);
  for (const InterfaceTriangle& t : mesh.triangles)
    for (const std::int32_t v : t.v) on_triangle[v] = 1;
  struct Edge {
    std::int32_t low, high, mid;
  };
  const auto less = [](const Edge& a, const Edge& b) { return a.low != b.low ? a.low < b.low : a.high < b.high; };
  std::vector<Edge> edges;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t)
    for (int k = 0; k < 6; ++k) {
      const std::int32_t a = mesh.tets[t][kTetEdges[k][0]], b = mesh.tets[t][kTetEdges[k][1]];
      if (on_triangle[a] && on_triangle[b]) edges.push_back({std::min(a, b), std::max(a, b), mesh.tet_mids[t][k]});
    }
  for (std::size_t w = 0; w < mesh.wedges.size(); ++w)
    for (int k = 0; k < 6; ++k) {  // those of its triangles
      const std::int32_t a = mesh.wedges[w][kWedgeEdges[k][0]], b = mesh.wedges[w][kWedgeEdges[k][1]];
      if (on_triangle[a] && on_triangle[b]) edges.push_back({std::min(a, b), std::max(a, b), mesh.wedge_mids[w][k]});
    }
  std::sort(edges.begin(), edges.end(), less);
  mesh.triangle_mids.resize(mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      const std::int32_t a = mesh.triangles[i].v[k], b = mesh.triangles[i].v[(k + 1) % 3];
      const Edge wanted = {std::min(a, b), std::max(a, b), 0};
      const auto at = std::lower_bound(edges.begin(), edges.end(), wanted, less);
      if (at == edges.end() || at->low != wanted.low || at->high != wanted.high)
        fail_internal("an edge of an interface triangle belongs to no tet", path);
      mesh.triangle_mids[i][k] = at->mid;
    }
}

std::set<Label> labels_of(const std::vector<InterfaceTriangle>& triangles) {
  std::set<Label> labels;
  for (const InterfaceTriangle& t : triangles) {
    labels.insert(t.below);
    labels.insert(t.above);
  }
  return labels;
}

PreparedMesh prepare_triangles(std::vector<InterfaceTriangle> triangles, const InterfaceComplex& surface,
                               const MeshWriteOptions& options, const std::string& path) {
  if (triangles.empty())
    throw Error(ErrorKind::no_result, "the surface is empty", path, "check the labels that were requested");
  PreparedMesh mesh;
  mesh.space = space_name(surface.space);
  const LabelNames names(options.labels, labels_of(triangles));
  group_triangles(std::move(triangles), names, mesh);
  take_points(surface.points, path, mesh);
  return mesh;
}

}  // namespace

PreparedMesh prepare_surface(const InterfaceComplex& surface, const MeshWriteOptions& options,
                             const std::string& path) {
  std::vector<InterfaceTriangle> triangles = surface.triangles;
  for (InterfaceTriangle& t : triangles)
    if (wants_flip(t)) flip(t);
  return prepare_triangles(std::move(triangles), surface, options, path);
}

PreparedMesh prepare_label_surface(const InterfaceComplex& surface, Label label, const MeshWriteOptions& options,
                                   const std::string& path) {
  std::vector<InterfaceTriangle> triangles;
  for (InterfaceTriangle t : surface.triangles) {
    if (t.below == t.above || (t.below != label && t.above != label)) continue;
    if (t.above == label) flip(t);
    triangles.push_back(t);
  }
  return prepare_triangles(std::move(triangles), surface, options, path);
}

PreparedMesh prepare_volume(const TetMesh& mesh, const MeshWriteOptions& options, const std::string& path) {
  if (mesh.elements() == 0)
    throw Error(ErrorKind::no_result, "the volume mesh is empty", path, "check the labels that were requested");
  if (mesh.elements() != mesh.labels.size())
    fail_internal("a mesh to be written has " + std::to_string(mesh.elements()) + " elements and " +
                      std::to_string(mesh.labels.size()) + " labels",
                  path);
  PreparedMesh prepared;
  prepared.space = space_name(mesh.space);
  const Grouping<Label> groups(mesh.tets.size(), [&](std::size_t i) { return mesh.labels[i]; });
  const bool some = (!mesh.mid.empty() && mesh.mid.size() != mesh.tets.size()) ||
                    (!mesh.wedge_mid.empty() && mesh.wedge_mid.size() != mesh.wedges.size());
  if (some || (!mesh.tets.empty() && !mesh.wedges.empty() && mesh.mid.empty() != mesh.wedge_mid.empty()))
    fail_internal("a mesh to be written has mid-side nodes for some of its elements only", path);
  prepared.tets.reserve(mesh.tets.size());
  for (const std::size_t i : groups.order) prepared.tets.push_back(mesh.tets[i]);
  if (!mesh.mid.empty())
    for (const std::size_t i : groups.order) prepared.tet_mids.push_back(mesh.mid[i]);
  std::vector<InterfaceTriangle> triangles = mesh.faces;
  for (InterfaceTriangle& t : triangles)
    if (wants_flip(t)) flip(t);
  const Grouping<Label> wedge_groups(mesh.wedges.size(),
                                     [&](std::size_t i) { return mesh.labels[mesh.tets.size() + i]; });
  for (const std::size_t i : wedge_groups.order) prepared.wedges.push_back(mesh.wedges[i]);
  if (!mesh.wedge_mid.empty())
    for (const std::size_t i : wedge_groups.order) prepared.wedge_mids.push_back(mesh.wedge_mid[i]);
  std::set<Label> labels = labels_of(triangles);
  labels.insert(groups.keys.begin(), groups.keys.end());
  labels.insert(wedge_groups.keys.begin(), wedge_groups.keys.end());
  const LabelNames names(options.labels, labels);
  std::set<Label> filled(groups.keys.begin(), groups.keys.end());
  filled.insert(wedge_groups.keys.begin(), wedge_groups.keys.end());
  for (const Label label : filled) {
    LabelGroup group;
    group.label = label;
    group.name = names[label];
    const auto range = [&](const Grouping<Label>& of, std::size_t& begin, std::size_t& end) {
      const auto at = std::lower_bound(of.keys.begin(), of.keys.end(), label);
      const auto g = static_cast<std::size_t>(at - of.keys.begin());
      begin = of.begins[g];
      end = at != of.keys.end() && *at == label ? of.begins[g + 1] : begin;
    };
    range(groups, group.begin, group.end);
    range(wedge_groups, group.wedge_begin, group.wedge_end);
    prepared.labels.push_back(std::move(group));
  }
  group_triangles(std::move(triangles), names, prepared);
  take_points(mesh.points, path, prepared);
  if (prepared.second_order()) find_triangle_mids(path, prepared);
  return prepared;
}

PreparedMesh prepare_model(const SolverModel& model, const MeshWriteOptions& options, const std::string& path) {
  MeshWriteOptions named = options;
  named.labels = model.labels;
  PreparedMesh prepared = prepare_volume(model.mesh, named, path);
  // The sets count tets and points as the model does.
  if (prepared.points.size() != model.mesh.points.size() || prepared.tets != model.mesh.tets ||
      prepared.wedges != model.mesh.wedges)
    fail_internal("a solver model to be written is not ordered by label, or has unused points", path);
  prepared.sets = model.sets;
  return prepared;
}

std::array<std::int32_t, 6> PreparedMesh::outward_face(TetFace f) const {
  return outward_face_of(f, tets, tet_mids, wedges, wedge_mids);
}

std::string UniqueNames::add(std::string name) {
  if (name.size() > max_length_) name.resize(max_length_);
  std::string unique = name;
  for (int n = 2; !taken_.insert(lower_case(unique)).second; ++n) {
    const std::string tail = "_" + std::to_string(n);
    unique = name.substr(0, std::min(name.size(), max_length_ - tail.size())) + tail;
  }
  return unique;
}

std::string deck_name(const std::string& name) {
  std::string text = name;
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  for (char& c : text)
    if (!letter(c) && !(c >= '0' && c <= '9')) c = '_';
  return text.empty() || !letter(text[0]) ? "L_" + text : text;
}

}  // namespace stackmesh
