#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "base/monitor.h"
#include "model/faired_labels.h"
#include "model/label_volume.h"
#include "model/stack.h"

namespace stackmesh {

constexpr std::int32_t kGridPerPixel = 1024;  ///< grid units in a pixel

/// The stacking axis of a volume.
enum class StackAxis { automatic, x, y, z };

/// How contours are traced.
struct ContourOptions {
  StackAxis axis = StackAxis::automatic;  ///< automatic: the coarsest spacing; z when they are equal within 1 %
  double simplify_px = 0.5;               ///< largest deviation of a simplified contour, in pixels; 0 keeps every crack
  double longest_px = 4;    ///< about the longest edge that simplification makes of faired contours, in pixels
  int virtual_per_gap = 0;  ///< slices of the volume that are interpolated between each two real ones
  int threads = 0;          ///< 0: all
};

/// The contours of all slices.
struct ContourResult {
  Stack stack;                      ///< one section a slice, not yet noded
  int axis = 2;                     ///< stacking axis: 0 x, 1 y, 2 z
  std::size_t loops = 0;            ///< closed borders that were traced
  std::size_t vertices_traced = 0;  ///< crack vertices before simplification
  std::size_t vertices = 0;         ///< vertices of the sections
};

/// Turns every slice into a section: the exact pixel-crack contours of all labels as shared arcs
/// (cv::findContours \cite suzuki1985 on the doubled mask, docs/contours.md), simplified by
/// cv::approxPolyDP \cite ramer1972 \cite douglas1973 so that every pixel centre keeps its label and no contours
/// cross. With simplify_px == 0 each label's area in a section is its pixel count, exactly.
/// @param faired where the corners of the contours lie; null: at the corners of the pixels
/// @throws Error(input) for fewer than two slices along the axis or no label at all.
ContourResult extract_sections(const LabelVolume& volume, const ContourOptions& options, Monitor& progress,
                               const FairedLabels* faired = nullptr);

/// The axis that `automatic` stands for: 0, 1 or 2.
int stacking_axis(const LabelVolume& volume, StackAxis axis);

}  // namespace stackmesh
