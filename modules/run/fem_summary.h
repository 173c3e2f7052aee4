#pragma once
// A solver model in figures, for the report: internal to the module.
#include <string>
#include <vector>

#include "fem/assign_materials.h"
#include "model/solver_model.h"
#include "report/run_report.h"

namespace stackmesh {

/// The model's sets, materials, bodies and steps. @param image, materials_path as the user named them; empty: none
FemReport summary_of(const SolverModel& model, const MaterialReport& materials, const std::string& image,
                     const std::string& materials_path);

/// Von Mises stress at the model's nodes, MPa, out of a result of CalculiX (.frd) for this very model; 0 where the
/// result has none. @throws Error(input) where the result has no stress, or its nodes lie elsewhere
std::vector<double> mises_of(const SolverModel& model, const std::string& result_path);

}  // namespace stackmesh
