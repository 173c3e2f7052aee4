#pragma once
#include <optional>
#include <string>
#include <vector>

#include "base/monitor.h"
#include "base/warning.h"
#include "model/complex.h"
#include "model/label_volume.h"
#include "sections/extract.h"

namespace stackmesh {

/// How a label volume becomes sections.
struct SectionOptions {
  ContourOptions contours;              ///< axis and threads; the rest is chosen by volume_sections
  std::optional<double> simplify_px;    ///< unset: 0.05 of faired contours, 0.5 of those along the pixels
  std::optional<int> virtual_sections;  ///< per gap; unset: as many as make it about a pixel
  bool faired_surface = false;          ///< also give the faired interfaces as a whole
  bool as_stored = false;               ///< labels that are stored finer than they were made stay as they are stored
  bool band_asked = false;              ///< the user chose band_px
  double band_px = 0.5;                 ///< fairing (FairOptions); 0: contours along the pixels
};

/// The sections of a label volume.
struct VolumeSections {
  ContourResult contours;         ///< the sections, and how they were traced
  std::vector<Warning> warnings;  ///< where smooth sections keep closer to the slices
  InterfaceComplex faired;        ///< the faired interfaces as a whole, in stack coordinates; empty without fairing
};

/// @param name what the error calls the volume @throws Error(input) for fewer than two slices along the stacking axis
void check_slices(const LabelVolume& volume, StackAxis axis, const std::string& name);

/// A label volume to its sections: virtual slices between far ones, interfaces faired, contours traced and simplified.
VolumeSections volume_sections(const LabelVolume& volume, const SectionOptions& options, Monitor& progress);

}  // namespace stackmesh
