#pragma once
#include <map>
#include <string>

#include "model/complex.h"
#include "model/layers.h"

namespace stackmesh {

/// @throws Error(usage) where one of the labels has no outer faces
void check_outer_faces(const InterfaceComplex& complex, const std::map<Label, LayerSize>& layers);

/// "label 5: the layer ..." for a warning; empty where the layer is whole.
std::string layer_warning(const LayerFigures& figures);

}  // namespace stackmesh
