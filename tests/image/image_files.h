#pragma once
// Writes small image files byte by byte, so that no reader's own library is the judge of what it reads.
#include <gtest/gtest.h>
#include <stdlib.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "base/error.h"
#include "image/read_labels.h"

namespace image_files {

using Bytes = std::string;

/// A folder of its own, removed at the end of the test.
class ImageTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = (std::filesystem::temp_directory_path() / "image_test_XXXXXX").string();
    ASSERT_NE(::mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  std::string at(const std::string& name) const { return folder_ + "/" + name; }
  std::string write(const std::string& name, const Bytes& bytes) const {
    std::filesystem::create_directories(std::filesystem::path(at(name)).parent_path());
    std::ofstream(at(name), std::ios::binary) << bytes;
    return at(name);
  }
  std::string folder_;
};

/// Runs `read`, which must throw Error(input) of one line that holds every one of `parts`, and print nothing.
inline void expect_error(const std::function<void()>& read, const std::vector<std::string>& parts,
                         stackmesh::ErrorKind kind = stackmesh::ErrorKind::input) {
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  std::string message;
  bool thrown = false;
  try {
    read();
  } catch (const stackmesh::Error& e) {
    thrown = true;
    message = e.what();
    EXPECT_EQ(static_cast<int>(e.kind()), static_cast<int>(kind)) << message;
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  ASSERT_TRUE(thrown) << "no error was thrown";
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  EXPECT_NE(message.find("; "), std::string::npos) << "no way to mend: " << message;
  for (const std::string& part : parts)
    EXPECT_NE(message.find(part), std::string::npos) << part << " is not in: " << message;
}
inline void expect_unreadable(const std::string& path, std::vector<std::string> parts) {
  parts.push_back(path);
  expect_error([&] { stackmesh::read_label_volume(path); }, parts);
}
inline bool has_warning(const std::vector<stackmesh::Warning>& warnings, const std::string& part) {
  for (const stackmesh::Warning& w : warnings)
    if (w.text.find(part) != std::string::npos) return true;
  return false;
}
/// The label number of a voxel.
inline int number(const stackmesh::LabelVolume& v, int i, int j, int k) {
  return v.labels[v.voxels[v.index(i, j, k)]].number;
}

template <class T>
Bytes little(T value) {
  Bytes bytes(sizeof(T), '\0');
  std::memcpy(bytes.data(), &value, sizeof(T));
  return bytes;
}
template <class T>
Bytes big(T value) {
  const Bytes bytes = little(value);
  return {bytes.rbegin(), bytes.rend()};
}
template <class T, class V>
Bytes pack(const std::vector<V>& values, bool big_endian = false) {
  Bytes bytes;
  for (V v : values) bytes += big_endian ? big(static_cast<T>(v)) : little(static_cast<T>(v));
  return bytes;
}

inline std::uint32_t crc32(const Bytes& bytes) {
  std::uint32_t crc = 0xffffffffu;
  for (unsigned char c : bytes) {
    crc ^= c;
    for (int k = 0; k < 8; ++k) crc = crc & 1 ? crc >> 1 ^ 0xedb88320u : crc >> 1;
  }
  return ~crc;
}
inline Bytes stored_blocks(const Bytes& bytes) {  // deflate without compression
  Bytes out;
  for (std::size_t at = 0; at == 0 || at < bytes.size(); at += 65535) {
    const Bytes part = bytes.substr(at, 65535);
    out += Bytes(1, at + 65535 >= bytes.size() ? 1 : 0) + little<std::uint16_t>(part.size()) +
           little<std::uint16_t>(~part.size()) + part;
  }
  return out;
}
inline Bytes gzip(const Bytes& bytes) {
  return Bytes("\x1f\x8b\x08\0\0\0\0\0\0\x03", 10) + stored_blocks(bytes) + little(crc32(bytes)) +
         little<std::uint32_t>(bytes.size());
}
inline Bytes zlib(const Bytes& bytes) {
  std::uint32_t a = 1, b = 0;
  for (unsigned char c : bytes) {
    a = (a + c) % 65521;
    b = (b + a) % 65521;
  }
  return Bytes("\x78\x01", 2) + stored_blocks(bytes) + big(b << 16 | a);
}

/// A NIfTI-1 header; the defaults are a volume of 3 x 2 x 2 bytes with an sform of RAS identity.
struct Nifti {
  std::vector<int> dim = {3, 3, 2, 2, 1, 1, 1, 1};
  int datatype = 2, bits = 8;
  std::array<float, 4> pixdim = {1, 1, 1, 1};  ///< qfac, x, y, z
  float slope = 0, inter = 0, vox_offset = 352;
  int qform = 0, sform = 1;
  std::array<float, 6> quatern = {0, 0, 0, 0, 0, 0};  ///< b c d, x y z
  std::array<float, 12> srow = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  int units = 2;
  bool big_endian = false;

  Bytes header() const {
    Bytes h(352, '\0');
    const auto put = [&](std::size_t offset, const Bytes& bytes) { h.replace(offset, bytes.size(), bytes); };
    const auto i16 = [&](int v) { return big_endian ? big<std::int16_t>(v) : little<std::int16_t>(v); };
    const auto f32 = [&](float v) { return big_endian ? big(v) : little(v); };
    put(0, big_endian ? big<std::int32_t>(348) : little<std::int32_t>(348));
    for (int d = 0; d < 8; ++d) put(40 + 2 * d, i16(dim[d]));
    put(70, i16(datatype));
    put(72, i16(bits));
    for (int d = 0; d < 4; ++d) put(76 + 4 * d, f32(pixdim[d]));
    put(108, f32(vox_offset));
    put(112, f32(slope));
    put(116, f32(inter));
    h[123] = static_cast<char>(units);
    put(252, i16(qform));
    put(254, i16(sform));
    for (int i = 0; i < 6; ++i) put(256 + 4 * i, f32(quatern[i]));
    for (int i = 0; i < 12; ++i) put(280 + 4 * i, f32(srow[i]));
    put(344, Bytes("n+1\0", 4));
    return h;
  }

  /// The same as NIfTI-2; voxels begin at byte 544.
  Bytes header2() const {
    Bytes h(544, '\0');
    const auto put = [&](std::size_t offset, const Bytes& bytes) { h.replace(offset, bytes.size(), bytes); };
    const auto i16 = [&](int v) { return big_endian ? big<std::int16_t>(v) : little<std::int16_t>(v); };
    const auto i32 = [&](int v) { return big_endian ? big<std::int32_t>(v) : little<std::int32_t>(v); };
    const auto i64 = [&](std::int64_t v) { return big_endian ? big<std::int64_t>(v) : little<std::int64_t>(v); };
    const auto f64 = [&](double v) { return big_endian ? big(v) : little(v); };
    put(0, i32(540));
    put(4, Bytes("n+2\0\r\n\x1a\n", 8));
    put(12, i16(datatype));
    put(14, i16(bits));
    for (int d = 0; d < 8; ++d) put(16 + 8 * d, i64(dim[d]));
    for (int d = 0; d < 4; ++d) put(104 + 8 * d, f64(pixdim[d]));
    put(168, i64(544));
    put(176, f64(slope));
    put(184, f64(inter));
    put(344, i32(qform));
    put(348, i32(sform));
    for (int i = 0; i < 6; ++i) put(352 + 8 * i, f64(quatern[i]));
    for (int i = 0; i < 12; ++i) put(400 + 8 * i, f64(srow[i]));
    put(500, i32(units));
    return h;
  }
};
/// Twelve voxels (3 x 2 x 2): x fastest.
const std::vector<int> twelve = {0, 1, 2, 0, 0, 5, 0, 0, 0, 0, 9, 0};

inline Bytes nrrd(const std::string& type, const std::string& more, const Bytes& data,
                  const std::string& sizes = "3 2 2", const std::string& encoding = "raw",
                  const std::string& endian = "little") {
  return "NRRD0004\ntype: " + type + "\ndimension: 3\nsizes: " + sizes + "\nendian: " + endian +
         "\nencoding: " + encoding + "\n" + more + "\n" + data;
}
const std::string lps_grid =
    "space: left-posterior-superior\nspace directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\n";

inline Bytes metaimage(const std::string& type, const std::string& more, const Bytes& data) {
  return "ObjectType = Image\nNDims = 3\nBinaryData = True\n" + more + "DimSize = 3 2 2\nElementType = " + type +
         "\nElementDataFile = LOCAL\n" + data;
}

/// GIPL: big-endian bytes 3 x 2 x 2.
inline Bytes gipl(float sx = 1, float sy = 1, float sz = 1, std::uint32_t magic = 719555000u) {
  Bytes h(256, '\0');
  h.replace(0, 8, pack<std::uint16_t>(std::vector<int>{3, 2, 2, 1}, true));
  h.replace(8, 2, big<std::uint16_t>(8));
  h.replace(10, 12, pack<float>(std::vector<float>{sx, sy, sz}, true));
  h.replace(204, 24, pack<double>(std::vector<double>{7, 8, 9}, true));
  h.replace(252, 4, big(magic));
  return h + pack<std::uint8_t>(twelve);
}

/// A PNG whose pixel stream is given as it is: colour type 0 grey, 2 RGB, 3 palette, 4 grey with opacity, 6 RGBA.
/// @param first so many bytes of the stream are in a chunk of their own, the rest in a second one
inline Bytes png_of_stream(int width, int height, int bits, int colour, const Bytes& stream, bool interlaced = false,
                           std::size_t first = Bytes::npos) {
  const auto chunk = [](const Bytes& type, const Bytes& data) {
    return big<std::uint32_t>(data.size()) + type + data + big(crc32(type + data));
  };
  const Bytes palette = colour == 3 ? chunk("PLTE", Bytes("\0\0\0\xff\0\0\0\xff\0", 9)) : "";
  return Bytes("\x89PNG\r\n\x1a\n") +
         chunk("IHDR", big<std::uint32_t>(width) + big<std::uint32_t>(height) + Bytes(1, static_cast<char>(bits)) +
                           Bytes(1, static_cast<char>(colour)) + Bytes(2, '\0') + (interlaced ? '\1' : '\0')) +
         palette + chunk("iCCP", "bad profile") + chunk("IDAT", stream.substr(0, first)) +
         (first < stream.size() ? chunk("IDAT", stream.substr(first)) : "") + chunk("IEND", "");
}
/// `rows` holds the raw bytes of all rows.
inline Bytes png(int width, int height, int bits, int colour, const Bytes& rows) {
  Bytes filtered;
  const std::size_t row = rows.size() / height;
  for (int y = 0; y < height; ++y) filtered += Bytes(1, '\0') + rows.substr(y * row, row);
  return png_of_stream(width, height, bits, colour, zlib(filtered));
}
inline Bytes short_png(int width, int height, const Bytes& stream) {
  return png_of_stream(width, height, 8, 0, stream);
}
inline Bytes grey_png(int width, int height, const std::vector<int>& values) {
  return png(width, height, 8, 0, pack<std::uint8_t>(values));
}

/// An uncompressed little-endian grey TIFF, one page each entry.
inline Bytes tiff(int width, int height, int bits, const std::vector<Bytes>& pages) {
  Bytes out = Bytes("II*\0", 4);
  std::size_t at = 8;
  out += little<std::uint32_t>(at);
  for (std::size_t p = 0; p < pages.size(); ++p) {
    const std::uint32_t data = static_cast<std::uint32_t>(at + 2 + 11 * 12 + 4);
    const std::vector<std::array<std::uint32_t, 3>> entries = {
        {256, 4, static_cast<std::uint32_t>(width)},
        {257, 4, static_cast<std::uint32_t>(height)},
        {258, 3, static_cast<std::uint32_t>(bits)},
        {259, 3, 1},
        {262, 3, 1},
        {273, 4, data},
        {277, 3, 1},
        {278, 4, static_cast<std::uint32_t>(height)},
        {279, 4, static_cast<std::uint32_t>(pages[p].size())},
        {339, 3, 1},
        {50838, 4, 1}};  // a tag of ImageJ's that libtiff does not know
    out += little<std::uint16_t>(11);
    for (const auto& e : entries)
      out += little<std::uint16_t>(e[0]) + little<std::uint16_t>(e[1]) + little<std::uint32_t>(1) + little(e[2]);
    at = data + pages[p].size();
    out += little<std::uint32_t>(p + 1 < pages.size() ? at : 0) + pages[p];
  }
  return out;
}

}  // namespace image_files
