#include "fem/name_sets.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "base/error.h"
#include "base/text.h"
#include "fem/boundary_patches.h"
#include "fem/ordered_mesh.h"
#include "fem/selection.h"
#include "fem/solver_names.h"
#include "fem/split_parts.h"
#include "fem/uncut_mesh.h"

namespace stackmesh {
namespace {

/// A set before its nodes are known: faces, as indices into the list of boundary faces.
struct FaceList {
  std::string name, note;
  std::vector<std::int32_t> faces;
};

class Namer {
 public:
  Namer(const TetMesh& mesh, const std::vector<LabelInfo>& labels, const SetOptions& options) : o_(options) {
    model_.mesh = ordered_mesh(mesh);
    for (int i = 0; i < o_.times_cut; ++i) {
      TetMesh before = uncut_mesh(model_.mesh);
      finer_.push_back(std::move(model_.mesh));
      model_.mesh = std::move(before);
    }
    std::set<Label> present(model_.mesh.labels.begin(), model_.mesh.labels.end());
    std::vector<LabelInfo> infos;
    for (const Label l : present) {
      infos.push_back({l, ""});
      for (const LabelInfo& known : labels)
        if (known.number == l) infos.back() = known;
    }
    faces_ = boundary_faces(model_.mesh);
    const std::set<Label> voids = find_voids(present);
    for (const Label l : voids) {
      infos.push_back({l, ""});
      for (const LabelInfo& known : labels)
        if (known.number == l) infos.back() = known;
    }
    for (const LabelInfo& l : solver_names(std::move(infos)))
      (voids.count(l.number) > 0 ? voids_ : model_.labels).push_back(l);
    for (const LabelInfo& l : model_.labels) taken_.insert(lower_case(l.name));
  }

  SolverModel run() {
    number_parts();
    for (const LabelInfo& l : model_.labels) outer_of(l);
    for (const LabelInfo& l : model_.labels) interfaces_of(l);
    for (const LabelInfo& v : voids_) walls_of(v);
    all_caps();
    image_sides();
    parts();
    selections();
    skins();
    for (; !finer_.empty(); finer_.pop_back()) cut(std::move(finer_.back()));
    finish();
    return std::move(model_);
  }

 private:
  /// Tells the faces on a void of it; the mesh's own faces are spent.
  std::set<Label> find_voids(const std::set<Label>& present) {
    std::map<std::array<std::int32_t, 3>, Label> behind;
    for (const InterfaceTriangle& f : model_.mesh.faces)
      for (const Label l : {f.below, f.above})
        if (l != 0 && present.count(l) == 0) behind[sorted(f.v)] = l;
    model_.mesh.faces.clear();
    std::set<Label> voids;
    if (behind.empty()) return voids;
    for (BoundaryFace& f : faces_)
      if (const auto at = behind.find(sorted(f.v)); f.out == 0 && at != behind.end())
        voids.insert(f.behind = at->second);
    return voids;
  }
  static std::array<std::int32_t, 3> sorted(std::array<std::int32_t, 3> v) {
    std::sort(v.begin(), v.end());
    return v;
  }

  std::string unique(const std::string& name) {
    std::string result = name;
    for (int n = 2; !taken_.insert(lower_case(result)).second; ++n) result = name + "_" + std::to_string(n);
    return result;
  }
  const std::string& name_of(Label label) const {
    for (const LabelInfo& l : model_.labels)
      if (l.number == label) return l.name;
    fail_internal("label " + std::to_string(label) + " has no name", "solver model");
  }
  void add(const std::string& name, const std::string& note, std::vector<std::int32_t> faces) {
    if (faces.empty()) return;
    std::sort(faces.begin(), faces.end());
    lists_.push_back({unique(name), note, std::move(faces)});
  }
  template <class Test>
  std::vector<std::int32_t> faces_where(Test test) const {
    std::vector<std::int32_t> found;
    for (std::size_t i = 0; i < faces_.size(); ++i)
      if (test(faces_[i])) found.push_back(static_cast<std::int32_t>(i));
    return found;
  }

