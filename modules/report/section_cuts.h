#pragma once
#include <string>
#include <vector>

#include "model/complex.h"
#include "model/label_volume.h"
#include "model/stack.h"
#include "report/label_index.h"

namespace stackmesh {

/// How plane curves are drawn: rounded to multiples of `unit_mm`, and true to `tolerance_mm`.
struct CurveDrawing {
  double unit_mm = 0.01, tolerance_mm = 0;
  int threads = 0;
};

/// The cut of the whole complex with each plane z = height (ascending) of the frame's stack coordinates: packed
/// polylines (polylines.h) per plane. A vertex on a plane counts as above it, so a flat face in the plane gives
/// the cut just beneath it.
std::vector<std::string> cut_complex(const InterfaceComplex& complex, const Frame& frame,
                                     const std::vector<double>& heights, const LabelIndex& index,
                                     const CurveDrawing& drawing);

/// The edges of a contour section as packed polylines.
std::string draw_section(const Stack& stack, const Section& section, const LabelIndex& index,
                         const CurveDrawing& drawing);

/// A window of in-plane pixels: [x, x + width) by [y, y + height).
struct PixelWindow {
  int x = 0, y = 0, width = 0, height = 0;
};

/// The smallest window that holds every non-zero pixel, and one more on each side where the image has it.
PixelWindow window_of_labels(const LabelVolume& volume, int stack_axis);

/// Every slice of the window along the stacking axis as runs: (label's index, length) in rows of x.
std::vector<std::string> pack_slices(const LabelVolume& volume, int stack_axis, const PixelWindow& window,
                                     const LabelIndex& index, int threads);

}  // namespace stackmesh
