#pragma once
#include <string>

namespace stackmesh {

/// How deep the sequences of a DICOM file are nested, up to kDeepest + 1. Nothing is kept in memory, and nothing calls
/// itself: DCMTK reads sequences by recursion, and a file of some hundred kilobytes can end the program by its depth.
int dicom_nesting(const std::string& path);

constexpr int kDeepest = 100;

}  // namespace stackmesh
