#pragma once
#include <string>
#include <vector>

#include "base/warning.h"
#include "model/stack.h"

namespace stackmesh {

/// Draws vertices of each section onto those, then onto the edges, of the section beneath that lie within
/// `tolerance_mm` (\cite wang2005, 3.2.1). Each section is a transaction: the moved section must still be a
/// partition with the same contours (exact test), else it is tried with half the tolerance, finally not at all.
/// Returns the largest tolerance that was applied; what had to be reduced is told in `warnings`.
double merge_close_contours(Stack& stack, double tolerance_mm, int threads, std::vector<Warning>& warnings);

}  // namespace stackmesh
