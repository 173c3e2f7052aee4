#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "image/voxel_data.h"

namespace stackmesh {

/// The data files that a detached header names, beside it. @throws Error(input) where one leaves the header's folder,
/// unless `allow_outside`
class DataFiles {
 public:
  DataFiles(const std::string& header, bool allow_outside) : header_(header), allow_outside_(allow_outside) {}

  /// One file, by its name in the header.
  DataPart part(const std::string& name) const;
  /// "slice%03d.raw" for numbers from `first` to `last`. @throws Error(input) where the pattern holds anything but one
  /// whole number
  std::vector<DataPart> numbered(const std::string& pattern, double first, double last, double step) const;

 private:
  const std::string header_;
  const bool allow_outside_;
};

}  // namespace stackmesh
