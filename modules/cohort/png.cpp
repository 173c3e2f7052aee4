#include "cohort/png.h"

#include <png.h>

#include "base/error.h"

namespace stackmesh {

std::string png_of(const std::vector<std::uint8_t>& rgb, int width, int height) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(width);
  image.height = static_cast<png_uint_32>(height);
  image.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::string file(size, '\0');
  if (png_image_write_to_memory(&image, file.data(), &size, 0, rgb.data(), 0, nullptr) == 0)
    fail_internal(std::string("libpng cannot write a picture (") + image.message + ")", "page of a cohort");
  file.resize(size);
  return file;
}

}  // namespace stackmesh
