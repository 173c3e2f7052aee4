#pragma once
#include <string>
#include <vector>

#include "model/intensity_volume.h"
#include "model/label_volume.h"

namespace stackmesh {

/// What a folder (or one file) of DICOM holds; empty where it holds none.
struct DicomContent {
  std::vector<std::string> structure_sets;  ///< paths of files of contours (RTSTRUCT)
  std::vector<std::string> segmentations;   ///< paths of files of label masks (SEG)
  std::vector<std::string> images;          ///< paths of files of slices, of all series together
  std::vector<std::string> others;          ///< paths of DICOM files of any other kind, which cannot be read as labels
  /// Number of DICOM files of all kinds.
  std::size_t size() const { return structure_sets.size() + segmentations.size() + images.size() + others.size(); }
  bool any() const { return size() > 0; }  ///< whether there is any DICOM file
};

/// Looks into a folder's files, or at one file. Folders are not searched deeper.
DicomContent dicom_content(const std::string& path);

/// The one structure set or segmentation in it, "" where there is none. @throws Error(input) naming them where there
/// are several
std::string label_object(const DicomContent& content, const std::string& path);

/// Reads a series of slices as labels: whole numbers after rescaling. `path` is its folder, or any one of its files;
/// `series` is the series instance UID where a folder holds several. Slices stand where their positions say: where gaps
/// differ, the grid has the usual (or the smallest) gap and every slice of it is the nearest one read, with a warning.
/// @throws Error(input) naming file or slices
LabelVolume read_series_labels(const std::string& path, const std::string& series);

/// The same as intensities, linear between the true positions.
IntensityVolume read_series_image(const std::string& path, const std::string& series);

}  // namespace stackmesh