  /// Which part each label is of.
  void number_parts() {
    part_names_.clear();
    std::map<Label, int> part_of_label;
    std::set<std::string> names;
    for (const auto& [name, labels] : o_.parts) {
      if (sanitised_name(name) != name || !names.insert(lower_case(name)).second)
        fail_usage("'" + name + "' is no name for a part, or is there twice", "--parts",
                   "use letters, digits and _, each name once: A=1,3 B=2,4");
      for (const Label l : labels)
        if (!part_of_label.insert({l, static_cast<int>(part_names_.size())}).second)
          fail_usage("label " + std::to_string(l) + " is in two parts", "--parts", "give each label to one part");
      part_names_.push_back(name);
    }
    if (part_names_.empty()) return;
    for (const LabelInfo& l : model_.labels)
      if (part_of_label.count(l.number) == 0) {
        if (names.insert("rest").second) part_names_.push_back("rest");
        part_of_label[l.number] = static_cast<int>(part_names_.size()) - 1;
      }
    part_of_ = std::move(part_of_label);
  }

  void outer_of(const LabelInfo& label) {
    const std::string n = label.name, who = "label " + std::to_string(label.number);
    std::vector<std::int32_t> outer =
        faces_where([&](const BoundaryFace& f) { return f.in == label.number && f.out == 0 && f.behind == 0; });
    if (outer.empty()) return;
    add(n + "_outer", who + ": faces to the background", outer);
    std::vector<char> wall(faces_.size(), 0);
    for (const bool high : {false, true}) {
      const Patch cap = flat_cap(model_.mesh, faces_, outer, high ? o_.up : -1.0 * o_.up);
      for (const std::int32_t f : cap) wall[f] = 1;
      add(n + (high ? "_cap_high" : "_cap_low"),
          who + ": flat " + (high ? "high" : "low") + " end along the stacking axis", cap);
      (high ? caps_high_ : caps_low_).push_back(cap);
    }
    PatchOptions options;
    options.sharp_deg = o_.sharp_deg;
    std::vector<Patch> patches = split_at_sharp_edges(faces_, outer, wall, options);
    patches.erase(std::remove_if(patches.begin(), patches.end(), [&](const Patch& p) { return wall[p[0]] != 0; }),
                  patches.end());
    join_islands(faces_, faces_where([&](const BoundaryFace& f) { return f.in == label.number; }), 0.01, patches);
    if (patches.size() == 1 && patches[0].size() == outer.size()) return;
    for (std::size_t i = 0; i < patches.size(); ++i)
      add(n + "_outer_" + std::to_string(i + 1), who + ": part of its outer faces, between sharp edges", patches[i]);
  }

  void interfaces_of(const LabelInfo& label) {
    std::map<Label, std::vector<std::int32_t>> to;
    for (std::size_t i = 0; i < faces_.size(); ++i)
      if (faces_[i].in == label.number && faces_[i].out != 0) to[faces_[i].out].push_back(static_cast<std::int32_t>(i));
    for (auto& [other, list] : to)
      add(label.name + "_to_" + name_of(other),
          "faces of label " + std::to_string(label.number) + " on label " + std::to_string(other), std::move(list));
  }

  void walls_of(const LabelInfo& hollow) {
    int labels = 0;
    for (const LabelInfo& l : model_.labels) {
      std::vector<std::int32_t> wall =
          faces_where([&](const BoundaryFace& f) { return f.in == l.number && f.behind == hollow.number; });
      labels += wall.empty() ? 0 : 1;
      add(l.name + "_inner_" + void_name(hollow),
          "faces of label " + std::to_string(l.number) + " on void " + std::to_string(hollow.number), std::move(wall));
    }
    if (labels > 1)
      add("inner_" + void_name(hollow), "faces of all labels on void " + std::to_string(hollow.number),
          faces_where([&](const BoundaryFace& f) { return f.behind == hollow.number; }));
  }
  /// By its name, or the bare number where it has none.
  static std::string void_name(const LabelInfo& hollow) {
    const std::string number = std::to_string(hollow.number);
    return hollow.name == "label_" + number ? number : hollow.name;
  }

