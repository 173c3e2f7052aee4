#include "image/read_labels.h"

#include <glob.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <vector>

#include "base/error.h"
#include "base/warning.h"
#include "image/dicom_file.h"
#include "image/dicom_segmentation.h"
#include "image/dicom_series.h"
#include "image/file_names.h"
#include "image/masks.h"
#include "image/slices.h"
#include "image/volume_file.h"

namespace stackmesh {
namespace {

namespace fs = std::filesystem;

constexpr const char* inputs =
    "give .nii, .nii.gz, .nrrd, .nhdr, .mha, .mhd, .gipl, .gipl.gz, DICOM, a folder of PNG/TIFF slices or of masks, "
    "or .cnt";

bool is_slice(FileFormat f) {
  return f == FileFormat::png || f == FileFormat::tiff;
}

std::vector<std::string> list_folder(const std::string& path) {
  std::vector<std::string> files;
  std::error_code error;
  for (fs::directory_iterator it(path, error), end; !error && it != end; it.increment(error)) {
    std::error_code ignored;
    if (it->is_regular_file(ignored)) files.push_back(it->path().string());
  }
  if (error) fail_input("cannot list the folder (" + error.message() + ")", path, "check that you may read it");
  return files;
}

std::vector<std::string> expand_glob(const std::string& pattern) {
  glob_t found{};
  std::vector<std::string> files;
  if (::glob(pattern.c_str(), 0, nullptr, &found) == 0)
    for (std::size_t i = 0; i < found.gl_pathc; ++i)
      if (fs::is_regular_file(found.gl_pathv[i])) files.push_back(found.gl_pathv[i]);
  ::globfree(&found);
  if (files.empty()) fail_input("no file matches", "'" + pattern + "'", "check the pattern and its folder");
  return files;
}

LabelVolume read_files(const std::vector<std::string>& files, const std::string& path, const ReadOptions& options) {
  std::vector<std::string> slices, masks;
  for (const std::string& file : files) {
    const FileFormat format = format_of(file);
    if (file_name_of(file)[0] == '.' || format == FileFormat::unknown) continue;
    (is_slice(format) ? slices : masks).push_back(file);
  }
  if (slices.empty() && masks.empty())
    fail_input(
        "no PNG/TIFF slices and no mask volumes", path,
        "give a folder of .png/.tif label slices, of one .nii.gz/.nrrd/.mha mask per structure, or of DICOM files");
  if (!slices.empty() && !masks.empty())
    fail_input("both slices and mask volumes are there",
               file_name_of(slices[0]) + " and " + file_name_of(masks[0]) + " in " + path,
               "put them into separate folders, or give a quoted glob such as '" + path + "/*.png'");
  std::vector<std::string> names;
  for (const std::string& file : slices) names.push_back(stem_of(file));
  for (const std::string& file : masks) names.push_back(stem_of(file));
  const NameOrder order(names);
  const auto by_stem = [&](const std::string& a, const std::string& b) {
    const std::string m = stem_of(a), n = stem_of(b);
    return m != n ? order.less(m, n) : a < b;
  };
  std::sort(slices.begin(), slices.end(), by_stem);
  std::sort(masks.begin(), masks.end(), by_stem);
  if (!slices.empty()) return read_slices(slices, options.spacing_mm);
  if (options.spacing_mm)
    fail_usage("--spacing is for PNG/TIFF slices", path, "leave it out: the masks carry their own voxel size");
  return read_masks(masks, options.allow_outside);
}

/// The labels of a DICOM file or folder.
LabelVolume read_dicom(const DicomContent& content, const std::string& path, const ReadOptions& options) {
  if (options.spacing_mm)
    fail_usage("--spacing is for PNG/TIFF slices", path, "leave it out: DICOM carries its own voxel size");
  const std::string object = label_object(content, path);
  if (!content.structure_sets.empty())
    fail_input("this is a structure set, which has contours and no voxels", object,
               "give it to mesh, surface or contours");
  if (!object.empty()) return read_segmentation(object, options.labels);
  if (!content.images.empty()) return read_series_labels(path, options.series);
  refuse_dicom(content.others[0]);
}

LabelVolume read_any(const std::string& path, const ReadOptions& options) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (fs::is_directory(status)) {
    const std::vector<std::string> files = list_folder(path);
    const DicomContent dicom = dicom_content(path);
    std::vector<std::string> known;
    for (const std::string& f : files)
      if (format_of(f) != FileFormat::unknown && file_name_of(f)[0] != '.') known.push_back(f);
    if (!dicom.any() || known.size() > dicom.size()) return read_files(files, path, options);
    LabelVolume volume = read_dicom(dicom, path, options);
    if (!known.empty())
      volume.warnings.push_back(
          warning_at(WarningCode::left_out, path,
                     "a folder of DICOM in which " + file_name_of(*std::min_element(known.begin(), known.end())) +
                         (known.size() > 1 ? " and " + std::to_string(known.size() - 1) + " more files" : "") +
                         " of another kind are left out"));
    return volume;
  }
  if (!fs::exists(status)) {
    if (path.find_first_of("*?[") != std::string::npos) return read_files(expand_glob(path), path, options);
    fail_input("the input does not exist", path.empty() ? "''" : path, "check the path");
  }
  if (!fs::is_regular_file(status)) fail_input("the input is no regular file", path, "give a file or a folder");
  const FileFormat format = format_of(path);
  if (format == FileFormat::unknown && dicom_kind(path) != DicomKind::none)
    return read_dicom(dicom_content(path), path, options);
  if (format == FileFormat::unknown) fail_input("the ending is of no known format", path, inputs);
  if (is_slice(format)) return read_slices({path}, options.spacing_mm);
  if (options.spacing_mm)
    fail_usage("--spacing is for PNG/TIFF slices", path, "leave it out: the file carries its own voxel size");
  return read_volume_file(path, format, options.labels, options.allow_outside);
}

}  // namespace

LabelVolume read_label_volume(const std::string& path, const ReadOptions& options) {
  if (options.spacing_mm)
    for (double s : *options.spacing_mm) {
      if (!std::isfinite(s) || s <= 0)
        fail_usage("a voxel size must be finite and above 0", "--spacing", "write --spacing X,Y,Z in mm");
      if (s < 1e-12 || s > 1e12)
        fail_usage("a voxel size must be between 1e-12 and 1e12 mm", "--spacing", "write --spacing X,Y,Z in mm");
    }
  LabelVolume volume = read_any(path, options);
  if (volume.labels.size() < 2)
    fail_input("no label: every voxel is background (0)", path, "give a volume that holds at least one label");
  check_grid(volume.spacing_mm, volume.origin_mm, path);
  return volume;
}

}  // namespace stackmesh
