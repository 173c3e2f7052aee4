#include "run/given_mesh.h"

#include <algorithm>
#include <set>

#include "base/error.h"
#include "base/warning.h"
#include "fem/element_quality.h"
#include "fem/split_parts.h"
#include "image/read_label_table.h"
#include "model/label_table.h"
#include "model/space.h"
#include "run/complete_report.h"
#include "run/provenance.h"
#include "validate/check_volume.h"

namespace stackmesh {
namespace {

std::array<std::int32_t, 3> sorted(std::array<std::int32_t, 3> v) {
  std::sort(v.begin(), v.end());
  return v;
}

}  // namespace

MeshProduct GivenMesh::read(const std::string& path, RunReport& report) {
  MeshReadOptions how;
  how.label_array = o_.label_array;
  MeshFile file = read_mesh(path, how);
  if (file.tets.empty()) fail_input("the mesh has no tetrahedra", path, "give a volume mesh, or labels");
  report.input.path = path;
  report.input.kind = "mesh";
  for (const std::string& note : file.notes) report.warnings.push_back({WarningCode::mesh_converted, path, note});
  if (file.label_source == LabelSource::none)
    report.warnings.push_back(
        warning_at(WarningCode::labels_matched, path,
                   "no cell array holds labels: every element has label 1 (name an array with --label-array)"));
  if (!file.space)
    report.warnings.push_back(warning_at(WarningCode::frame, path, "does not say its frame; it is taken as LPS"));
  MeshProduct product;
  product.mesh = take_elements(file);
  product.mesh.space = file.space.value_or(Space::lps);
  written_ = product.mesh.space == Space::none ? Space::none : o_.mesh.space == "ras" ? Space::ras : Space::lps;
  report.input.space = to_text(written_);
  product.up = o_.up;
  if (product.mesh.space == Space::ras) change_space(product.mesh, Space::lps);  // and back again
  if (!product.mesh.wedges.empty() && (o_.mesh.mesh.refine > 0 || o_.accuracy_rel))
    fail_usage("the mesh has wedges, and only tetrahedra are cut into eight", path,
               o_.mesh.mesh.refine > 0 ? "leave --refine out" : "leave --accuracy out");
  take_labels(file, path, product);
  keep_labels(product);
  return product;
}

/// The mesh's labels, and its faces on voids, with their names.
void GivenMesh::take_labels(const MeshFile& file, const std::string& path, MeshProduct& product) {
  const std::set<Label> present(product.mesh.labels.begin(), product.mesh.labels.end());
  for (const Label l : present) {
    if (l <= 0)
      fail_input("a label of the mesh is not above 0", path + ", label " + std::to_string(l),
                 "number labels from 1; 0 is the background");
    product.labels.push_back({l, ""});
    for (const LabelInfo& named : file.names)
      if (named.number == l) product.labels.back() = named;
  }
  for (std::size_t t = 0; t < file.behind.size(); ++t)
    if (file.behind[t] != 0) walls_[sorted(file.triangles[t].v)] = file.behind[t];
  for (const LabelInfo& named : file.names)
    if (std::find(file.behind.begin(), file.behind.end(), named.number) != file.behind.end()) voids_.push_back(named);
  if (!o_.mesh.input.names.empty()) {
    const std::vector<LabelInfo> table = read_label_table(o_.mesh.input.names);
    apply_label_table(table, product.labels);
    apply_label_table(table, voids_);
  }
}

std::vector<Label> GivenMesh::voids_behind(const std::vector<InterfaceTriangle>& faces) const {
  std::vector<Label> behind(walls_.empty() ? 0 : faces.size(), 0);
  for (std::size_t i = 0; i < behind.size(); ++i)
    if (const auto at = walls_.find(sorted(faces[i].v));
        at != walls_.end() && (faces[i].below == 0 || faces[i].above == 0))
      behind[i] = at->second;
  return behind;
}

/// --label and --merge.
void GivenMesh::keep_labels(MeshProduct& product) const {
  if (o_.mesh.input.labels.empty() && !o_.mesh.input.merge) return;
  std::set<Label> keep;
  std::vector<LabelInfo> kept;
  for (const std::size_t k : LabelTable(product.labels).resolve(o_.mesh.input.labels)) {
    keep.insert(product.labels[k].number);
    if (kept.empty() || !o_.mesh.input.merge) kept.push_back(product.labels[k]);
  }
  relabel(product.mesh, [&](Label l) { return keep.count(l) == 0 ? 0 : o_.mesh.input.merge ? kept[0].number : l; });
  product.labels = std::move(kept);
}

void GivenMesh::check_elements(const TetMesh& mesh, const RunReport& report) const {
  const ElementQuality quality = element_quality(mesh);
  if (!quality.non_positive.empty()) {
    std::string list;
    for (std::size_t i = 0; i < std::min<std::size_t>(quality.non_positive.size(), 100); ++i)
      list += (i > 0 ? ", " : "") + std::to_string(quality.non_positive[i] + 1);
    if (quality.non_positive.size() > 100) list += ", ...";
    fail_input(std::to_string(quality.non_positive.size()) + " of " + std::to_string(mesh.elements()) +
                   " elements have a Jacobian that is not positive",
               report.input.path + ", elements " + list,
               "mesh it again, or turn the elements round where their nodes are in the wrong order");
  }
}

void GivenMesh::check(MeshProduct& product, RunReport& report) {
  TetMesh& mesh = product.mesh;
  check_elements(mesh, report);
  if (o_.mesh.mesh.order == 1 && !mesh.mid.empty()) {
    mesh.mid.clear();
    mesh.wedge_mid.clear();
    report.warnings.push_back({WarningCode::element_order, report.input.path,
                               "the mesh is of second order: its mid-side nodes are left out (--order 1)"});
  }
  add_label_rows(report, product.labels);
  // A mesh whose parts have nodes of their own is judged as one body.
  TetMesh whole = mesh;
  if (const std::size_t twins = join_equal_nodes(whole); twins > 0) {
    const std::string text = std::to_string(twins) + " nodes lie exactly on another one";
    if (o_.parts.empty()) {
      report.warnings.push_back({WarningCode::coincident_nodes, report.input.path,
                                 text + " and stay apart from it; --parts makes contact or ties of such faces"});
    } else {
      report.warnings.push_back(
          {WarningCode::coincident_nodes, report.input.path, text + ": they were joined to it before --parts"});
      mesh = whole;
      walls_.clear();  // they name the nodes before
    }
  }
  mesh.faces = faces_of_tets(mesh);
  whole.faces = faces_of_tets(whole);
  judge(whole, report);
  if (!report.volume->conforms)
    report.warnings.push_back({WarningCode::not_conforming, report.input.path,
                               "the mesh does not conform: faces or edges of its tetrahedra do not match"});
}

/// Its surface only for a report.
void GivenMesh::judge(const TetMesh& mesh, RunReport& report) const {
  if (o_.mesh.reports.empty()) {
    report.volume = check_volume(mesh, {o_.mesh.mesh.threads});
    return;
  }
  const InterfaceComplex surface = {mesh.points, mesh.faces, mesh.space};
  check_mesh(report, surface, &mesh, o_.mesh.mesh.threads);
  Judged judged;
  judged.surface = &surface;
  judged.mesh = &mesh;
  judged.threads = o_.mesh.mesh.threads;
  complete_report(report, judged);
  report.provenance = find_provenance({report.input.path});
}

}  // namespace stackmesh
