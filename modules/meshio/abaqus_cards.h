#pragma once
// Parts of an Abaqus and CalculiX deck.
#include <cstdint>
#include <string>
#include <vector>

#include "meshio/output_buffer.h"
#include "meshio/prepared_mesh.h"

namespace stackmesh {

/// Numbers counted from 0, written from 1, 16 a line.
void abaqus_list(OutputBuffer& out, const std::vector<std::int32_t>& from_zero);

/// Materials, with an element set each where a label has several, orientations, and sections.
void abaqus_materials(OutputBuffer& out, const PreparedMesh& mesh, const std::vector<std::string>& label_sets,
                      UniqueNames& element_sets);

/// Rigid points as kinematic couplings; springs to the ground. `number` is the last element's, and goes on.
void abaqus_points_and_springs(OutputBuffer& out, const PreparedMesh& mesh, std::size_t& number);

/// The steps, each with all that acts in it.
void abaqus_steps(OutputBuffer& out, const PreparedMesh& mesh);

}  // namespace stackmesh
