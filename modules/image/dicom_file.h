#pragma once
#include <string>

namespace stackmesh {

/// What a DICOM file holds.
enum class DicomKind { none, image, structure_set, segmentation, other };

/// Tells it from the file's beginning, whatever its name; `none` where it is no DICOM file or cannot be opened.
DicomKind dicom_kind(const std::string& path);

/// @throws Error(input) that says why a DICOM file of kind `other` cannot be used.
[[noreturn]] void refuse_dicom(const std::string& path);

}  // namespace stackmesh
