#pragma once
#include <memory>
#include <vector>

#include "model/complex.h"
#include "model/label_volume.h"

namespace stackmesh {

/// Voxel centres that the labels of a mesh and those of a volume share.
struct LabelOverlap {
  std::vector<Label> mesh_labels;          ///< ascending, without 0
  std::vector<std::size_t> mesh_centres;   ///< beside them
  std::vector<std::size_t> input_centres;  ///< beside volume.labels
  std::vector<std::size_t> both;           ///< at [mesh label * volume.labels.size() + label of the volume]

  /// 2 * both / (mesh + input) of two labels by index; 0 when both are empty.
  double dice(std::size_t mesh, std::size_t input) const;
  /// The same of all labels of the mesh together against all of the volume.
  double dice_of_all() const;
};

/// Measures how meshes lie in a volume, whatever their labels; for choosing frames and matching labels. The volume must
/// outlive it.
class OverlapMeter {
 public:
  /// `stack_axis` is that of the volume, 0, 1 or 2; 0 threads: all of the machine.
  OverlapMeter(const LabelVolume& volume, int stack_axis, int threads);
  ~OverlapMeter();
  /// `frame` takes the mesh's points to the volume's world. Looks at every k-th slice, so that about `slices` are seen
  /// (0: all).
  LabelOverlap measure(const InterfaceComplex& complex, const Frame& frame = {}, int slices = 0) const;

 private:
  struct Grid;
  std::unique_ptr<Grid> grid_;
};

}  // namespace stackmesh
