#include "image/file_names.h"

#include <algorithm>

#include "base/text.h"

namespace stackmesh {
namespace {

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

const struct {
  const char* ending;
  FileFormat format;
} endings[] = {
    {".nii.gz", FileFormat::nifti}, {".nii", FileFormat::nifti},     {".nrrd", FileFormat::nrrd},
    {".nhdr", FileFormat::nrrd},    {".mha", FileFormat::metaimage}, {".mhd", FileFormat::metaimage},
    {".gipl.gz", FileFormat::gipl}, {".gipl", FileFormat::gipl},     {".png", FileFormat::png},
    {".tiff", FileFormat::tiff},    {".tif", FileFormat::tiff}};

}  // namespace

std::string file_name_of(const std::string& path) {
  return path.substr(path.find_last_of('/') + 1);
}

FileFormat format_of(const std::string& path) {
  const std::string name = lower_case(file_name_of(path));
  for (const auto& e : endings)
    if (name != e.ending && ends_with(name, e.ending)) return e.format;
  return FileFormat::unknown;
}

std::string stem_of(const std::string& path) {
  const std::string name = file_name_of(path), lower = lower_case(name);
  for (const auto& e : endings)
    if (lower != e.ending && ends_with(lower, e.ending)) return name.substr(0, name.size() - std::string(e.ending).size());
  return name.substr(0, name.find_last_of('.'));
}

bool natural_less(const std::string& a, const std::string& b) {
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (!is_digit(a[i]) || !is_digit(b[j])) {
      if (a[i] != b[j]) return static_cast<unsigned char>(a[i]) < static_cast<unsigned char>(b[j]);
      ++i;
      ++j;
      continue;
    }
    while (i < a.size() && a[i] == '0') ++i;
    while (j < b.size() && b[j] == '0') ++j;
    const std::size_t p = i, q = j;
    while (i < a.size() && is_digit(a[i])) ++i;
    while (j < b.size() && is_digit(b[j])) ++j;
    if (i - p != j - q) return i - p < j - q;
    const int order = a.compare(p, i - p, b, q, j - q);
    if (order != 0) return order < 0;
  }
  if ((i < a.size()) != (j < b.size())) return j < b.size();
  return a < b;  // "01" and "1": any fixed order
}

}  // namespace stackmesh
