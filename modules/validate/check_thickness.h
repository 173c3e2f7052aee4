#pragma once
#include <cstddef>
#include <vector>

#include "model/complex.h"

namespace stackmesh {

/// How thin a label is, seen along the inward normals of its surface.
struct LabelThickness {
  Label label = 0;         ///< never the background
  double thin_share = 0;   ///< of its area: thickness below `elements` edges of the triangle it is seen from
  double p5_mm = 0;        ///< 95 % of the area are thicker
  Vec3 thinnest;           ///< where it is thinnest, compared with the triangle
  double thinnest_mm = 0;  ///< the thickness there
};

/// How thickness is measured.
struct ThicknessOptions {
  double elements = 2;         ///< thinner than so many edges is thin
  std::size_t samples = 3000;  ///< most triangles a label is seen from, evenly chosen
  int threads = 0;             ///< 0: all of the machine; the result does not depend on it
};

/// A row for each label of a closed complex, ascending. @throws Error(input) as check_surface does.
std::vector<LabelThickness> check_thickness(const InterfaceComplex& complex, const ThicknessOptions& options = {});

}  // namespace stackmesh
