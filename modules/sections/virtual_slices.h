#pragma once
#include <optional>

#include "model/label_volume.h"

namespace stackmesh {

/// How slices are interpolated.
struct InterpolateOptions {
  /// Virtual slices in each gap. Unset: as many as make the gap about one pixel (the smaller in-plane
  /// spacing), where it is above 1.5 pixels. 0: none.
  std::optional<int> per_gap;
  double tension = 0.25;  ///< of the cardinal spline over four slices, in [0, 1]; 0.5 is Catmull-Rom
  int threads = 0;        ///< 0: all
};

/// A volume with virtual slices.
struct InterpolatedVolume {
  LabelVolume volume;  ///< slice k of the input is slice k * (per_gap + 1), pixel by pixel
  int per_gap = 0;     ///< virtual slices in each gap
};

/// How many virtual slices each gap gets along the axis (0 x, 1 y, 2 z). @throws Error(usage) as
/// add_virtual_slices
int virtual_slices_per_gap(const LabelVolume& volume, int stacking_axis, const InterpolateOptions& options);

/// Puts virtual slices between the slices along an axis (0 x, 1 y, 2 z), so that walls bend smoothly across
/// slices (\cite raya1990; docs/interpolate.md): per connected part of a label the signed
/// distance to its border in each slice, a cardinal spline over four slices, the largest wins. The
/// 6-connected components of the labels are exactly those of the input: none is lost, joined, split or added.
/// The order of the labels' numbers plays no part but in exact ties of labels that neither neighbouring slice
/// holds at the pixel.
/// @throws Error(usage) for a negative or huge per_gap, a tension outside [0, 1] or an axis that is none.
InterpolatedVolume add_virtual_slices(const LabelVolume& volume, int stacking_axis, const InterpolateOptions& options);

}  // namespace stackmesh
