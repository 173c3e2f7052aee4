#pragma once
#include "fem/material_law.h"
#include "model/solver_model.h"

namespace stackmesh {

/// What parts that touch do to each other.
struct JoinOptions {
  Contact others = Contact::tie;                  ///< for pairs of parts that no law names
  const std::vector<ContactLaw>* laws = nullptr;  ///< for pairs that they name, before `others`; nullptr: none
  std::string path;                               ///< of the law file, for an error
};

/// Says for each pair of parts that touch what they do to each other, and ties the nodes of those that are tied: at
/// every place one node is followed by those of all parts that are tied to it, if only by way of others, so that
/// nothing is held twice; the one that most axes are supported of is followed, then the first.
///
/// Contact without a stiffness gets 50 E / h, with E the smaller mean modulus of the two sides' elements at the contact
/// and h the mean edge of its faces: at most about 2 % of what a layer of elements gives way by. Precondition:
/// materials are assigned, supports applied.
/// @throws Error(input) for a law that names parts that do not touch, or a pair twice, a tied node held in one step
/// only or bound to a rigid point; Error(usage) for contact without materials
void join_parts(SolverModel& model, const JoinOptions& options);

}  // namespace stackmesh
