#pragma once
#include <set>
#include <string>
#include <vector>

#include "base/warning.h"
#include "model/contours.h"
#include "model/stack.h"
#include "stitch/stitch.h"

namespace stackmesh {

/// How drawn contours become sections.
struct ContourStackOptions {
  /// a contour stands for a slice, which reaches half a gap to either side; false: a plane cut
  bool slices = false;
  /// contours of heights that are at most so far apart are one section; those of different labels up to 3 % of the
  /// smallest usual gap, too
  double same_height_mm = 1e-3;
  /// how labels end, as it will be stitched: where other labels go on, ends are made contours
  Caps caps = Caps::automatic;
  std::map<Label, LabelEndCaps> label_caps;  ///< the same for some labels
  bool first_wins = false;                   ///< where labels overlap: the one given first; false: the smaller one
  bool report_overlaps = false;              ///< a warning says how much labels overlap, and who got it
  /// heights that a label lacks between its own get contours made from their neighbours
  bool fill_missing = false;
  bool repair = false;         ///< contours of one label that cross are united where even-odd says nearly the same
  bool merge = false;          ///< all contours become one label, numbered as the smallest
  std::set<Label> not_merged;  ///< but for these
  Frame frame;                 ///< plane coordinates and height of the contours to the world
};

/// Makes sections out of contour polygons: a constrained triangulation of each section's polygons, regions
/// grown in it, and nesting by region (\cite wang2005, 3.1); an edge walked twice (the bridge of a keyhole contour)
/// counts as none; contours drawn twice, or nearly so, count once, with a warning (sections/contour_copies.h). A label
/// ends half its own gap beyond its last contour (plane cuts: on it, or as a dome), whatever the heights of the others
/// (sections/drawn_ends.h). Orientation of the input is free. The grid is a power of two mm, about 1e-5 of the box.
/// @throws Error(input) naming file, section and contour where contours of one label cross themselves or each
/// other, where labels share a number, or where fewer than two sections hold contours.
Stack sections_from_contours(const std::vector<LabelContours>& files, std::vector<Warning>& warnings,
                             const ContourStackOptions& options = {});

}  // namespace stackmesh
