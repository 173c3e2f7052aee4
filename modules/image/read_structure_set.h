#pragma once
#include <string>
#include <vector>

#include "base/warning.h"
#include "model/contours.h"

namespace stackmesh {

/// The structures of a DICOM RTSTRUCT file.
struct StructureSet {
  std::vector<LabelContours> structures;  ///< those requested, in the order asked (else the file's), each with contours
  Frame frame;                            ///< plane coordinates and height to LPS
  std::vector<Warning> warnings;          ///< what was left out, closed, renumbered or otherwise mended
};

/// Reads the closed planar contours of the structures that `labels` names ("Heart,Lt_Lung"; empty: all) (open ones are
/// closed, points and curves that are no outline left out, each with a warning). Contours may lie in any family of
/// parallel planes; heights within 0.01 mm are one section. A structure's label is its ROI number, its name and colour
/// are kept; nothing else of the file is.
/// @throws Error(input) naming file, structure and contour; where a structure that was requested has no contour;
/// Error(usage).
StructureSet read_structure_set(const std::string& path, const std::string& labels = "");

}  // namespace stackmesh
