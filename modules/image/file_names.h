#pragma once
#include <string>
#include <vector>

namespace stackmesh {

/// Kinds of input file, told by their endings (any case).
enum class FileFormat { unknown, nifti, nrrd, metaimage, gipl, png, tiff };
FileFormat format_of(const std::string& path);

/// The name without folder and (double) ending: "a/heart.nii.gz" gives "heart".
std::string stem_of(const std::string& path);
std::string file_name_of(const std::string& path);

/// True when a sorts before b with digit runs compared as numbers: "slice2" before "slice10".
bool natural_less(const std::string& a, const std::string& b);

}  // namespace stackmesh
