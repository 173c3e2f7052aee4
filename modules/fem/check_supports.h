#pragma once
#include <string>
#include <vector>

#include "model/solver_model.h"

namespace stackmesh {

/// A body of a model: tets that share faces.
struct Body {
  Label label = 0;        ///< of the largest part of it
  std::string name;       ///< of that label
  std::size_t tets = 0;   ///< its elements, wedges and pyramids included
  double volume_mm3 = 0;  ///< of its elements, taken as straight-sided
  Vec3 centre;            ///< of its volume, mm, in the space of the mesh
};

/// The bodies of a model, the largest first. Parts have nodes of their own, so each has bodies of its own.
std::vector<Body> bodies_of(const SolverModel& model);

/// Looks in every static step whether each body is kept from moving as a whole: by supports of its nodes, springs,
/// points, nodes that it shares with other bodies, ties, and contact (across the faces; with friction along them too).
/// What counts is the rank of all these together, body by body as a rigid one.
/// @throws Error(input) for bodies that can still move: how many, and of the largest of them (those that bear a load
/// first) label, size, place, the way in which it can move
void check_supports(const SolverModel& model, const std::string& path);

}  // namespace stackmesh
