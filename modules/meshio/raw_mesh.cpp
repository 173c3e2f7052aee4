#include "meshio/raw_mesh.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/text.h"

namespace stackmesh {
namespace {

constexpr const char* kMend = "write or copy the file again";

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\v' || c == '\f';
}

template <class T>
T load(const char* bytes, bool swap) {
  char copy[sizeof(T)];
  for (std::size_t i = 0; i < sizeof(T); ++i) copy[i] = bytes[swap ? sizeof(T) - 1 - i : i];
  T value;
  std::memcpy(&value, copy, sizeof(T));
  return value;
}

std::string quoted(std::string_view text) {
  std::string clean;
  for (const char c : text.substr(0, 24))
    clean += static_cast<unsigned char>(c) < 32 || static_cast<unsigned char>(c) > 126 ? '?' : c;
  return "'" + clean + (text.size() > 24 ? "..." : "") + "'";
}

/// VTK's name of a cell type in plain words.
std::string kind_of(int vtk_type) {
  switch (vtk_type) {
    case 11:
      return "voxels";
    case 12:
    case 25:
    case 29:
      return "hexahedra";
    case 13:
    case 26:
      return "wedges";
    case 14:
    case 27:
      return "pyramids";
    default:
      return "cells of VTK type " + std::to_string(vtk_type);
  }
}

/// -1 where it is none, or too large for one.
std::int32_t index(std::int64_t i) {
  return i < 0 || i > std::numeric_limits<std::int32_t>::max() ? -1 : static_cast<std::int32_t>(i);
}

}  // namespace

void MeshBytes::fail(const std::string& what) const {
  fail_input(what, path_ + ", byte " + std::to_string(at_ - begin_), kMend);
}

void MeshBytes::fail_plainly(const std::string& what, const std::string& mend) const {
  fail_input(what, path_, mend);
}

bool MeshBytes::line(std::string_view& text) {
  if (at_ == end_) return false;
  const char* stop = static_cast<const char*>(std::memchr(at_, '\n', left()));
  const char* last = stop ? stop : end_;
  text = {at_, static_cast<std::size_t>(last - at_)};
  if (!text.empty() && text.back() == '\r') text.remove_suffix(1);
  at_ = stop ? stop + 1 : end_;
  return true;
}

std::string_view MeshBytes::word(char comment) {
  for (;;) {
    while (at_ != end_ && is_blank(*at_)) ++at_;
    if (comment == '\0' || at_ == end_ || *at_ != comment) break;
    while (at_ != end_ && *at_ != '\n') ++at_;
  }
  const char* from = at_;
  while (at_ != end_ && !is_blank(*at_)) ++at_;
  return {from, static_cast<std::size_t>(at_ - from)};
}

double MeshBytes::number(const char* what, char comment) {
  const std::string_view text = word(comment);
  const std::optional<double> value = to_number(text);
  if (!value)
    fail(text.empty() ? std::string("the file ends within its ") + what
                      : quoted(text) + " where " + what + " should be");
  return *value;
}

std::int64_t MeshBytes::integer(const char* what, char comment) {
  const std::string_view text = word(comment);
  const std::optional<std::int64_t> value = to_integer(text);
  if (!value)
    fail(text.empty() ? std::string("the file ends within its ") + what
                      : quoted(text) + " where " + what + " should be");
  return *value;
}

std::size_t MeshBytes::count(std::int64_t claimed, std::size_t bytes_each, const std::string& what) const {
  if (claimed < 0) fail("a negative count of " + what);
  if (static_cast<std::uint64_t>(claimed) > left() / std::max<std::size_t>(1, bytes_each))
    fail("the file claims " + std::to_string(claimed) + " " + what + ", but ends before they could be there");
  return static_cast<std::size_t>(claimed);
}

std::string_view MeshBytes::take(std::size_t size, const std::string& what) {
  if (size > left()) fail("the file ends within its " + what);
  const std::string_view bytes(at_, size);
  at_ += size;
  return bytes;
}

std::optional<double> to_number(std::string_view text) {
  if (!text.empty() && text[0] == '+') text.remove_prefix(1);
  double value = 0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  if (result.ec == std::errc::result_out_of_range && result.ptr == text.data() + text.size()) {
    const auto e = text.find_first_of("eE");  // below the smallest number is 0; beyond the largest is none
    return e != std::string_view::npos && e + 1 < text.size() && text[e + 1] == '-'
               ? 0.0
               : std::numeric_limits<double>::infinity();
  }
  if (text.empty() || result.ec != std::errc() || result.ptr != text.data() + text.size()) return std::nullopt;
  return value;
}

