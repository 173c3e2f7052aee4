#pragma once
#include "model/label_layer.h"
#include "model/stack.h"

namespace stackmesh {

/// Turns a layer into a section: marching squares for any number of labels. Contours run through the border
/// points between pixel centres; where three or four labels meet in a square of centres they meet in a point
/// inside it. Of two parts that touch by a corner, those of the background join, else those of one part.
/// Then simplified by tolerance_px (of the layer's pixels), so that no contours cross or vanish.
Section layer_section(const LabelLayer& layer, double tolerance_px);

}  // namespace stackmesh
