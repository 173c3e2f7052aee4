#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "model/geometry.h"
#include "model/label_volume.h"

namespace stackmesh {

/// A vertex of a section, in units of the stack's grid (exact integers; |x|, |y| <= 2^29).
struct GridPoint {
  std::int32_t x = 0;  ///< times Stack::grid_x_mm: stack coordinate
  std::int32_t y = 0;  ///< times Stack::grid_y_mm: stack coordinate
};
inline bool operator==(GridPoint a, GridPoint b) {
  return a.x == b.x && a.y == b.y;
}
inline bool operator!=(GridPoint a, GridPoint b) {
  return !(a == b);
}
inline bool operator<(GridPoint a, GridPoint b) {
  return a.x < b.x || (a.x == b.x && a.y < b.y);
}

/// A straight contour edge from points[a] to points[b], with the label on either side (x right, y up).
struct SectionEdge {
  std::int32_t a = 0;  ///< where it begins: index of Section::points
  std::int32_t b = 0;  ///< where it ends
  Label left = 0;      ///< on the left of who looks from a to b
  Label right = 0;     ///< on the right; never equal to `left`
};

/// A section: a planar partition of the plane z = z_mm into labels, given by its edges. Around every face the
/// labels of the edges agree; outside of everything is the background. Once noded (see planar/snap_rounding.h),
/// edges meet at common end points only.
struct Section {
  double z_mm = 0;                 ///< height along the stacking axis
  bool interpolated = false;       ///< between real slices, not one of them
  std::vector<GridPoint> points;   ///< vertices of its contours
  std::vector<SectionEdge> edges;  ///< each once, in any order
};

/// How a drawn label ends: told by its own contours, whatever other labels are in the stack.
struct DrawnEnd {
  double contour_mm = 0;   ///< height of its first or last drawn contour
  double half_gap_mm = 0;  ///< half of its own gap there
  /// of that contour, as a share of the next one's (what lies inside counts as the label); 0: there is one contour
  double area_rel = 0;
  bool flat = false;        ///< as the sections were made for; the stitcher decides by its own options
  bool on_section = false;  ///< a flat end lies on the label's last section itself, not half a gap beyond it
  double last_mm = 0;       ///< height of that section: interpolated ones may follow the last contour
};
/// Both ends of a drawn label.
struct DrawnEnds {
  Label label = 0;  ///< whose they are
  DrawnEnd low;     ///< at its first contour
  DrawnEnd high;    ///< at its last contour
};

/// Sections in ascending z, on one in-plane grid, and what they stand for.
struct Stack {
  double grid_x_mm = 1;  ///< size of a grid unit along x
  double grid_y_mm = 1;  ///< size of a grid unit along y
  /// in-plane pixel (the smaller side); for drawn contours their detail (sections/drawn_detail.h)
  double pixel_mm = 1;
  /// true: a section stands for a slice that reaches half a gap to either side; false: plane cuts
  bool slices = true;
  double end_gap_mm = 0;          ///< gap that the first and last section stand for; 0: the gap to the next real one
  std::vector<Section> sections;  ///< ascending z, virtual ones among them
  std::vector<LabelInfo> labels;  ///< labels[0] is the background
  Frame frame;                    ///< stack coordinates (mm) to world
  /// labels whose first section lies on the image's own border: empty if unknown
  std::vector<Label> touches_low;
  std::vector<Label> touches_high;    ///< the same at the last section
  std::vector<DrawnEnds> drawn_ends;  ///< drawn contours only: an entry per label
};

/// Signed area (mm2) of a label in a section: the sum over its edges; exact before simplification.
double label_area_mm2(const Stack& stack, const Section& section, Label label);

/// Area (mm2) within a label's outer loops in a section: what lies in its holes counts as the label.
double enclosed_area_mm2(const Stack& stack, const Section& section, Label label);

/// The half gap that the first (low) or last section stands for beyond itself, mm; the pixel if there is one section
/// only.
double end_half_gap_mm(const Stack& stack, bool high);

}  // namespace stackmesh
