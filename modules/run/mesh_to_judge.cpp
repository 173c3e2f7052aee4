#include "run/mesh_to_judge.h"

#include <cstdio>
#include <utility>

#include "base/sha256.h"
#include "run/turn_as_a_whole.h"

namespace stackmesh {

void read_against(const ValidateRunOptions& options, Against& against) {
  against.input = read_input(*options.against);
  empty_voids(against.input);
  if (!against.input.volume) {
    against.sections = drawn_sections(against.input);
    empty_voids(against.sections, against.input.voids);
  }
  if (against.input.volume) {
    against.stored_size = against.input.volume->size;
    against.stored_spacing_mm = against.input.volume->spacing_mm;
    against.stored_frame = {against.input.volume->origin_mm, against.input.volume->axes};
    if (!options.as_stored) reduce_to_true_grid(against.input, options.threads);
    against.axis = stacking_axis(*against.input.volume, options.axis);
    against.meter.emplace(*against.input.volume, against.axis, options.threads);
  }
}

void describe_input(const Against& against, RunReport& report) {
  report.input.path = against.input.path;
  report.input.kind = against.input.kind;
  report.warnings = against.input.warnings;
  report.input.axis = std::string(1, "xyz"[against.axis]);
  if (against.input.volume) {
    const LabelVolume& v = *against.input.volume;
    report.input.dimensions = against.stored_size;
    report.input.spacing_mm = against.stored_spacing_mm;
    report.input.effective_spacing_mm = v.spacing_mm;
    report.input.sections = static_cast<std::size_t>(v.size[against.axis]);
    report.input.space = v.anatomical ? "lps" : "none";
  } else {
    report.input.sections = against.sections.sections.size();
    report.input.space = against.input.anatomical ? "lps" : "none";
  }
}

MeshToJudge read_mesh_to_judge(const std::string& path, const ValidateRunOptions& options, RunReport& report) {
  MeshToJudge mesh;
  mesh.file = read_mesh(path, options.read);
  JudgedMesh m;
  m.path = path, m.format = mesh.file.format;
  m.vertices = mesh.file.points.size() + mesh.file.merged_points;
  m.triangles = mesh.file.triangles.size() + mesh.file.dropped_triangles, m.tets = mesh.file.tets.size(),
  m.wedges = mesh.file.wedges.size();
  m.order = mesh.file.midside.empty() ? 1 : 2;
  if (!options.reports.empty()) m.sha256 = sha256_of_file(path);
  report.mesh = std::move(m);
  for (const std::string& n : mesh.file.notes)
    report.warnings.push_back({WarningCode::mesh_converted, mesh.file.path, n});
  if (mesh.file.tets.empty() && mesh.file.wedges.empty()) {
    mesh.surface.points = std::move(mesh.file.points);
    mesh.surface.triangles = std::move(mesh.file.triangles);
    return mesh;
  }
  mesh.tets = take_elements(mesh.file);
  mesh.tets.faces = std::move(mesh.file.triangles);
  mesh.has_faces = !mesh.tets.faces.empty();
  return mesh;
}

void turn_round(MeshToJudge& mesh, RunReport& report) {
  for (const std::string& note : turn_as_a_whole(mesh.surface, mesh.tets, mesh.has_faces))
    report.warnings.push_back({WarningCode::mesh_converted, mesh.file.path, note});
}

std::string three_decimals(double share) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3f", share);
  return text;
}

}  // namespace stackmesh
