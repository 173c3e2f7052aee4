#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "fem/boundary_faces.h"

namespace stackmesh {

/// Faces (indices into a list of BoundaryFace) that belong together.
using Patch = std::vector<std::int32_t>;

struct PatchOptions {
  double sharp_deg = 50;  ///< faces that turn by more at their edge are not of one patch
  /// of its component's area; a smaller patch joins the neighbour with the longest common border
  double least_share = 0.02;
};

/// Splits faces into connected pieces (across edges that exactly two of them share), and those along sharp edges;
/// `wall` faces never join others. Where a quarter of the edges is sharp (a staircase) no edge counts as one.
/// @return patches by descending area, ties by first face
std::vector<Patch> split_at_sharp_edges(const std::vector<BoundaryFace>& all, const Patch& faces,
                                        const std::vector<char>& wall, const PatchOptions& options = {});

/// What is left small because other labels lie all round it (less than a share of all patches' area) joins the patch of
/// the nearest face on the same closed surface of the label; on a piece of its own it stays.
/// @param surface all faces of the label, those to other labels, too
/// @param patches by descending area, of faces to the background
void join_islands(const std::vector<BoundaryFace>& all, const Patch& surface, double least_share,
                  std::vector<Patch>& patches);

/// Faces that lie in one plane at the end of a label along a direction: the flat cap. Empty where the end is round.
/// @param up unit vector; the end is where `dot(up, p)` is largest
Patch flat_cap(const TetMesh& mesh, const std::vector<BoundaryFace>& all, const Patch& faces, Vec3 up);

}  // namespace stackmesh
