#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "sections/islands.h"

namespace stackmesh::interpolate {

/// A value for each pixel of a box.
struct Field {
  Box box;
  std::vector<float> value;
  float at(int x, int y) const { return value[static_cast<std::size_t>(y - box.y0) * box.width() + (x - box.x0)]; }
};

/// A set of pixels of a box; 255: in the set, else 0.
struct Mask {
  Box box;
  std::vector<std::uint8_t> in;
};

/// For each pixel of `box` the distance (mm) to the mask's border, positive inside: exact between pixel
/// centres (cv::distanceTransform, or \cite felzenszwalb2012 where pixels are not square), less
/// half a pixel, so that the zero lies on the cracks. Pixels outside mask.box do not count, as unknown;
/// distances are cut at limit_mm. `box` lies within mask.box.
Field signed_distance(const Mask& mask, const Box& box, const std::array<double, 2>& pixel_mm, double limit_mm);

/// The same from exact contours: the sign is the mask's, the distance that to the nearest of the pieces (each
/// pixel takes over its neighbours' nearest pieces in four sweeps, as in \cite danielsson1980).
Field signed_distance(const Mask& mask, const std::vector<BorderPiece>& border, const Box& box,
                      const std::array<double, 2>& pixel_mm, double limit_mm);

}  // namespace stackmesh::interpolate
