#pragma once
#include <optional>

#include "base/progress.h"
#include "contour/extract.h"
#include "model/label_volume.h"

namespace stackmesh {

struct SectionOptions {
  ContourOptions contours;              ///< axis and threads; the rest is chosen by volume_sections
  std::optional<double> simplify_px;    ///< unset: 0.05 of faired contours, 0.5 of those along the pixels
  std::optional<int> virtual_sections;  ///< per gap; unset: as many as make it about a pixel
  double band_px = 0.5;                 ///< fairing (FairOptions); 0: contours along the pixels
};

/// A label volume to its sections: virtual slices between far ones, interfaces faired, contours traced and simplified.
ContourResult volume_sections(const LabelVolume& volume, const SectionOptions& options, Progress& progress);

}  // namespace stackmesh
