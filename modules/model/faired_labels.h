#pragma once
#include <cstdint>
#include <vector>

#include "model/complex.h"

namespace stackmesh {

/// Where the interfaces of a label volume run between its voxel centres, as fairing found them: what contours and
/// sheets follow instead of the faces of the voxels. Axes are those of the stack (in-plane x, y; slices along z).
struct FairedLabels {
  /// A contour's vertex: the pixel corner that it stands for, and how far it lies from there, in pixels.
  struct Corner {
    /// Which contour at the corner it is of.
    enum Part : std::uint8_t {
      whole,  ///< the only one
      south,  ///< of two, that around the pixel with the smaller y
      north   ///< the other one
    };
    std::int32_t x;  ///< of the pixel corner, along x
    std::int32_t y;  ///< of the pixel corner, along y
    /// of two contours that pass one corner, the one around the pixel with the smaller y is the southern one
    Part part;
    float dx;  ///< from there along x, pixels
    float dy;  ///< from there along y, pixels
  };
  /// of each slice, ascending (y, x, part); corners that are absent stay where they are
  std::vector<std::vector<Corner>> slices;
  /// of each slice: corners may be further than half a pixel from where they were, so that pixel centres change label
  std::vector<char> free;
  /// the interfaces as a whole, in stack coordinates (mm); open at the image's border, and not free of intersections
  InterfaceComplex surface;
};

}  // namespace stackmesh
