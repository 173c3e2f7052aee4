#pragma once
// Reads a report page as a browser's scripts do, with code of its own: blobs, zlib streams, whole numbers.
#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "model/geometry.h"

namespace page_reader {

using Json = nlohmann::json;

/// The text between the tags of the element with that id; fails the test where there is none.
std::string element_text(const std::string& html, const std::string& id);

Json page_data(const std::string& html);  ///< of the script "data"

/// Chunk number i of what a picture's {blob, offsets} describes.
std::string chunk(const std::string& html, int mesh, const Json& where, std::size_t i);
std::string chunk(const std::string& html, int mesh, const Json& where, const std::string& array);

class Numbers {
 public:
  explicit Numbers(std::string bytes) : bytes_(std::move(bytes)) {}
  std::uint64_t number();
  std::int64_t signed_number();
  bool at_end() const { return at_ == bytes_.size(); }

 private:
  std::string bytes_;
  std::size_t at_ = 0;
};

struct Line {
  int left = 0, right = 0;
  std::vector<std::array<double, 2>> points;
  bool closed() const { return points.size() > 3 && points.front() == points.back(); }
};
std::vector<Line> lines(const std::string& bytes, double unit_mm);

/// Signed area that the lines enclose of a label: the label on their left counts positive.
double area_of(const std::vector<Line>& lines, int label);

struct Mesh {
  std::vector<stackmesh::Vec3> points;
  std::vector<std::vector<int>> elements;  ///< three or four corners
  std::vector<std::array<int, 2>> labels;  ///< below and above; of tets the same twice
  std::vector<double> angles_deg, distances_mm;
};
Mesh mesh(const std::string& html, int number, const std::string& name);

}  // namespace page_reader
