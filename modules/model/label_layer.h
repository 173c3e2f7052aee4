#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "model/geometry.h"

namespace stackmesh {

/// A raster of parts (connected pieces of labels) at one height that also knows where, between two neighbouring
/// pixel centres, their border runs. The outermost pixels are background.
struct LabelLayer {
  double z_mm = 0;                            ///< height in the stack
  double x0 = 0;                              ///< centre of pixel (0, 0), in grid units of the stack
  double y0 = 0;                              ///< likewise
  std::array<std::int32_t, 2> unit = {1, 1};  ///< pixel along x and y, in grid units
  int width = 0;                              ///< pixels along x
  int height = 0;                             ///< pixels along y
  std::vector<std::int32_t> part;             ///< per pixel; 0: background
  std::vector<Label> label;                   ///< of a part; [0] is 0
  std::vector<float> right;  ///< where the border to the next pixel along x lies, as a share of the way in (0, 1)
  std::vector<float> up;     ///< the same along y

  /// The label of a pixel within the raster.
  Label label_at(int x, int y) const { return label[part[static_cast<std::size_t>(y) * width + x]]; }
};

}  // namespace stackmesh
