#pragma once
#include <cstdint>

namespace stackmesh {

/// Which diagonal of four labels around a corner is joined, where every two neighbours of them differ.
enum class JoinedDiagonal { none, rising, falling };

/// The one rule for voxels that touch by a corner or an edge only (docs/contours.md): the background joins, so that
/// parts which touch are apart as in 6-connected images; else a label whose two voxels hang together elsewhere joins;
/// of two that could, the rising one.
/// @param l00 label at the lower left of the corner; as the others an index of LabelVolume::labels, 0 the background
/// @param l10 label at the lower right
/// @param l01 label at the upper left
/// @param l11 label at the upper right
/// @param same asked with 0 for the rising diagonal (l00, l11) and 1 for the falling one (l10, l01): one component of
/// the volume?
template <class SameComponent>
JoinedDiagonal joined_diagonal(std::uint16_t l00, std::uint16_t l10, std::uint16_t l01, std::uint16_t l11,
                               SameComponent same) {
  const bool rising = l00 == l11, falling = l10 == l01;
  if (rising && l00 == 0) return JoinedDiagonal::rising;
  if (falling && l10 == 0) return JoinedDiagonal::falling;
  if (rising && same(0)) return JoinedDiagonal::rising;
  if (falling && same(1)) return JoinedDiagonal::falling;
  return JoinedDiagonal::none;
}

}  // namespace stackmesh
