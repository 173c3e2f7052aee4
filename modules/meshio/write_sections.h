#pragma once
#include <string>

#include "base/atomic_file.h"
#include "model/stack.h"

namespace stackmesh {

/// True for .json .svg .cnt, in any letter case.
bool is_section_format(const std::string& path);

/// Writes a stack's sections: `.json` (points in mm and edges [a, b, left, right] of each section), `.svg` (a panel
/// per section, labels filled), `.cnt` (closed polygons; several labels give NAME_<label>.cnt each). Coordinates
/// are the stack's own: in-plane x, y and height along the stacking axis, mm; in `.cnt` those of the world (LPS) where
/// the stack's axes are the world's.
/// @throws Error(usage) for another ending, Error(output) when the file cannot be written
void write_sections(AtomicFiles& files, const std::string& path, const Stack& stack);

}  // namespace stackmesh
