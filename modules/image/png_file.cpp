#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <new>

#include "base/error.h"
#include "image/slice_image.h"

namespace stackmesh {
namespace {

[[noreturn]] void damaged(const std::string& what, const std::string& path) {
  fail_input("the PNG file is " + what, path, "copy or export the file again");
}

std::uint32_t big_endian(const unsigned char* p) {
  return static_cast<std::uint32_t>(p[0]) << 24 | static_cast<std::uint32_t>(p[1]) << 16 |
         static_cast<std::uint32_t>(p[2]) << 8 | p[3];
}

struct Header {
  std::uint64_t width = 0, height = 0;
  int bits = 0, colour = 0, interlace = 0;
};

Header read_header(const unsigned char* p, const std::string& path) {
  Header h = {big_endian(p), big_endian(p + 4), p[8], p[9], p[12]};
  if (h.colour == 3)
    fail_input("the PNG has a colour palette, so its pixels are colours and not label numbers", path,
               "save it as 8- or 16-bit greyscale with the label as grey value");
  const bool bits = h.bits == 8 || h.bits == 16 || (h.colour == 0 && (h.bits == 1 || h.bits == 2 || h.bits == 4));
  const bool colour = h.colour == 0 || h.colour == 2 || h.colour == 4 || h.colour == 6;
  if (!bits || !colour || p[10] != 0 || p[11] != 0 || h.interlace > 1) damaged("damaged (header)", path);
  if (h.width == 0 || h.height == 0 || h.width > 1000000 || h.height > 1000000)
    damaged("damaged (size in its header)", path);
  return h;
}

/// first x, step x, first y, step y of a pass
struct Pass {
  std::uint64_t x = 0, dx = 1, y = 0, dy = 1;
};

/// Decompresses the pixel stream row by row, undoes the rows' filters, and puts the pixels where they belong.
class PngDecoder {
 public:
  PngDecoder(const std::vector<unsigned char>& stream, const Header& h, const std::string& path)
      : h_(h),
        path_(path),
        samples_(h.colour == 0   ? 1
                 : h.colour == 4 ? 2
                 : h.colour == 2 ? 3
                                 : 4),
        bytes_(h.bits == 16 ? 2 : 1) {
    z_.next_in = const_cast<unsigned char*>(stream.data());
    z_.avail_in = static_cast<uInt>(stream.size());
    if (inflateInit(&z_) != Z_OK) throw std::bad_alloc();
    // Deflate cannot shrink data more than about 1032 times.
    const double row = std::ceil(static_cast<double>(h.width) * samples_ * h.bits / 8);
    if (row * static_cast<double>(h.height) > 1040.0 * static_cast<double>(stream.size()) + 4096)
      damaged("damaged or truncated (too few pixels)", path_);
  }
  ~PngDecoder() { inflateEnd(&z_); }
  PngDecoder(const PngDecoder&) = delete;
  PngDecoder& operator=(const PngDecoder&) = delete;

  SliceImage run() {
    image_.width = h_.width;
    image_.height = h_.height;
    image_.type = bytes_ == 2 ? VoxelType::u16 : VoxelType::u8;
    image_.values.resize(h_.width * h_.height * bytes_);
    static const Pass passes[7] = {{0, 8, 0, 8}, {4, 8, 0, 8}, {0, 4, 4, 8}, {2, 4, 0, 4},
                                   {0, 2, 2, 4}, {1, 2, 0, 2}, {0, 1, 1, 2}};
    if (h_.interlace)
      for (const Pass& pass : passes) read_pass(pass);
    else read_pass({});
    unsigned char rest[64];
    while (code_ == Z_OK) {  // the check sum of the stream, and whatever follows the last row
      z_.next_out = rest;
      z_.avail_out = sizeof rest;
      code_ = inflate(&z_, Z_NO_FLUSH);
    }
    if (code_ != Z_STREAM_END) damaged("damaged (pixels)", path_);
    return std::move(image_);
  }

 private:
  void read_pass(const Pass& pass) {
    const auto count = [](std::uint64_t n, std::uint64_t first, std::uint64_t step) {
      return n > first ? (n - first + step - 1) / step : 0;
    };
    const std::uint64_t columns = count(h_.width, pass.x, pass.dx), rows = count(h_.height, pass.y, pass.dy);
    if (columns == 0) return;
    const std::size_t pixel_bits = static_cast<std::size_t>(samples_) * static_cast<std::size_t>(h_.bits),
                      length = (columns * pixel_bits + 7) / 8;
    std::vector<unsigned char> row(1 + length), before(1 + length, 0), grey(columns * bytes_);
    for (std::uint64_t y = 0; y < rows; ++y) {
      inflate_row(row);
      undo_filter(row, before, std::max<std::size_t>(1, pixel_bits / 8));
      take_row(row, columns, pass.y + y * pass.dy, grey);
      for (std::uint64_t x = 0; x < columns; ++x)
        std::memcpy(image_.values.data() + ((pass.y + y * pass.dy) * h_.width + pass.x + x * pass.dx) * bytes_,
                    grey.data() + x * bytes_, bytes_);
      std::swap(row, before);
    }
  }

