#pragma once
#include <string>
#include <vector>

#include "base/atomic_file.h"
#include "model/complex.h"
#include "model/label_volume.h"
#include "model/solver_model.h"
#include "model/tet_mesh.h"

namespace stackmesh {

/// In which form a mesh is written.
struct MeshWriteOptions {
  bool per_label = false;         ///< surfaces: NAME_<label>.EXT for each label, closed on its own, outward
  bool msh2 = false;              ///< .msh as Gmsh 2.2 instead of 4.1
  std::vector<LabelInfo> labels;  ///< names for sets and physical groups; a label without one is label_<n>
};

/// True for .stl .ply .obj .off .vtp, in any letter case.
bool is_surface_format(const std::string& path);
/// True for .vtu .msh .inp .feb .bdf .cdb .k .exo .med .vtk .mesh, in any letter case.
bool is_volume_format(const std::string& path);
/// Asks before a long run whether the path's format can be written: .exo and .med have their writers in a part of their
/// own (base/installed_part.h).
/// @throws Error(no_result) where that part is absent; any other ending passes
void require_writer(const std::string& path);
/// The endings of surface formats in one line, for messages.
std::string surface_endings();
/// The endings of volume formats in one line, for messages.
std::string volume_endings();

/// Writes the interfaces, in mm as they are, to one file (or one per label), in the format of its ending.
/// Each interface stands in the file once. Its normal points from the label to the background, or from the
/// smaller label to the larger one; label_below and label_above of .ply and .vtp follow that winding. With
/// per_label the normal points out of the file's label, which is label_below. Triangles come grouped by label
/// pair; points that no triangle uses are left out. The space of what is written, where it is LPS or RAS, becomes a
/// mark in the file (SPACE=LPS). The caller commits `files`.
/// @throws Error(usage) for another ending, Error(output) when the file cannot be written, Error(no_result)
/// when there is no triangle, Error(internal) for an index out of range or a coordinate that is not finite.
void write_surface(AtomicFiles& files, const std::string& path, const InterfaceComplex& surface,
                   const MeshWriteOptions& options = {});

/// Writes the tets and their interface triangles, in mm as they are, in the format of the path's ending.
/// Tets come grouped by ascending label, else in the mesh's order, and points that no tet uses are left out,
/// so that element and node n are the same in every format. The interface triangles are oriented as by
/// write_surface(). The caller commits `files`. @throws as write_surface(); Error(internal) too when a .inp
/// is requested and an interface triangle is not a face of a tet of each of its labels (one that no tet has is a void);
/// Error(output) for a label that Gmsh cannot number.
void write_volume(AtomicFiles& files, const std::string& path, const TetMesh& mesh,
                  const MeshWriteOptions& options = {});

/// What the format of a path's ending cannot carry of a model, a sentence each; empty: nothing is lost.
std::vector<std::string> losses_of(const std::string& path, const SolverModel& model);

/// Writes a solver model, in mm as it is, in the volume format of the path's ending: sets, materials and load case in
/// the decks
/// (.inp .feb .bdf), named surfaces as physical groups in .msh, modulus, density and quality per cell in .vtu and .vtk.
/// Elements and nodes have the same numbers in every format. The caller commits `files`. @throws as write_volume();
/// Error(internal) for a model whose tets are not grouped by label, or which has unused points.
void write_model(AtomicFiles& files, const std::string& path, const SolverModel& model,
                 const MeshWriteOptions& options = {});

}  // namespace stackmesh
