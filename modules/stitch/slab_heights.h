#pragma once
// How high the sheets of a slab run: internal to the module.
#include "stitch/slab_sheets.h"

namespace stackmesh {

/// Gives every copy its height, in gaps above the lower section (0 to 1). On a rim: the section, or between both where
/// both meet; inside: equation (1) of \cite wang2005, with distances to the sheet's own rim, in the plane's metric.
/// Heights are such that a sheet divides the gap in halves on average, and a round end holds
/// SlabInput::round_holds_rel of it (docs/stitching.md).
void place_heights(const SlabInput& input, SlabPlane& plane);

}  // namespace stackmesh
