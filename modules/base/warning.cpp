#include "base/warning.h"

namespace stackmesh {

const char* to_text(WarningCode code) {
  switch (code) {
    case WarningCode::header:
      return "header";
    case WarningCode::values_changed:
      return "values_changed";
    case WarningCode::left_out:
      return "left_out";
    case WarningCode::repeated:
      return "repeated";
    case WarningCode::missing_slices:
      return "missing_slices";
    case WarningCode::missing_contours:
      return "missing_contours";
    case WarningCode::contours_mended:
      return "contours_mended";
    case WarningCode::overlap:
      return "overlap";
    case WarningCode::taken_out:
      return "taken_out";
    case WarningCode::renumbered:
      return "renumbered";
    case WarningCode::mesh_converted:
      return "mesh_converted";
    case WarningCode::frame:
      return "frame";
    case WarningCode::labels_matched:
      return "labels_matched";
    case WarningCode::coarser_grid:
      return "coarser_grid";
    case WarningCode::open_wall:
      return "open_wall";
    case WarningCode::held_to_slices:
      return "held_to_slices";
    case WarningCode::vanished:
      return "vanished";
    case WarningCode::merge_reduced:
      return "merge_reduced";
    case WarningCode::pieces_left_out:
      return "pieces_left_out";
    case WarningCode::piece_not_implied:
      return "piece_not_implied";
    case WarningCode::not_enhanced:
      return "not_enhanced";
    case WarningCode::edge_length:
      return "edge_length";
    case WarningCode::volume_changed:
      return "volume_changed";
    case WarningCode::topology_changed:
      return "topology_changed";
    case WarningCode::not_closed:
      return "not_closed";
    case WarningCode::pieces_lost:
      return "pieces_lost";
    case WarningCode::mesher:
      return "mesher";
    case WarningCode::layers:
      return "layers";
    case WarningCode::flat_elements:
      return "flat_elements";
    case WarningCode::not_conforming:
      return "not_conforming";
    case WarningCode::coincident_nodes:
      return "coincident_nodes";
    case WarningCode::materials:
      return "materials";
    case WarningCode::element_order:
      return "element_order";
    case WarningCode::accuracy:
      return "accuracy";
    case WarningCode::format_loss:
      return "format_loss";
    case WarningCode::file_written:
      return "file_written";
    case WarningCode::other:
      return "other";
  }
  return "other";
}

std::vector<std::string> texts_of(const std::vector<Warning>& warnings) {
  std::vector<std::string> texts;
  for (const Warning& w : warnings) texts.push_back(w.text);
  return texts;
}

}  // namespace stackmesh