std::optional<std::int64_t> to_integer(std::string_view text) {
  if (!text.empty() && text[0] == '+') text.remove_prefix(1);
  std::int64_t value = 0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || result.ec != std::errc() || result.ptr != text.data() + text.size()) return std::nullopt;
  return value;
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

std::size_t size_of(Scalar type) {
  switch (type) {
    case Scalar::i8:
    case Scalar::u8:
      return 1;
    case Scalar::i16:
    case Scalar::u16:
      return 2;
    case Scalar::i32:
    case Scalar::u32:
    case Scalar::f32:
      return 4;
    default:
      return 8;
  }
}

std::optional<Scalar> scalar_type(std::string_view name) {
  static const std::map<std::string, Scalar, std::less<>> kTypes = {{"char", Scalar::i8},
                                                                    {"int8", Scalar::i8},
                                                                    {"uchar", Scalar::u8},
                                                                    {"uint8", Scalar::u8},
                                                                    {"unsigned_char", Scalar::u8},
                                                                    {"bit", Scalar::u8},
                                                                    {"short", Scalar::i16},
                                                                    {"int16", Scalar::i16},
                                                                    {"ushort", Scalar::u16},
                                                                    {"uint16", Scalar::u16},
                                                                    {"unsigned_short", Scalar::u16},
                                                                    {"int", Scalar::i32},
                                                                    {"int32", Scalar::i32},
                                                                    {"uint", Scalar::u32},
                                                                    {"uint32", Scalar::u32},
                                                                    {"unsigned_int", Scalar::u32},
                                                                    {"long", Scalar::i64},
                                                                    {"int64", Scalar::i64},
                                                                    {"vtktypeint64", Scalar::i64},
                                                                    {"vtkidtype", Scalar::i64},
                                                                    {"unsigned_long", Scalar::u64},
                                                                    {"uint64", Scalar::u64},
                                                                    {"float", Scalar::f32},
                                                                    {"float32", Scalar::f32},
                                                                    {"double", Scalar::f64},
                                                                    {"float64", Scalar::f64},
                                                                    {"vtktypeint32", Scalar::i32}};
  const auto it = kTypes.find(lower_case(name));
  if (it == kTypes.end()) return std::nullopt;
  return it->second;
}

double read_scalar(const char* bytes, Scalar type, bool swap) {
  if (type == Scalar::f32) return static_cast<double>(load<float>(bytes, swap));
  if (type == Scalar::f64) return load<double>(bytes, swap);
  if (type == Scalar::u64) return static_cast<double>(load<std::uint64_t>(bytes, swap));
  return static_cast<double>(read_integer(bytes, type, swap));
}

std::int64_t read_integer(const char* bytes, Scalar type, bool swap) {
  switch (type) {
    case Scalar::i8:
      return static_cast<std::int8_t>(*bytes);
    case Scalar::u8:
      return static_cast<std::uint8_t>(*bytes);
    case Scalar::i16:
      return load<std::int16_t>(bytes, swap);
    case Scalar::u16:
      return load<std::uint16_t>(bytes, swap);
    case Scalar::i32:
      return load<std::int32_t>(bytes, swap);
    case Scalar::u32:
      return load<std::uint32_t>(bytes, swap);
    case Scalar::i64:
      return load<std::int64_t>(bytes, swap);
    case Scalar::u64:
      return static_cast<std::int64_t>(load<std::uint64_t>(bytes, swap));
    case Scalar::f32:
    case Scalar::f64:
      break;
  }
  const double value = type == Scalar::f32 ? static_cast<double>(load<float>(bytes, swap)) : load<double>(bytes, swap);
  return value > -9e18 && value < 9e18 ? std::llround(value) : -1;
}

void RawMesh::add_triangle(std::int64_t a, std::int64_t b, std::int64_t c) {
  // Whether the point is there is checked when the whole file is known; what no index can be becomes -1.
  triangles.push_back({index(a), index(b), index(c)});
  triangle_cell.push_back(static_cast<std::int32_t>(cells));
}