  void all_caps() {
    for (const bool high : {false, true}) {
      const std::vector<Patch>& caps = high ? caps_high_ : caps_low_;
      // Only those that end as far out as the furthest one are ends of the whole.
      double top = -1e300;
      const Vec3 up = high ? o_.up : -1.0 * o_.up;
      for (const Patch& c : caps)
        for (const std::int32_t f : c) top = std::max(top, dot(up, faces_[f].centre));
      std::vector<std::int32_t> all;
      int labels = 0;
      for (const Patch& c : caps) {
        double mine = -1e300, area = 0;
        for (const std::int32_t f : c) {
          mine = std::max(mine, dot(up, faces_[f].centre));
          area += faces_[f].area_mm2;
        }
        if (c.empty() || mine < top - 0.1 * std::sqrt(area / static_cast<double>(c.size()))) continue;
        all.insert(all.end(), c.begin(), c.end());
        ++labels;
      }
      if (labels > 1)
        add(high ? "cap_high" : "cap_low", std::string("flat ") + (high ? "high" : "low") + " ends of all labels", all);
    }
  }

  void image_sides() {
    if (!o_.image) return;
    const ImageBox& box = *o_.image;
    for (int axis = 0; axis < 3; ++axis)
      for (const bool high : {false, true}) {
        const Vec3 out = high ? box.axes[axis] : -1.0 * box.axes[axis];
        const double at = dot(out, box.origin + (high ? box.length_mm[axis] : 0.0) * box.axes[axis]);
        add(std::string("border_") + "xyz"[axis] + (high ? "_high" : "_low"),
            std::string("faces on the image's own side, ") + "xyz"[axis] + (high ? " high" : " low"),
            faces_where([&](const BoundaryFace& f) {
              bool on = f.out == 0 && f.behind == 0 && dot(out, f.normal) > 0.9;
              for (const std::int32_t v : f.v)
                on = on && dot(out, model_.mesh.points[v]) > at - 0.3 * box.spacing_mm[axis];
              return on;
            }));
      }
  }

  int part(const BoundaryFace& f, bool other) const {
    return other && f.out == 0 ? -1 : part_of_.at(other ? f.out : f.in);
  }

  void parts() {
    if (part_names_.empty()) return;
    for (const auto& [name, labels] : o_.parts)
      for (const Label l : labels) name_of_given(l);
    for (std::size_t a = 0; a < part_names_.size(); ++a)
      for (std::size_t b = 0; b < part_names_.size(); ++b) {
        if (a == b) continue;
        std::vector<std::int32_t> list = faces_where([&](const BoundaryFace& f) {
          return part(f, false) == static_cast<int>(a) && part(f, true) == static_cast<int>(b);
        });
        if (list.empty()) continue;
        add("contact_" + part_names_[a] + "_" + part_names_[b],
            "faces of part " + part_names_[a] + " on part " + part_names_[b], list);
        contacts_[{static_cast<int>(a), static_cast<int>(b)}] = {lists_.back().name, lists_.back().faces};
      }
    for (const auto& [ab, contact] : contacts_) {
      if (ab.first > ab.second) continue;
      const auto other = contacts_.find({ab.second, ab.first});
      SurfacePair pair;
      pair.name = unique("pair_" + part_names_[ab.first] + "_" + part_names_[ab.second]);
      pair.primary = contact.first;
      pair.secondary = other->second.first;
      pair.parts = {part_names_[ab.first], part_names_[ab.second]};
      model_.sets.pairs.push_back(std::move(pair));
    }
  }
  void name_of_given(Label label) const {
    for (const LabelInfo& l : model_.labels)
      if (l.number == label) return;
    fail_input("label " + std::to_string(label) + " is not in the mesh", "--parts", "name labels that were meshed");
  }

