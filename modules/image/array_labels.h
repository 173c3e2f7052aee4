#pragma once
#include <array>
#include <optional>
#include <string>

#include "image/voxel_data.h"
#include "model/label_volume.h"

namespace stackmesh {

/// Label numbers in memory as a volume of voxels of 1 mm without anatomy, by the rules of files: whole numbers from 0
/// (also as floats), one label or more. @param values size[0] * size[1] * size[2] of that type, x fastest @param name
/// what errors call them @throws Error(input)
LabelVolume labels_of_array(const void* values, VoxelType type, const std::array<int, 3>& size,
                            const std::string& name);

/// Where voxel indices lie in the world: centre (i, j, k) is at columns[3] + i columns[0] + j columns[1] + k
/// columns[2], LPS, mm. The volume becomes anatomical.
/// @param spacing_mm the size of a voxel where it is known better than the columns' lengths, as a header does @throws
/// Error(input) for columns that are not at right angles
void place_volume(LabelVolume& volume, const std::array<Vec3, 4>& columns,
                  const std::optional<std::array<double, 3>>& spacing_mm, const std::string& name);

}  // namespace stackmesh
