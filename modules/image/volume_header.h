#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "image/file_names.h"
#include "image/slicer_segments.h"
#include "model/geometry.h"

namespace stackmesh {

/// What the raw header of a volume file says that ITK would mend in silence or not tell.
struct HeaderFacts {
  std::vector<std::string> warnings;
  SlicerSegmentation segmentation;     ///< NRRD: the segments of 3D Slicer, where it names any
  int layers = 1;                      ///< values a voxel, of segments that overlap
  double unit_mm = 1;                  ///< NIfTI: what the file's unit of length is, where it says so
  bool has_forms = true;               ///< NIfTI: false when it carries no orientation at all
  std::vector<Vec3>
      sform;  ///< NIfTI: columns of its sform in its own unit, LPS: three axes, origin; or empty
  std::vector<Vec3> raw_origin;   ///< NIfTI: one entry, the origin of the form in use, in its own unit, LPS
  bool compressed = false;        ///< the voxels are a gzip or zlib stream ...
  std::string data_path;          ///< ... of this file
  std::uint64_t data_offset = 0;  ///< ... beginning here
  std::uint64_t data_size = UINT64_MAX;  ///< ... of at most this many bytes
  std::uint64_t needed_bytes = 0;        ///< ... which must yield at least this much
};

/// Checks the header of a volume file before ITK sees it: sizes, spacing, directions, completeness.
/// @throws Error(input)
HeaderFacts check_volume_header(const std::string& path, FileFormat format);

/// @throws Error(input) unless all three spacings are finite and positive.
void require_spacing(const double* spacing, std::size_t count, const std::string& path);

}  // namespace stackmesh