  void inflate_row(std::vector<unsigned char>& row) {
    z_.next_out = row.data();
    z_.avail_out = static_cast<uInt>(row.size());
    while (z_.avail_out > 0) {
      if (code_ == Z_STREAM_END) damaged("damaged or truncated (too few pixels)", path_);
      code_ = inflate(&z_, Z_NO_FLUSH);
      if (code_ == Z_BUF_ERROR) damaged("damaged or truncated (too few pixels)", path_);
      if (code_ != Z_OK && code_ != Z_STREAM_END) damaged("damaged (pixels)", path_);
    }
    if (row[0] > 4) damaged("damaged (pixels)", path_);
  }

  static void undo_filter(std::vector<unsigned char>& row, const std::vector<unsigned char>& before,
                          std::size_t pixel) {
    for (std::size_t i = 1; i < row.size(); ++i) {
      const int left = i > pixel ? row[i - pixel] : 0, up = before[i], corner = i > pixel ? before[i - pixel] : 0;
      int guess = 0;
      if (row[0] == 1) guess = left;
      else if (row[0] == 2) guess = up;
      else if (row[0] == 3) guess = (left + up) / 2;
      else if (row[0] == 4) {
        const int p = left + up - corner, a = std::abs(p - left), b = std::abs(p - up), c = std::abs(p - corner);
        guess = a <= b && a <= c ? left : b <= c ? up : corner;
      }
      row[i] = static_cast<unsigned char>(row[i] + guess);
    }
  }

  /// The row's pixels as numbers of one or two bytes.
  void take_row(std::vector<unsigned char>& row, std::uint64_t columns, std::uint64_t y,
                std::vector<unsigned char>& grey) {
    unsigned char* p = row.data() + 1;
    if (h_.bits < 8) {
      for (std::uint64_t x = 0; x < columns; ++x) {
        const std::uint64_t bit = x * static_cast<std::uint64_t>(h_.bits);
        grey[x] =
            static_cast<unsigned char>(p[bit / 8] >> (8 - h_.bits - static_cast<int>(bit % 8)) & ((1 << h_.bits) - 1));
      }
      return;
    }
    take_grey(p, columns, samples_, std::min(samples_ == 2 ? 1 : samples_, 3), bytes_, y, grey.data(), path_);
    if (bytes_ == 2)
      for (std::uint64_t x = 0; x < columns; ++x) {
        const auto value = static_cast<std::uint16_t>(grey[2 * x] << 8 | grey[2 * x + 1]);
        std::memcpy(grey.data() + 2 * x, &value, 2);
      }
  }

  const Header h_;
  const std::string& path_;
  const int samples_;
  const std::size_t bytes_;
  SliceImage image_;
  z_stream z_{};
  int code_ = Z_OK;
};

}  // namespace

void take_grey(const unsigned char* pixels, std::uint64_t count, int samples, int colours, std::size_t bytes,
               std::uint64_t row, unsigned char* out, const std::string& where) {
  const std::size_t pixel = static_cast<std::size_t>(samples) * bytes;
  for (std::uint64_t x = 0; x < count; ++x) {
    const unsigned char* p = pixels + x * pixel;
    for (int c = 1; c < colours; ++c)
      if (std::memcmp(p, p + static_cast<std::size_t>(c) * bytes, bytes) != 0)
        fail_input("the slice is a colour image",
                   where + ", pixel (" + std::to_string(x) + ", " + std::to_string(row) + ")",
                   "save it as 8- or 16-bit greyscale with the label as grey value");
    std::memcpy(out + x * bytes, p, bytes);
  }
}

SliceImage read_png(const std::vector<unsigned char>& bytes, const std::string& path) {
  static const unsigned char signature[8] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  if (bytes.size() > 3 && bytes[0] == 0xff && bytes[1] == 0xd8 && bytes[2] == 0xff)
    fail_input("this is a JPEG file, whose compression changes label numbers", path,
               "export the labels as PNG or TIFF");
  if (bytes.size() < 8 || std::memcmp(bytes.data(), signature, 8) != 0)
    fail_input("this is no PNG file, or it is damaged", path, "copy or export the file again");
  std::vector<unsigned char> stream;
  Header header;
  for (std::size_t at = 8;;) {
    if (bytes.size() - at < 12) damaged("truncated", path);
    const std::size_t length = big_endian(&bytes[at]);
    if (bytes.size() - at - 12 < length) damaged("truncated", path);
    const unsigned char* type = &bytes[at + 4];
    const auto is = [&](const char* name) { return std::memcmp(type, name, 4) == 0; };
    if (::crc32(::crc32(0, nullptr, 0), type, static_cast<uInt>(length + 4)) != big_endian(type + 4 + length))
      damaged("damaged (check sum)", path);
    if (at == 8) {
      if (length != 13 || !is("IHDR")) damaged("damaged (no header)", path);
      header = read_header(type + 4, path);
    } else if (is("IDAT")) {
      stream.insert(stream.end(), type + 4, type + 4 + length);
    }
    at += 12 + length;
    if (is("IEND")) break;
  }
  return PngDecoder(stream, header, path).run();
}

}  // namespace stackmesh
