#pragma once
#include <array>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/warning.h"
#include "model/contours.h"
#include "model/label_volume.h"
#include "model/stack.h"
#include "sections/polygons.h"
#include "sections/volume_sections.h"
#include "stitch/stitch.h"

namespace stackmesh {

/// What to read, and which labels of it.
struct InputOptions {
  /// one volume, DICOM file, folder or glob; or one or more .cnt files or LABEL=FILE.cnt pairs
  std::vector<std::string> paths;
  std::shared_ptr<const LabelVolume> volume;  ///< in place of paths: labels in memory
  /// in place of paths: drawn contours in memory, every label numbered
  std::shared_ptr<const std::vector<LabelContours>> contours;
  std::string memory_name;                          ///< what messages and reports call what is in memory
  std::optional<std::array<double, 3>> spacing_mm;  ///< for PNG/TIFF slices
  /// "1,4,7-9,femur_left"; empty: all; its order is the priority where drawn labels overlap
  std::string labels;
  std::string series;          ///< DICOM: series instance UID where a folder holds several
  bool allow_outside = false;  ///< a detached header may name data files outside of its folder
  /// labels that bound the others and are not filled, as `labels`; they are read whatever that says
  std::string voids;
  bool merge = false;           ///< selected labels become one
  Caps caps = Caps::automatic;  ///< how drawn labels end: other labels go on beside them
  std::vector<std::pair<std::string, LabelEndCaps>> label_caps;  ///< by name or number
  /// label table (image/read_label_table.h) that names labels; empty: none
  std::string names;
};

/// The input as read: a volume, or contours and how they are to become sections.
struct Input {
  std::optional<LabelVolume> volume;    ///< the labels that were requested, all others background; unset: contours
  std::vector<LabelContours> contours;  ///< one entry a label
  ContourStackOptions drawn;            ///< how `contours` become sections; of no meaning for a volume
  bool anatomical = false;              ///< coordinates are LPS; false: no anatomy is known, they are kept as they are
  std::string path;               ///< as it was given, several separated by blanks; of labels in memory their name
  std::string kind;               ///< "contours", "rtstruct", or the volume's (LabelVolume::kind)
  std::vector<LabelInfo> labels;  ///< without the background
  std::set<Label> voids;          ///< those of them that are not filled
  std::vector<Warning> warnings;  ///< what reading found odd but could mend; later steps add theirs
};

/// Reads the input and keeps the labels that were requested. @throws Error(input), Error(usage)
Input read_input(const InputOptions& options);

/// The sections that the contours make; what was odd with them goes to the input's warnings. @throws as
/// sections_from_contours()
Stack drawn_sections(Input& input);

/// Makes background of the voids: what a mesh that leaves them empty is judged against.
void empty_voids(Input& input);
/// The same for sections: edges between two voids, or a void and the background, go.
void empty_voids(Stack& stack, const std::set<Label>& voids);

/// Puts a label volume that is stored finer than it was made onto the grid on which it was made, with a warning that
/// says so.
/// @return its voxels there, or as they are stored where nothing tells otherwise, mm
std::array<double, 3> reduce_to_true_grid(Input& input, int threads);

/// Whether the input can be cut along the axis requested: contours are stacked along z, and a volume needs two slices.
/// @throws Error(usage), Error(input)
void check_stack_axis(const Input& input, StackAxis axis);

}  // namespace stackmesh
