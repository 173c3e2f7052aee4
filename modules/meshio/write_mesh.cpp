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

struct Format {
  const char* ending;
  void (*to_stream)(std::FILE*, const PreparedMesh&);
  void (*by_name)(const std::string&, const PreparedMesh&) = nullptr;  ///< of a library that opens the file itself
  bool has_sets = false;  ///< of a mere mesh it gets its interfaces as sets, and a material for each label
};
constexpr Format kSurfaceFormats[] = {
    {".stl", write_stl}, {".ply", write_ply}, {".obj", write_obj}, {".off", write_off}, {".vtp", write_vtp}};
constexpr Format kVolumeFormats[] = {{".vtu", write_vtu},
                                     {".msh", write_msh4},
                                     {".inp", write_inp, nullptr, true},
                                     {".feb", write_feb, nullptr, true},
                                     {".bdf", write_bdf, nullptr, true},
                                     {".cdb", write_cdb, nullptr, true},
                                     {".k", write_dyna, nullptr, true},
                                     {".exo", nullptr, write_exodus, true},
                                     {".med", write_med, nullptr, true},
                                     {".vtk", write_vtk},
                                     {".mesh", write_medit}};
constexpr Format kMsh2 = {".msh", write_msh2};

/// Where the ending begins; the length of the path if it has none.
std::size_t ending_of(const std::string& path) {
  const std::size_t name = path.find_last_of('/') + 1;  // npos + 1 == 0
  const std::size_t dot = path.find_last_of('.');
  return dot == std::string::npos || dot < name ? path.size() : dot;
}

template <std::size_t N>
const Format* find_format(const Format (&formats)[N], const std::string& path) {
  const std::string ending = lower_case(path.substr(ending_of(path)));
  const auto* found =
      std::find_if(std::begin(formats), std::end(formats), [&](const Format& f) { return ending == f.ending; });
  return found == std::end(formats) ? nullptr : found;
}

template <std::size_t N>
std::string endings_of(const Format (&formats)[N]) {
  std::string endings;
  for (const Format& f : formats) endings += std::string(endings.empty() ? "" : " ") + f.ending;
  return endings;
}

template <std::size_t N>
const Format& need_format(const Format (&formats)[N], const std::string& path, const char* kind) {
  if (const Format* format = find_format(formats, path)) return *format;
  fail_usage(std::string("the ending names no ") + kind + " format", path, "use one of " + endings_of(formats));
}

const Format& volume_format(const std::string& path, const MeshWriteOptions& options) {
  const Format& format = need_format(kVolumeFormats, path, "volume");
  return format.to_stream == write_msh4 && options.msh2 ? kMsh2 : format;
}

void write_to(AtomicFiles& files, const std::string& path, const Format& format, const PreparedMesh& mesh) {
  if (format.by_name != nullptr)
    files.write_by_name(path, [&](const std::string& name) { format.by_name(name, mesh); });
  else files.write(path, [&](std::FILE* file) { format.to_stream(file, mesh); });
}

}  // namespace

bool is_surface_format(const std::string& path) {
  return find_format(kSurfaceFormats, path) != nullptr;
}
bool is_volume_format(const std::string& path) {
  return find_format(kVolumeFormats, path) != nullptr;
}
void require_writer(const std::string& path) {
  const Format* format = find_format(kVolumeFormats, path);
  if (format != nullptr && (format->by_name == write_exodus || format->to_stream == write_med)) require_hdf5_writers();
}
std::string surface_endings() {
  return endings_of(kSurfaceFormats);
}
std::string volume_endings() {
  return endings_of(kVolumeFormats);
}

void write_surface(AtomicFiles& files, const std::string& path, const InterfaceComplex& surface,
                   const MeshWriteOptions& options) {
  const Format& format = need_format(kSurfaceFormats, path, "surface");
  const auto write = [&](const std::string& to, const PreparedMesh& mesh) { write_to(files, to, format, mesh); };
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
    throw Error(ErrorKind::no_result, "the surface is empty", path, "check the labels that were requested");
  const std::size_t dot = ending_of(path);
  for (const Label label : labels) {
    const std::string to = path.substr(0, dot) + "_" + std::to_string(label) + path.substr(dot);
    write(to, prepare_label_surface(surface, label, options, to));
  }
}

void write_volume(AtomicFiles& files, const std::string& path, const TetMesh& mesh, const MeshWriteOptions& options) {
  const Format& format = volume_format(path, options);
  PreparedMesh prepared = prepare_volume(mesh, options, path);
  if (format.has_sets) add_interface_sets(prepared);
  write_to(files, path, format, prepared);
}

