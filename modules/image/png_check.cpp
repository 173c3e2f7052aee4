#include "image/png_check.h"

#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <memory>

#include "base/error.h"

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
  const bool bits =
      h.bits == 8 || h.bits == 16 || (h.colour == 0 && (h.bits == 1 || h.bits == 2 || h.bits == 4));
  const bool colour = h.colour == 0 || h.colour == 2 || h.colour == 4 || h.colour == 6;
  if (!bits || !colour || p[10] != 0 || p[11] != 0 || h.interlace > 1) damaged("damaged (header)", path);
  if (h.width == 0 || h.height == 0 || h.width > 1000000 || h.height > 1000000)
    damaged("damaged (size in its header)", path);
  return h;
}

/// Decompresses the pixel stream row by row: complete, enough, each row with a known filter.
void check_rows(const std::vector<unsigned char>& stream, const Header& h, const std::string& path) {
  z_stream z{};
  if (inflateInit(&z) != Z_OK) throw std::bad_alloc();
  const std::unique_ptr<z_stream, int (*)(z_stream*)> guard(&z, &inflateEnd);
  z.next_in = const_cast<unsigned char*>(stream.data());
  z.avail_in = static_cast<uInt>(stream.size());
  const std::uint64_t pixel = static_cast<std::uint64_t>(h.bits) * (h.colour == 0   ? 1
                                                                    : h.colour == 4 ? 2
                                                                    : h.colour == 2 ? 3
                                                                                    : 4);
  // first x, step x, first y, step y of the seven passes of an interlaced image
  static const int passes[7][4] = {{0, 8, 0, 8}, {4, 8, 0, 8}, {0, 4, 4, 8}, {2, 4, 0, 4},
                                   {0, 2, 2, 4}, {1, 2, 0, 2}, {0, 1, 1, 2}};
  static const int whole[1][4] = {{0, 1, 0, 1}};
  const int(*pass)[4] = h.interlace ? passes : whole;
  std::vector<unsigned char> row;
  int code = Z_OK;
  for (int i = 0; i < (h.interlace ? 7 : 1); ++i) {
    const auto count = [](std::uint64_t n, int first, int step) { return (n + step - 1 - first) / step; };
    const std::uint64_t columns = count(h.width, pass[i][0], pass[i][1]),
                        rows = count(h.height, pass[i][2], pass[i][3]);
    if (columns == 0) continue;
    row.resize(1 + (columns * pixel + 7) / 8);
    for (std::uint64_t y = 0; y < rows; ++y) {
      z.next_out = row.data();
      z.avail_out = static_cast<uInt>(row.size());
      while (z.avail_out > 0) {
        if (code == Z_STREAM_END) damaged("damaged or truncated (too few pixels)", path);
        code = inflate(&z, Z_NO_FLUSH);
        if (code == Z_BUF_ERROR) damaged("damaged or truncated (too few pixels)", path);
        if (code != Z_OK && code != Z_STREAM_END) damaged("damaged (pixels)", path);
      }
      if (row[0] > 4) damaged("damaged (pixels)", path);
    }
  }
  unsigned char rest[64];
  while (code == Z_OK) {  // the check sum of the stream, and whatever follows the last row
    z.next_out = rest;
    z.avail_out = sizeof rest;
    code = inflate(&z, Z_NO_FLUSH);
  }
  if (code != Z_STREAM_END) damaged("damaged (pixels)", path);
}

}  // namespace

std::vector<unsigned char> checked_png(const std::vector<unsigned char>& bytes, const std::string& path) {
  static const unsigned char signature[8] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  if (bytes.size() < 8 || std::memcmp(bytes.data(), signature, 8) != 0)
    fail_input("this is no PNG file, or it is damaged", path, "copy or export the file again");
  std::vector<unsigned char> kept(bytes.begin(), bytes.begin() + 8), stream;
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
    if (at == 8 || is("IDAT") || is("IEND")) kept.insert(kept.end(), &bytes[at], type + 8 + length);
    at += 12 + length;
    if (is("IEND")) break;
  }
  check_rows(stream, header, path);
  return kept;
}

}  // namespace stackmesh