  void selections() {
    if (o_.selections.empty()) return;
    const auto find = [&](const std::string& name) -> const std::vector<std::int32_t>* {
      for (const FaceList& l : lists_)
        if (l.name == name) return &l.faces;
      return nullptr;
    };
    const auto place = [&](std::int32_t f) {
      if (faces_[f].behind != 0) return name_of(faces_[f].in) + "_inner_" + std::to_string(faces_[f].behind);
      return faces_[f].out == 0 ? name_of(faces_[f].in) + "_outer"
                                : name_of(faces_[f].in) + "_to_" + name_of(faces_[f].out);
    };
    const auto names = [&] {
      std::vector<std::string> all;
      for (const FaceList& l : lists_) all.push_back(l.name);
      return all;
    };
    const SelectionContext context = {model_.mesh, faces_, model_.labels, find, names, place};
    for (const std::string& text : o_.selections) {
      const auto [name, list] = select_faces(text, context);
      if (taken_.count(lower_case(name)) > 0)
        fail_usage("a set named '" + name + "' is there already", "--select " + text, "choose another name");
      add(name, "selected: " + text.substr(text.find('=') + 1), list);
    }
  }

  std::vector<TetFace> outer_faces(Label label) const {
    std::vector<TetFace> faces;
    for (const BoundaryFace& f : faces_)
      if (f.in == label && f.out == 0) faces.push_back(f.at);
    return faces;
  }

  void skins() {
    for (const auto& [label, thickness] : o_.skins) {
      ShellSet shells;
      shells.label = label;
      shells.thickness_mm = thickness;
      shells.faces = outer_faces(label);
      if (shells.faces.empty())
        fail_input("label " + std::to_string(label) + " has no faces to the background", "--skin",
                   "name a label with outer faces");
      shells.name = unique(name_of(label) + "_skin");
      model_.sets.shells.push_back(std::move(shells));
    }
  }

  /// Goes on to the mesh that this one was cut into: the faces of each set are cut likewise.
  void cut(TetMesh finer) {
    std::vector<BoundaryFace> cut_faces = boundary_faces(finer);
    const std::vector<std::int32_t> from = uncut_faces(finer, cut_faces, faces_);
    std::vector<std::vector<std::int32_t>> into(faces_.size());
    for (std::size_t i = 0; i < from.size(); ++i) {
      into[from[i]].push_back(static_cast<std::int32_t>(i));
      cut_faces[i].behind = faces_[from[i]].behind;
    }
    const auto cut_list = [&](std::vector<std::int32_t>& list) {
      std::vector<std::int32_t> parts;
      for (const std::int32_t f : list) parts.insert(parts.end(), into[f].begin(), into[f].end());
      std::sort(parts.begin(), parts.end());
      list = std::move(parts);
    };
    for (FaceList& l : lists_) cut_list(l.faces);
    for (auto& [parts, contact] : contacts_) cut_list(contact.second);
    faces_ = std::move(cut_faces);
    for (ShellSet& shells : model_.sets.shells) shells.faces = outer_faces(shells.label);
    model_.mesh = std::move(finer);
    model_.mesh.faces.clear();
  }

  /// Nodes are copied for the parts, then sets are written down with the nodes they have by then.
  void finish() {
    TetMesh& mesh = model_.mesh;
    std::vector<std::int32_t>& original = model_.sets.original;
    if (!part_names_.empty()) {
      std::vector<int> part_of_tet;
      part_of_tet.reserve(mesh.elements());
      for (const Label l : mesh.labels) part_of_tet.push_back(part_of_.at(l));
      original = split_parts(mesh, part_of_tet);
      model_.sets.parts = part_names_;
      model_.sets.part_of_node.assign(mesh.points.size(), 0);
      for (std::size_t t = 0; t < mesh.elements(); ++t)
        each_node(mesh, t, [&](std::int32_t v) { model_.sets.part_of_node[v] = part_of_tet[t]; });
    }
    for (BoundaryFace& f : faces_) {
      const auto nodes = outward_nodes(mesh, f.at);
      f.v = {nodes[0], nodes[1], nodes[2]};
      const bool apart = !part_names_.empty() && f.out != 0 && part(f, false) != part(f, true);
      if (f.out == 0 || f.in < f.out || apart) mesh.faces.push_back({f.v, f.in, f.out});
    }
    for (const FaceList& list : lists_) {
      FaceSet set{list.name, "", {}};
      for (const std::int32_t f : list.faces) set.faces.push_back(faces_[f].at);
      model_.sets.node_sets.push_back({list.name, list.note, nodes_of_faces(mesh, set.faces)});
      model_.sets.surfaces.push_back(std::move(set));
    }
    rims(original);
  }

