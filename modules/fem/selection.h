#pragma once
#include <functional>
#include <string>
#include <vector>

#include "fem/boundary_faces.h"

namespace stackmesh {

/// What a selection may refer to.
struct SelectionContext {
  const TetMesh& mesh;                     ///< in whose space and mm the coordinates are
  const std::vector<BoundaryFace>& faces;  ///< of that mesh, as boundary_faces() gives them; results are places in it
  const std::vector<LabelInfo>& labels;    ///< numbers and names
  std::function<const std::vector<std::int32_t>*(const std::string&)> set;  ///< faces of a named set; none: nullptr
  std::function<std::vector<std::string>()> set_names;                      ///< of all sets, for an error
  std::function<std::string(std::int32_t)> place_of;                        ///< names where a face lies, for an error
};

/// Faces that meet every criterion of `NAME=CRITERION[&CRITERION...]`:
/// `box:x0,y0,z0,x1,y1,z1` and `sphere:x,y,z,r` by the face's centre; `plane:x,y,z,nx,ny,nz[,tolerance]` by all three
/// corners; `normal:nx,ny,nz,degrees` by the outward normal; `points:FILE.mrk.json,r` within r of a control point of a
/// Slicer markups file; `of:LABEL` faces of that label's elements; `in:SET` faces of a set. mm, in the space of the
/// mesh, into which control points are turned. Without `of:` or `in:` every outer face counts, and each interface once,
/// from the side of the smaller label.
/// @return the name and indices into context.faces, ascending
/// @throws Error(usage) for a text that is no selection, Error(input) for none selected (naming the nearest candidate),
/// a label or set that is not there, a markups file that cannot be read
std::pair<std::string, std::vector<std::int32_t>> select_faces(const std::string& text,
                                                               const SelectionContext& context);

/// Reads a selection as select_faces() does, before there are faces; the sets that it names are not looked for.
/// @param text as for select_faces(): NAME=CRITERION[&CRITERION...]
/// @param labels numbers and names, as solvers have them
void check_selection(const std::string& text, const std::vector<LabelInfo>& labels);

}  // namespace stackmesh
