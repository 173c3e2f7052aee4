#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "model/label_volume.h"

namespace stackmesh {

/// Voxels of one label in a row: [begin, end) along the walking axis.
struct LabelRun {
  std::int32_t begin, end;
  std::int32_t label;      ///< index into volume.labels, never 0
  std::int32_t component;  ///< 6-connected component, numbered over all labels
};

/// A label volume as runs along lines. Axis W walks along a line, U steps to the next line of a plane, V (the
/// stacking axis) to the next plane; all in millimetres from the centre of voxel 0 where a point is meant.
struct LabelRuns {
  std::array<int, 3> axis;           ///< W, U, V as axes of the volume
  std::array<int, 3> size;           ///< voxels along W, U, V
  std::array<double, 3> spacing_mm;  ///< along W, U, V
  std::array<Vec3, 3> direction;     ///< of W, U, V in the world
  Vec3 origin_mm;
  std::vector<LabelRun> runs;
  std::vector<std::size_t> start;  ///< line v * size[1] + u has runs [start[line], start[line + 1])
  std::vector<std::int32_t> component_label;

  /// A world point along W, U, V in mm (as x, y, z).
  Vec3 to_grid(const Vec3& world) const {
    const Vec3 d = world - origin_mm;
    return {dot(d, direction[0]), dot(d, direction[1]), dot(d, direction[2])};
  }
  /// And back.
  Vec3 to_world(const Vec3& grid) const {
    return origin_mm + (grid.x * direction[0] + grid.y * direction[1] + grid.z * direction[2]);
  }
  Vec3 place(double w, double u, double v) const { return {w * spacing_mm[0], u * spacing_mm[1], v * spacing_mm[2]}; }
};

LabelRuns find_runs(const LabelVolume& volume, int stack_axis, int threads);

/// A strip of voxel faces of one label, side by side along W, with another label or the border on the other
/// side.
struct FaceStrip {
  std::int32_t begin, end, u, v;  ///< the label's voxels
  std::int8_t axis;               ///< of the normal: 0 W, 1 U, 2 V
  std::int8_t sign;               ///< towards +axis or -axis
};

/// The faces of every label, by index into volume.labels.
std::vector<std::vector<FaceStrip>> find_faces(const LabelRuns& runs, std::size_t labels, int threads);

}  // namespace stackmesh
