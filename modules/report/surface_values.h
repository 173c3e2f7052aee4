#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "model/complex.h"
#include "model/solver_model.h"

namespace stackmesh {

/// What a solver model says of a triangle of the surface, as steps of 0 to 255.
struct TriangleValues {
  std::uint8_t set = 0;      ///< 1 + its place in SurfaceValues::sets; 0: in none
  std::uint8_t acts = 0;     ///< bits: 1 held or moved, 2 loaded (in any step)
  std::uint8_t modulus = 0;  ///< 1 to 255 from the smallest to the largest modulus, by ratio; 0: unknown
  std::uint8_t mises = 0;    ///< 1 to 255 from 0 to what 99.5 % of the nodes keep below; 0: unknown
};

/// By what a page colours the surface of a solver model.
struct SurfaceValues {
  std::vector<std::string> sets;  ///< names of face sets, the largest first; at most 250, the largest left out
  double modulus_low_mpa = 0;     ///< smallest Young's modulus of an element; 0: none is known
  double modulus_high_mpa = 0;    ///< largest Young's modulus of an element; 0: none is known
  double mises_high_mpa = 0;      ///< von Mises stress that 99.5 % of the nodes keep below; 0: none is known
  std::vector<std::array<Vec3, 3>> corners;  ///< of every face of a set, sorted
  std::vector<TriangleValues> values;        ///< of each
};

/// What a solver model says of every face of its sets.
/// @param model with its sets; materials that only hold the place give no modulus
/// @param mises_mpa von Mises stress of each node, of a solution; empty: none is known
SurfaceValues surface_values(const SolverModel& model, const std::vector<double>& mises_mpa);

/// The values of each triangle of a surface whose points are the model's; nothing where fewer than half of them are its
/// faces.
std::vector<TriangleValues> values_on(const InterfaceComplex& surface, const SurfaceValues& values);

}  // namespace stackmesh
