#pragma once
#include "fem/material_law.h"
#include "model/solver_model.h"

namespace stackmesh {

/// Turns a load case by names of sets into steps of a solver model. A force is spread as an even traction over the
/// faces of its set, a moment as one that rises linearly from their centre, both by the elements' own shape functions
/// (so second-order faces get their mid-side shares); a pressure stays one on the faces, so that solvers let it follow
/// them. Rigid points and springs to the ground become the model's.
/// @throws Error(input) for a set that is not there, or has no faces to load, nodes held to two different
/// displacements, or bound to two points, or bound and held
void apply_load_case(SolverModel& model, const LoadCase& load_case, const std::string& path);

/// The force that a pressure is in all, on the faces as they lie.
Vec3 force_of(const SolverModel& model, const Pressure& pressure);

}  // namespace stackmesh
