#pragma once
// How TetGen is called: internal to the module.
#include <optional>
#include <string>
#include <vector>

#include "model/complex.h"
#include "volume/compact.h"
#include "volume/fill_volume.h"

namespace stackmesh::volume {

/// One way to call TetGen.
struct TetgenCall {
  bool refine = false;    ///< points are added inside, for the sizes and angles of the options
  std::string tolerance;  ///< "" (TetGen's 1e-8 of the box) or "T1e-12"
  double z_scale = 1;     ///< the surface's z times this, a power of two and so exact
  int turns = 0;          ///< of the axes, x -> y -> z -> x: exact, and TetGen takes another way
};

/// Ten significant digits.
std::string number(double v);

/// The power of two that brings an extreme aspect (steps along z against edges in the plane) back to about 1;
/// 1 when it is within 1/16 .. 16.
double z_scale_for_aspect(const InterfaceComplex& complex);

/// The axes moved on that often: x takes the place of z, y that of x, z that of y.
Vec3 turned(Vec3 p, int turns);

/// TetGen's command line switches. @param max_volume_mm3 of the labels that are filled; unset: no bound
std::string switches(const TetgenCall& call, const FillOptions& options, const std::optional<double>& max_volume_mm3);

/// Whether the call gets an edge length for each point.
bool has_sizes(const TetgenCall& call, const FillOptions& options, const std::optional<double>& max_volume_mm3);

/// The edge length wanted at each point, mm, for tets inside: the mean of the surface's edges there, grown. TetGen's
/// edges come out longer than requested by a factor, which is taken off.
std::vector<double> inner_sizes(const Compact& part, double growth);

/// The call in words, for messages.
std::string describe(const TetgenCall& call, const std::string& switches);

}  // namespace stackmesh::volume
