#pragma once
#include <map>
#include <string>

#include "cohort/collect.h"
#include "model/complex.h"

namespace stackmesh {

/// A small picture of a mesh file's outer surface, in the colours of its labels, as a PNG: seen from the front, a
/// little from the right and from above (LPS; without anatomy: along y), fitted into the frame. Drawn here, by a depth
/// buffer; the bytes depend on the mesh only.
/// @throws Error(input) where the file cannot be read
std::string draw_thumbnail(const std::string& mesh_path, const std::map<int, CohortLabel>& labels);

/// The same of a surface.
std::string draw_thumbnail(const InterfaceComplex& surface, const std::map<int, CohortLabel>& labels);

}  // namespace stackmesh
