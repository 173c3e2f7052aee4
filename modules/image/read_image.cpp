#include "image/read_image.h"

#include <cmath>
#include <filesystem>

#include "base/error.h"
#include "image/dicom_series.h"
#include "image/file_names.h"
#include "image/volume_file.h"

namespace stackmesh {

IntensityVolume read_image(const std::string& path, const ReadImageOptions& options) {
  constexpr const char* images =
      "give an image as .nii, .nii.gz, .nrrd, .nhdr, .mha, .mhd, .gipl, .gipl.gz, or a DICOM series";
  std::error_code error;
  if (!std::filesystem::exists(path, error))
    fail_input("the image does not exist", path.empty() ? "''" : path, "check the path");
  const FileFormat format = format_of(path);
  if (format == FileFormat::unknown && !dicom_content(path).images.empty())
    return read_series_image(path, options.series);
  if (std::filesystem::is_directory(path, error) || format == FileFormat::unknown || format == FileFormat::png ||
      format == FileFormat::tiff)
    fail_input("this is no image file that intensities are read from", path, images);
  IntensityVolume image = read_intensity_file(path, format, options.allow_outside);
  for (std::size_t i = 0; i < image.values.size(); ++i)
    if (!std::isfinite(image.values[i])) {
      const std::size_t x = i % image.size[0], y = i / image.size[0] % image.size[1],
                        z = i / image.size[0] / image.size[1];
      fail_input("an intensity is not finite",
                 path + ", voxel (" + std::to_string(x) + ", " + std::to_string(y) + ", " + std::to_string(z) + ")",
                 "export the image again without NaN");
    }
  return image;
}

}  // namespace stackmesh