  /// Outlines of the contact surfaces, and the nodes where three parts or more meet.
  void rims(const std::vector<std::int32_t>& original) {
    const TetMesh& mesh = model_.mesh;
    for (const auto& [ab, contact] : contacts_) {
      // ends to how often, and mid-side node
      std::map<std::pair<std::int32_t, std::int32_t>, std::vector<std::int32_t>> edges;
      for (const std::int32_t f : contact.second) {
        const auto nodes = outward_nodes(mesh, faces_[f].at);
        for (int k = 0; k < 3; ++k) edges[std::minmax(nodes[k], nodes[(k + 1) % 3])].push_back(nodes[3 + k]);
      }
      NodeSet rim;
      for (const auto& [ends, mids] : edges) {
        if (mids.size() != 1) continue;
        rim.nodes.insert(rim.nodes.end(), {ends.first, ends.second});
        if (mids[0] >= 0) rim.nodes.push_back(mids[0]);
      }
      add_nodes(std::move(rim), "rim_" + part_names_[ab.first] + "_" + part_names_[ab.second],
                "outline of part " + part_names_[ab.first] + "'s contact with part " + part_names_[ab.second]);
    }
    if (part_names_.size() < 3) return;
    std::map<std::int32_t, std::set<int>> parts_of;  // by original node
    std::map<std::int32_t, std::set<std::int32_t>> copies;
    for (std::size_t t = 0; t < mesh.elements(); ++t) {
      const auto visit = [&](std::int32_t v) {
        parts_of[original[v]].insert(part_of_.at(mesh.labels[t]));
        copies[original[v]].insert(v);
      };
      each_node(mesh, t, visit);
    }
    std::map<std::set<int>, NodeSet> lines;
    for (const auto& [node, parts] : parts_of)
      if (parts.size() > 2)
        lines[parts].nodes.insert(lines[parts].nodes.end(), copies[node].begin(), copies[node].end());
    for (auto& [parts, set] : lines) {
      std::string name = "triple";
      for (const int p : parts) name += "_" + part_names_[p];
      add_nodes(std::move(set), name, "nodes at which these parts meet, every part's own copy");
    }
  }

  void add_nodes(NodeSet set, const std::string& name, const std::string& note) {
    if (set.nodes.empty()) return;
    std::sort(set.nodes.begin(), set.nodes.end());
    set.nodes.erase(std::unique(set.nodes.begin(), set.nodes.end()), set.nodes.end());
    set.name = unique(name);
    set.note = note;
    model_.sets.node_sets.push_back(std::move(set));
  }

  const SetOptions& o_;
  SolverModel model_;
  std::vector<TetMesh> finer_;  // what model_.mesh was cut into, the finest first
  std::vector<LabelInfo> voids_;
  std::vector<BoundaryFace> faces_;
  std::vector<FaceList> lists_;
  std::vector<Patch> caps_low_, caps_high_;
  std::vector<std::string> part_names_;
  std::map<Label, int> part_of_;
  std::map<std::pair<int, int>, std::pair<std::string, std::vector<std::int32_t>>> contacts_;
  std::set<std::string> taken_ = {"nall", "eall", "loaded_nodes"};
};

}  // namespace

SolverModel name_sets(const TetMesh& mesh, const std::vector<LabelInfo>& labels, const SetOptions& options) {
  return Namer(mesh, labels, options).run();
}

}  // namespace stackmesh
