#include "meshio/write_mesh.h"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <set>

#include "base/error.h"
#include "base/text.h"
#include "meshio/formats.h"

namespace stackmesh {
namespace {

using Writer = void (*)(std::FILE*, const PreparedMesh&);
struct Format {
  const char* ending;
  Writer writer;
};
constexpr Format kSurfaceFormats[] = {
    {".stl", write_stl}, {".ply", write_ply}, {".obj", write_obj}, {".off", write_off}, {".vtp", write_vtp}};
constexpr Format kVolumeFormats[] = {{".vtu", write_vtu},
                                     {".msh", write_msh4},
                                     {".inp", write_inp},
                                     {".feb", write_feb},
                                     {".bdf", write_bdf},
                                     {".vtk", write_vtk},
                                     {".mesh", write_medit}};

/// Where the ending begins; the length of the path if it has none.
std::size_t ending_of(const std::string& path) {
  const std::size_t name = path.find_last_of('/') + 1;  // npos + 1 == 0
  const std::size_t dot = path.find_last_of('.');
  return dot == std::string::npos || dot < name ? path.size() : dot;
}

template <std::size_t N>
Writer find_writer(const Format (&formats)[N], const std::string& path) {
  const std::string ending = lower_case(path.substr(ending_of(path)));
  const auto* found = std::find_if(std::begin(formats), std::end(formats),
                                   [&](const Format& f) { return ending == f.ending; });
  return found == std::end(formats) ? nullptr : found->writer;
}

template <std::size_t N>
Writer need_writer(const Format (&formats)[N], const std::string& path, const char* kind) {
  const Writer writer = find_writer(formats, path);
  if (writer != nullptr) return writer;
  std::string endings;
  for (const Format& f : formats) endings += std::string(endings.empty() ? "" : " ") + f.ending;
  fail_usage(std::string("the ending names no ") + kind + " format", path, "use one of " + endings);
}

}  // namespace

bool is_surface_format(const std::string& path) {
  return find_writer(kSurfaceFormats, path) != nullptr;
}
bool is_volume_format(const std::string& path) {
  return find_writer(kVolumeFormats, path) != nullptr;
}

void write_surface(AtomicFiles& files, const std::string& path, const InterfaceComplex& surface,
                   const MeshWriteOptions& options) {
  const Writer writer = need_writer(kSurfaceFormats, path, "surface");
  const auto write = [&](const std::string& to, const PreparedMesh& mesh) {
    files.write(to, [&](std::FILE* file) { writer(file, mesh); });
  };
  if (!options.per_label) {
    write(path, prepare_surface(surface, options, path));
    return;
  }
  std::set<Label> labels;
  for (const InterfaceTriangle& t : surface.triangles) {
    labels.insert(t.below);
    labels.insert(t.above);
  }
  labels.erase(0);
  if (labels.empty())
    throw Error(ErrorKind::no_result, "the surface is empty", path, "check the labels that were asked for");
  const std::size_t dot = ending_of(path);
  for (const Label label : labels) {
    const std::string to = path.substr(0, dot) + "_" + std::to_string(label) + path.substr(dot);
    write(to, prepare_label_surface(surface, label, options, to));
  }
}

void write_volume(AtomicFiles& files, const std::string& path, const TetMesh& mesh,
                  const MeshWriteOptions& options) {
  Writer writer = need_writer(kVolumeFormats, path, "volume");
  if (writer == write_msh4 && options.msh2) writer = write_msh2;
  PreparedMesh prepared = prepare_volume(mesh, options, path);
  if (writer == write_inp || writer == write_feb || writer == write_bdf) add_interface_sets(prepared);
  files.write(path, [&](std::FILE* file) { writer(file, prepared); });
}

std::vector<std::string> losses_of(const std::string& path, const SolverModel& model) {
  const Writer writer = find_writer(kVolumeFormats, path);
  const SolverSets& sets = model.sets;
  std::vector<std::string> losses;
  const auto any_material = [&](MaterialKind kind) {
    return std::any_of(sets.materials.begin(), sets.materials.end(), [&](const ElementMaterial& m) { return m.kind == kind; });
  };
  const auto any_step = [&](Analysis analysis) {
    return std::any_of(sets.steps.begin(), sets.steps.end(), [&](const LoadStep& s) { return s.analysis == analysis; });
  };
  if (writer == write_inp && any_material(MaterialKind::holzapfel))
    losses.push_back(path + ": CalculiX has no Holzapfel-Gasser-Ogden material; the deck is for Abaqus");
  if (writer == write_feb && any_step(Analysis::frequency)) losses.push_back(path + ": FEBio finds no natural frequencies; these steps are left out");
  if (writer == write_bdf) {
    if (any_step(Analysis::frequency) && any_step(Analysis::statics))
      losses.push_back(path + ": a Nastran deck has one solution sequence; the frequency steps are written, the static ones left out");
    if (any_material(MaterialKind::holzapfel)) losses.push_back(path + ": Nastran has no Holzapfel-Gasser-Ogden material; the label gets its isotropic one at small strain");
    for (const ElementMaterial& m : sets.materials)
      if (m.kind == MaterialKind::orthotropic &&
          std::any_of(m.tets.begin(), m.tets.end(), [&](std::int32_t t) { return norm(sets.axes[t][0] - sets.axes[m.tets[0]][0]) > 0; }))
        losses.push_back(path + ": fibres that turn from element to element are not written; label " + std::to_string(m.label) + " gets an isotropic material");
    if (sets.has_contact()) losses.push_back(path + ": contact is not written, the surfaces are named only");
  }
  return losses;
}

void write_model(AtomicFiles& files, const std::string& path, const SolverModel& model, const MeshWriteOptions& options) {
  Writer writer = need_writer(kVolumeFormats, path, "volume");
  if (writer == write_msh4 && options.msh2) writer = write_msh2;
  const PreparedMesh prepared = prepare_model(model, options, path);
  files.write(path, [&](std::FILE* file) { writer(file, prepared); });
}

}  // namespace stackmesh