std::vector<std::string> losses_of(const std::string& path, const SolverModel& model) {
  const Format* format = find_format(kVolumeFormats, path);
  if (format == nullptr) return {};
  const auto writer = format->to_stream;
  const SolverSets& sets = model.sets;
  std::vector<std::string> losses;
  const auto any_material = [&](MaterialKind kind) {
    return std::any_of(sets.materials.begin(), sets.materials.end(),
                       [&](const ElementMaterial& m) { return m.kind == kind; });
  };
  const auto any_material_but = [&](MaterialKind kind) {
    return std::any_of(sets.materials.begin(), sets.materials.end(),
                       [&](const ElementMaterial& m) { return m.kind != kind; });
  };
  const auto any_step = [&](Analysis analysis) {
    return std::any_of(sets.steps.begin(), sets.steps.end(), [&](const LoadStep& s) { return s.analysis == analysis; });
  };
  if (writer == write_inp && any_material(MaterialKind::holzapfel))
    losses.push_back(path + ": CalculiX has no Holzapfel-Gasser-Ogden material; the deck is for Abaqus");
  if (writer == write_feb && any_step(Analysis::frequency))
    losses.push_back(path + ": FEBio finds no natural frequencies; these steps are left out");
  if (writer == write_bdf) {
    if (any_step(Analysis::frequency) && any_step(Analysis::statics))
      losses.push_back(
          path +
          ": a Nastran deck has one solution sequence; the frequency steps are written, the static ones left out");
    if (any_material(MaterialKind::holzapfel))
      losses.push_back(
          path + ": Nastran has no Holzapfel-Gasser-Ogden material; the label gets its isotropic one at small strain");
    for (const ElementMaterial& m : sets.materials)
      if (m.kind == MaterialKind::orthotropic && std::any_of(m.tets.begin(), m.tets.end(), [&](std::int32_t t) {
            return norm(sets.axes[t][0] - sets.axes[m.tets[0]][0]) > 0;
          }))
        losses.push_back(path + ": fibres that turn from element to element are not written; label " +
                         std::to_string(m.label) + " gets an isotropic material");
    if (sets.has_contact()) losses.push_back(path + ": contact is not written, the surfaces are named only");
  }
  const bool pyramids =
      std::any_of(model.mesh.wedges.begin(), model.mesh.wedges.end(), [](const auto& w) { return is_pyramid(w); });
  if (writer == write_medit && !model.mesh.wedges.empty())
    losses.push_back(path + ": the format has no pyramids; wedges and pyramids are divided into tetrahedra");
  if (writer == write_inp && pyramids && !model.mesh.wedge_mid.empty())
    losses.push_back(path +
                     ": CalculiX has no pyramids; where layers end they are C3D15 with two corners at one point, which "
                     "fit their neighbours within a few percent of the stress");
  const bool mesh_only = format->by_name == write_exodus || writer == write_med;
  if (mesh_only && !sets.steps.empty())
    losses.push_back(path + ": the format holds no load case; supports and loads are left out, their sets are there");
  if (mesh_only && any_material_but(MaterialKind::linear))
    losses.push_back(path + ": of materials the modulus and the density are written, at small strain");
  if (mesh_only && !sets.shells.empty()) losses.push_back(path + ": of skins the faces are written, not the thickness");
  if (mesh_only && !sets.ties.empty())
    losses.push_back(path + ": the format holds no ties; the sets of nodes that follow are there");
  if (writer == write_cdb || writer == write_dyna) {
    if (sets.steps.size() > 1 || any_step(Analysis::frequency))
      losses.push_back(path + ": the first static step is written, the others are left out");
    if (any_material_but(MaterialKind::linear))
      losses.push_back(path + ": materials other than linear isotropic ones are written as isotropic at small strain");
    if (!sets.points.empty() || !sets.springs.empty())
      losses.push_back(path + ": rigid points and springs are not written");
    if (sets.has_contact()) losses.push_back(path + ": contact is not written, the surfaces are named only");
    if (writer == write_cdb && !sets.shells.empty()) losses.push_back(path + ": skins are not written");
  }
  return losses;
}

void write_model(AtomicFiles& files, const std::string& path, const SolverModel& model,
                 const MeshWriteOptions& options) {
  const Format& format = volume_format(path, options);
  write_to(files, path, format, prepare_model(model, options, path));
}

}  // namespace stackmesh
