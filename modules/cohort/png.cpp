#include "cohort/png.h"

#include <zlib.h>

#include "report/packed.h"

namespace stackmesh {
namespace {

std::string big_endian(std::uint32_t value) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes.push_back(static_cast<char>(value >> shift & 255));
  return bytes;
}

std::string chunk(const std::string& type, const std::string& data) {
  const std::string body = type + data;
  const uLong sum = ::crc32(0, reinterpret_cast<const Bytef*>(body.data()), static_cast<uInt>(body.size()));
  return big_endian(static_cast<std::uint32_t>(data.size())) + body + big_endian(static_cast<std::uint32_t>(sum));
}

}  // namespace

std::string png_of(const std::vector<std::uint8_t>& rgb, int width, int height) {
  const char head[] = {8, 2, 0, 0, 0};  // bits of a channel, RGB, deflate, filters by row, no interlacing
  std::string rows;
  const std::size_t row_bytes = 3 * static_cast<std::size_t>(width);
  for (int y = 0; y < height; ++y) {
    rows.push_back(1);  // each byte as the step from the pixel to its left: even grounds become zeros
    const std::uint8_t* const row = rgb.data() + y * row_bytes;
    for (std::size_t i = 0; i < row_bytes; ++i) rows.push_back(static_cast<char>(row[i] - (i < 3 ? 0 : row[i - 3])));
  }
  return std::string("\x89PNG\r\n\x1a\n") +
         chunk("IHDR", big_endian(static_cast<std::uint32_t>(width)) + big_endian(static_cast<std::uint32_t>(height)) +
                           std::string(head, sizeof head)) +
         chunk("IDAT", deflated(rows)) + chunk("IEND", "");
}

}  // namespace stackmesh
