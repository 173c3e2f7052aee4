#pragma once
#include <map>
#include <string>
#include <vector>

#include "base/monitor.h"
#include "base/warning.h"
#include "model/complex.h"
#include "model/stack.h"

namespace stackmesh {

/// How the ends of labels are closed (docs: CONTRACT, --caps).
enum class Caps {
  automatic,  ///< flat or round, by how fast a label ends
  flat,       ///< a plane
  round       ///< a dome
};

/// The same for either end of one label.
struct LabelEndCaps {
  Caps low = Caps::automatic;   ///< at its first section
  Caps high = Caps::automatic;  ///< at its last section
};

/// How sections are stitched.
struct StitchOptions {
  Caps caps = Caps::automatic;               ///< for every label without an entry in label_caps
  std::map<Label, LabelEndCaps> label_caps;  ///< per label
  double flat_area_rel = 0.7;  ///< automatic: flat when the end section keeps this share of its neighbour's area
  double snap_mm = 0;          ///< merge tolerance between neighbouring contours (paper 3.2.1); 0: none
  int threads = 0;             ///< 0: all
};

/// What was chosen for a label's ends: "flat" or "round".
struct LabelCaps {
  std::string low;   ///< at its first section
  std::string high;  ///< at its last section
};

/// The stitched surface, and what was done for it.
struct StitchResult {
  InterfaceComplex complex;  ///< stack coordinates, mm
  /// the sections as they were stitched: snap-rounded, so that edges meet at common end points only
  Stack stack;
  std::size_t added_points = 0;     ///< points that no section has (paper 3.3)
  std::map<Label, LabelCaps> caps;  ///< of each label
  double snap_used_mm = 0;          ///< largest merge tolerance that was applied
  std::vector<Warning> warnings;    ///< what rounding and the merge tolerance changed
};

/// Stitches a stack of sections into the closed complex of all label interfaces
/// (\cite wang2005, section 3; docs/stitching.md). The sections are snap-rounded first. Closed and
/// free of self-intersections for every stack whose sections are partitions of the plane.
/// @throws Error(input) naming section and place where a section is no partition, Error(no_result) when the
/// stack holds no label.
StitchResult stitch_sections(Stack stack, const StitchOptions& options, Monitor& progress);

}  // namespace stackmesh