void RawMesh::add_wedge(const std::array<std::int64_t, 15>& nodes, bool second_order) {
  auto& corners = wedges.emplace_back();
  for (int k = 0; k < 6; ++k) corners[k] = index(nodes[k]);
  wedge_cell.push_back(static_cast<std::int32_t>(cells));
  if (!second_order) return;
  has_quadratic = true;
  std::array<std::int32_t, 9> linear;
  linear.fill(-1);
  wedge_midside.resize(wedges.size() - 1, linear);
  auto& mid = wedge_midside.emplace_back();
  for (int k = 0; k < 9; ++k) mid[k] = index(nodes[6 + k]);
}

void RawMesh::add_polygon(const std::int64_t* nodes, std::size_t count) {
  if (count > 3) ++polygons;
  for (std::size_t i = 1; i + 1 < count; ++i) add_triangle(nodes[0], nodes[i], nodes[i + 1]);
  ++cells;
}

void RawMesh::add_strip(const std::int64_t* n, std::size_t count) {
  ++strips;
  for (std::size_t i = 0; i + 2 < count; ++i) {
    if (i % 2 == 0) add_triangle(n[i], n[i + 1], n[i + 2]);
    else add_triangle(n[i + 1], n[i], n[i + 2]);
  }
}

void RawMesh::add_tet(const std::int64_t* n, bool second_order) {
  tets.push_back({index(n[0]), index(n[1]), index(n[2]), index(n[3])});
  tet_cell.push_back(static_cast<std::int32_t>(cells));
  if (!second_order) return;
  has_quadratic = true;
  midside.resize(tets.size() - 1, {-1, -1, -1, -1, -1, -1});
  midside.push_back({index(n[4]), index(n[5]), index(n[6]), index(n[7]), index(n[8]), index(n[9])});
}

void RawMesh::add_wedge_cell(int type, const std::int64_t* n, std::size_t count) {
  using namespace vtk_cell;
  const bool is_pyramid = type == pyramid || type == quadratic_pyramid;
  const bool second = type == quadratic_wedge || type == quadratic_pyramid;
  if (count != (is_pyramid ? (second ? 13u : 5u) : (second ? 15u : 6u))) {
    ++unsupported[kind_of(type)];
    return;
  }
  std::array<std::int64_t, 15> nodes = {};
  if (!is_pyramid) std::copy(n, n + count, nodes.begin());
  else if (!second) nodes = {n[0], n[3], n[4], n[1], n[2], n[4]};
  else nodes = {n[0], n[3], n[4], n[1], n[2], n[4], n[8], n[12], n[9], n[6], n[11], n[10], n[5], n[7], n[4]};
  add_wedge(nodes, second);
}

void RawMesh::add_cell(int type, const std::int64_t* n, std::size_t count) {
  using namespace vtk_cell;
  const auto wants = [&](std::size_t nodes) {
    if (count != nodes)
      fail_input("a cell of VTK type " + std::to_string(type) + " with " + std::to_string(count) + " nodes",
                 path + ", cell " + std::to_string(cells), kMend);
  };
  switch (type) {
    case vertex:
    case poly_vertex:
    case line:
    case poly_line:
    case quadratic_edge:
      break;
    case triangle:
      wants(3);
      add_triangle(n[0], n[1], n[2]);
      break;
    case quadratic_triangle:
      wants(6);
      ++quadratic_triangles;
      add_triangle(n[0], n[1], n[2]);
      break;
    case quad:
      wants(4);
      add_polygon(n, 4);
      return;
    case quadratic_quad:
      wants(8);
      add_polygon(n, 4);
      return;
    case polygon:
      add_polygon(n, count);
      return;
    case strip:
      add_strip(n, count);
      break;
    case tet:
    case quadratic_tet:
      wants(type == tet ? 4 : 10);
      add_tet(n, type == quadratic_tet);
      break;
    case wedge:
    case quadratic_wedge:
    case pyramid:
    case quadratic_pyramid:
      add_wedge_cell(type, n, count);
      break;
    default:
      ++unsupported[kind_of(type)];
  }
  ++cells;
}

void RawMesh::note_space(std::string_view comment) {
  const std::string text = lower_case(comment);
  if (text.find("space=lps") != std::string::npos) space = "LPS";
  if (text.find("space=ras") != std::string::npos) space = "RAS";
}

}  // namespace stackmesh
