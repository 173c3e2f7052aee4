#pragma once
#include <optional>
#include <string>
#include <vector>

#include "base/warning.h"
#include "model/complex.h"
#include "model/label_volume.h"

namespace stackmesh {

/// Which pieces of each label are meshed: by default all.
struct PieceOptions {
  std::optional<int> keep_largest;      ///< so many of each label, the largest
  std::optional<double> min_piece_mm3;  ///< and none below that
  /// Whether a piece may be left out.
  bool any() const { return keep_largest || min_piece_mm3; }
};

/// Makes background of the pieces (6-connected voxels of one label) that the options leave out. What was left out is
/// told in `warnings`, a line a label. A label stays in the list with no voxel.
void keep_pieces(LabelVolume& volume, const PieceOptions& options, std::vector<Warning>& warnings);

/// The same for a stitched complex: a piece is a closed part of a label, with the holes in it.
void keep_pieces(InterfaceComplex& complex, const PieceOptions& options, std::vector<Warning>& warnings);

}  // namespace stackmesh
