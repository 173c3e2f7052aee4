#pragma once
#include <string>

#include "fem/material_law.h"
#include "model/solver_model.h"

namespace stackmesh {

/// Gives elements the same axes.
void lay_axes(const std::array<Vec3, 2>& axes, const std::vector<std::int32_t>& tets, SolverSets& sets);

/// Gives each element of a label a fibre by the rule, and across it a direction in the wall's own layer (the third axis
/// goes through the wall). Laplace's equation is solved with linear elements on the label's tets, by conjugate
/// gradients. With t the gradient's direction, l the part of `along` across it and c = l x t, the fibre is cos(angle) c
/// + sin(angle) l.
/// @return elements in which the gradient goes along `along`, or nowhere: their fibre has any direction across it
/// @throws Error(input) for a set that is not there, or does not reach the label, or sets that share all their nodes
std::size_t lay_fibres(SolverModel& model, Label label, const FibreRule& rule, const std::string& where);

}  // namespace stackmesh
