#pragma once
#include <string>
#include <vector>

namespace stackmesh {

/// What a warning is about: for programs, which should not read its text.
enum class WarningCode {
  // Reading
  header,          ///< a file's header says too little, or what cannot be; what is taken instead is said
  values_changed,  ///< stored numbers were rounded, cut or replaced
  left_out,        ///< a part of the input is not used
  repeated,        ///< slices, contours or points that are there twice
  missing_slices,
  missing_contours,
  contours_mended,  ///< open ones closed, crossing ones united
  overlap,          ///< two labels at one place: which got it
  taken_out,        ///< a label inside another one is taken out of it
  renumbered,       ///< labels whose numbers are not those of the file
  mesh_converted,   ///< cells or points of a mesh file that are not taken as they are
  frame,            ///< where the mesh lies is not sure
  labels_matched,   ///< which labels of a mesh are judged, and as which
  // Labels to the surface
  coarser_grid,       ///< labels that are stored finer than they were made
  open_wall,          ///< a wall that is open between two sections
  held_to_slices,     ///< smooth sections that keep closer to the slices than elsewhere
  vanished,           ///< contours thinner than the grid
  merge_reduced,      ///< --snap was reduced
  pieces_left_out,    ///< as options ask
  piece_not_implied,  ///< a piece that no section shows
  not_enhanced,       ///< a surface that is not as fine as it was to be
  edge_length,        ///< an edge length that is not the requested or the usual one
  volume_changed,
  topology_changed,  ///< Euler number or pieces
  not_closed,
  pieces_lost,  ///< components of the input are missing, or are joined
  // Tetrahedra and solver models
  mesher,  ///< the volume mesher was started again, or fell back
  layers,
  flat_elements,
  not_conforming,
  coincident_nodes,
  materials,      ///< a material that is not what it could be
  element_order,  ///< mid-side nodes are missing or left out
  accuracy,
  // Files
  format_loss,   ///< what a format cannot carry
  file_written,  ///< a file that was not requested, and what is in it
  other
};

/// As reports write it, such as "missing_slices".
const char* to_text(WarningCode code);

/// Something odd that did not end the run.
struct Warning {
  WarningCode code = WarningCode::other;  ///< what it is about
  std::string where;                      ///< file, label or section; "": the whole input or mesh
  std::string text;                       ///< a sentence for people; it names the place
};

/// A warning that reads "WHERE: WHAT".
inline Warning warning_at(WarningCode code, const std::string& where, const std::string& what) {
  return {code, where, where + ": " + what};
}

std::vector<std::string> texts_of(const std::vector<Warning>& warnings);

}  // namespace stackmesh
