#pragma once
#include <vector>

#include "enhance/smoothing.h"

namespace stackmesh {

/// Where sheets come too near, moves them apart: to `gap_rel` of the edge length requested (`size`, mm) between
/// triangles without a common corner, to the sheet angle of `keep` between those with a common edge. Each vertex moves
/// by at most that gap in all; flat caps stay plane. Guarded as smoothing is.
SmoothingResult separate_sheets(ComplexMesh& mesh, const std::vector<double>& size, double gap_rel,
                                const MoveLimits& keep, int threads);

}  // namespace stackmesh
