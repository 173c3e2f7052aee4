#pragma once
// What is odd with drawn contours, but does not end the run: internal to the module. Labels are known by the index of
// their contour file.
#include <map>
#include <utility>
#include <vector>

#include "base/warning.h"
#include "sections/masked_section.h"

namespace stackmesh {

/// How much of the labels' volumes is drawn for several of them; a section stands for half the way to either neighbour.
struct DrawnOverlaps {
  std::vector<double> volume_mm3;                                    ///< of each label's contours
  std::map<std::pair<std::size_t, std::size_t>, double> shared_mm3;  ///< (a, b), a < b: of both at once
};

/// Labels that have no contour at heights between their first and last one where others have some.
void warn_missing_heights(const std::vector<LabelContours>& files, const std::vector<DrawnLevel>& levels,
                          std::vector<Warning>& warnings);

/// Heights that no label has: told by a label's own gaps, where one is a multiple of its usual gap.
void warn_wide_gaps(const LabelContours& file, std::vector<Warning>& warnings);

/// A label that lies inside another one in most sections, but reaches its outline in some: the other one is open
/// there. @param thickness_mm what each section stands for
void warn_open_walls(const std::vector<LabelContours>& files, const std::vector<MaskedSection>& sections,
                     const std::vector<double>& thickness_mm, const DrawnGrid& grid, std::vector<Warning>& warnings);

/// Which labels lie inside which, and which share how much with which. @param by_rank the label that wins first
void warn_overlaps(const std::vector<LabelContours>& files, const DrawnOverlaps& overlaps,
                   const std::vector<std::size_t>& by_rank, std::vector<Warning>& warnings);

}  // namespace stackmesh
