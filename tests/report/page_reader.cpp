#include "page_reader.h"

#include <gtest/gtest.h>
#include <zlib.h>

namespace page_reader {
namespace {

std::string from_base64(const std::string& text) {
  static const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  int bits = 0, value = 0;
  for (const char c : text) {
    if (c == '=') break;
    const std::size_t digit = digits.find(c);
    if (digit == std::string::npos) continue;
    value = (value << 6 | static_cast<int>(digit)) & 0xffffff;
    if ((bits += 6) >= 8) out.push_back(static_cast<char>(value >> (bits -= 8) & 255));
  }
  return out;
}

std::string inflated(const std::string& bytes) {
  z_stream stream = {};
  EXPECT_EQ(inflateInit(&stream), Z_OK);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  std::string out;
  char buffer[65536];
  int status = Z_OK;
  while (status == Z_OK) {
    stream.next_out = reinterpret_cast<Bytef*>(buffer);
    stream.avail_out = sizeof buffer;
    status = inflate(&stream, Z_NO_FLUSH);
    out.append(buffer, sizeof buffer - stream.avail_out);
  }
  EXPECT_EQ(status, Z_STREAM_END);
  inflateEnd(&stream);
  return out;
}

}  // namespace

std::string element_text(const std::string& html, const std::string& id) {
  const std::size_t at = html.find(" id=\"" + id + "\"");
  EXPECT_NE(at, std::string::npos) << id;
  if (at == std::string::npos) return "";
  const std::size_t begin = html.find('>', at) + 1;
  return html.substr(begin, html.find("</", begin) - begin);
}

Json page_data(const std::string& html) {
  return Json::parse(element_text(html, "data"));
}

std::string chunk(const std::string& html, int mesh, const Json& where, std::size_t i) {
  const std::string blob =
      from_base64(element_text(html, "blob-" + std::to_string(mesh) + "-" + where["blob"].get<std::string>()));
  const std::size_t begin = where["offsets"][i], end = where["offsets"][i + 1];
  EXPECT_LE(end, blob.size());
  return inflated(blob.substr(begin, end - begin));
}

std::string chunk(const std::string& html, int mesh, const Json& where, const std::string& array) {
  for (std::size_t i = 0; i < where["arrays"].size(); ++i)
    if (where["arrays"][i] == array) return chunk(html, mesh, where, i);
  ADD_FAILURE() << "no array " << array;
  return "";
}

std::uint64_t Numbers::number() {
  std::uint64_t value = 0;
  for (int shift = 0; at_ < bytes_.size(); shift += 7) {
    const std::uint8_t byte = static_cast<std::uint8_t>(bytes_[at_++]);
    value |= static_cast<std::uint64_t>(byte & 127) << shift;
    if (byte < 128) return value;
  }
  ADD_FAILURE() << "the bytes end in the middle of a number";
  return 0;
}

std::int64_t Numbers::signed_number() {
  const std::uint64_t n = number();
  return n % 2 == 0 ? static_cast<std::int64_t>(n / 2) : -static_cast<std::int64_t>(n / 2) - 1;
}

std::vector<Line> lines(const std::string& bytes, double unit_mm) {
  Numbers numbers(bytes);
  std::vector<Line> out(numbers.number());
  for (Line& line : out) {
    line.left = static_cast<int>(numbers.number());
    line.right = static_cast<int>(numbers.number());
    line.points.resize(numbers.number());
    double x = 0, y = 0;
    for (auto& p : line.points) {
      x += static_cast<double>(numbers.signed_number());
      y += static_cast<double>(numbers.signed_number());
      p = {x * unit_mm, y * unit_mm};
    }
  }
  EXPECT_TRUE(numbers.at_end());
  return out;
}

double area_of(const std::vector<Line>& all, int label) {
  double area = 0;
  for (const Line& line : all) {
    const int sign = (line.left == label) - (line.right == label);
    for (std::size_t i = 0; i + 1 < line.points.size(); ++i)
      area += 0.5 * sign * (line.points[i][0] * line.points[i + 1][1] - line.points[i + 1][0] * line.points[i][1]);
  }
  return area;
}

Mesh mesh(const std::string& html, int number, const std::string& name) {
  const Json where = page_data(html)["meshes"][static_cast<std::size_t>(number)]["pictures"][name];
  const bool tets = name == "tets";
  Mesh m;
  Numbers positions(chunk(html, number, where, "positions"));
  std::array<std::int64_t, 3> at = {0, 0, 0};
  const double unit = where["unit_mm"];
  for (std::size_t i = 0; i < where["vertices"]; ++i) {
    for (auto& x : at) x += positions.signed_number();
    m.points.push_back({where["origin_mm"][0].get<double>() + unit * static_cast<double>(at[0]),
                        where["origin_mm"][1].get<double>() + unit * static_cast<double>(at[1]),
                        where["origin_mm"][2].get<double>() + unit * static_cast<double>(at[2])});
  }
  EXPECT_TRUE(positions.at_end());
  Numbers corners(chunk(html, number, where, tets ? "tets" : "triangles")),
      labels(chunk(html, number, where, "labels"));
  const std::string angles = chunk(html, number, where, "angles");
  EXPECT_EQ(angles.size(), where["elements"].get<std::size_t>());
  int first = 0;
  for (const char angle : angles) {
    std::vector<int> v = {first += static_cast<int>(corners.number())};
    for (int k = 1; k < (tets ? 4 : 3); ++k)
      v.push_back((tets ? v.back() : first) + static_cast<int>(corners.number()));
    m.elements.push_back(v);
    const int below = static_cast<int>(labels.number());
    m.labels.push_back({below, tets ? below : static_cast<int>(labels.number())});
    m.angles_deg.push_back(static_cast<std::uint8_t>(angle) / 4.0);
  }
  EXPECT_TRUE(corners.at_end());
  EXPECT_TRUE(labels.at_end());
  for (const auto& name_of_array : where["arrays"])
    if (name_of_array == "distances")
      for (const char d : chunk(html, number, where, "distances"))
        m.distances_mm.push_back(static_cast<std::uint8_t>(d) * where["distance_unit_mm"].get<double>());
  return m;
}

}  // namespace page_reader
