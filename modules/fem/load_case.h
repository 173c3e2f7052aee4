#pragma once
#include "fem/material_law.h"
#include "model/solver_model.h"

namespace stackmesh {

/// Turns a load case's sets into supports and forces on nodes: a force is spread as a uniform traction over the faces of its
/// set, a pressure along their inward normals, both by the elements' own shape functions (so second-order faces get their mid-side
/// shares).
/// @throws Error(input) for a set that is not there, or has no faces to load, or nodes held to two different displacements
void apply_load_case(SolverModel& model, const LoadCase& load_case, const std::string& path);

}  // namespace stackmesh
