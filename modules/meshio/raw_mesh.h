#pragma once
// What the format readers share: a bounded cursor over the file's bytes, and the mesh as cells arrive.
#include <array>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "model/geometry.h"

namespace stackmesh {

/// The bytes of a mesh file, read from front to back; every read is checked against the end.
class MeshBytes {
 public:
  MeshBytes(const std::string& path, std::string_view bytes)
      : path_(path), begin_(bytes.data()), at_(bytes.data()), end_(bytes.data() + bytes.size()) {}

  /// @throws Error(input): WHAT, path, byte or line; ...
  [[noreturn]] void fail(const std::string& what) const;
  /// without a place in the file
  [[noreturn]] void fail_plainly(const std::string& what, const std::string& mend) const;

  const std::string& path() const { return path_; }
  std::size_t left() const { return static_cast<std::size_t>(end_ - at_); }
  bool at_end() const { return at_ == end_; }
  const char* position() const { return at_; }
  void seek(const char* to) { at_ = to; }
  std::string_view rest() const { return {at_, left()}; }

  /// The next line without its end; false at the end of the file.
  bool line(std::string_view& text);
  /// The next word between blanks and line ends; empty at the end. `comment`: from there to the line's end is blank.
  std::string_view word(char comment = '\0');
  double number(const char* what, char comment = '\0');
  std::int64_t integer(const char* what, char comment = '\0');
  /// A count, which cannot pass what the rest of the file can hold at `bytes_each`.
  std::size_t count(std::int64_t claimed, std::size_t bytes_each, const std::string& what) const;

  /// `size` bytes, which must be there.
  std::string_view take(std::size_t size, const std::string& what);
  template <class T>
  T binary(bool swap, const char* what) {
    const std::string_view bytes = take(sizeof(T), what);
    char copy[sizeof(T)];
    for (std::size_t i = 0; i < sizeof(T); ++i) copy[i] = bytes[swap ? sizeof(T) - 1 - i : i];
    T value;
    std::memcpy(&value, copy, sizeof(T));
    return value;
  }

 private:
  const std::string& path_;  // of the caller
  const char *begin_, *at_, *end_;
};

/// Number of the text, or nothing; a leading + is fine.
std::optional<double> to_number(std::string_view text);
std::optional<std::int64_t> to_integer(std::string_view text);
std::string_view trimmed(std::string_view text);

/// The elementary types of binary formats.
enum class Scalar { i8, u8, i16, u16, i32, u32, i64, u64, f32, f64 };
std::size_t size_of(Scalar type);
/// From its name in VTK, PLY and C; nothing for an unknown one.
std::optional<Scalar> scalar_type(std::string_view name);
double read_scalar(const char* bytes, Scalar type, bool swap);
/// As whole number; a float is rounded.
std::int64_t read_integer(const char* bytes, Scalar type, bool swap);

/// A mesh as its file tells it, cell by cell. Cells are numbered in the file's order, whatever they are, so
/// that arrays find them.
struct RawMesh {
  std::string path, format;
  std::vector<Vec3> points;
  std::vector<std::array<std::int32_t, 3>> triangles;
  std::vector<std::int32_t> triangle_cell;
  std::vector<std::array<std::int32_t, 4>> tets;
  std::vector<std::array<std::int32_t, 6>> midside;  ///< as MeshFile; the first is -1 for a linear tet
  std::vector<std::int32_t> tet_cell;
  std::vector<std::array<std::int32_t, 6>> wedges;         ///< and pyramids, as TetMesh; either way round
  std::vector<std::array<std::int32_t, 9>> wedge_midside;  ///< the first is -1 for a linear one
  std::vector<std::int32_t> wedge_cell;
  std::int64_t cells = 0;

  struct Array {
    std::string name;
    std::vector<double> values;  ///< one per cell
  };
  std::vector<Array> arrays;

  struct Set {
    std::string name;
    std::optional<std::int64_t> number;        ///< where the file tells it
    std::optional<std::int64_t> below, above;  ///< of an interface between two labels
  };
  std::vector<Set> sets;
  std::vector<std::int32_t> set_of_cell;  ///< index into sets or -1; empty: no sets
  struct Name {
    std::int64_t dimension, number;
    std::string text;
  };
  std::vector<Name> names;  ///< of numbers in an array (Gmsh's physical names)

  std::string space;                                              ///< "LPS" or "RAS" where a mark says so
  std::size_t polygons = 0, quadratic_triangles = 0, strips = 0;  ///< made into plain triangles
  std::map<std::string, std::size_t> unsupported;                 ///< "hexahedra" -> how many
  bool has_quadratic = false;

  /// A cell by VTK's type number and node order; advances the cell count. Nodes must be checked by finish.
  void add_cell(int vtk_type, const std::int64_t* nodes, std::size_t count);
  void add_polygon(const std::int64_t* nodes, std::size_t count);
  /// Looks for SPACE=LPS or SPACE=RAS in a comment.
  void note_space(std::string_view comment);

 private:
  /// Four corners, and six mid-side nodes of second order, in VTK's order.
  void add_tet(const std::int64_t* nodes, bool second_order);
  /// A VTK strip: every three nodes in a row are a triangle, every second one turned round.
  void add_strip(const std::int64_t* nodes, std::size_t count);
  /// A VTK wedge or pyramid of either order; one with another number of nodes is counted as unsupported.
  void add_wedge_cell(int vtk_type, const std::int64_t* nodes, std::size_t count);
  void add_wedge(const std::array<std::int64_t, 15>& nodes, bool second_order);
  void add_triangle(std::int64_t a, std::int64_t b, std::int64_t c);
};

/// VTK's cell types that are met.
namespace vtk_cell {
inline constexpr int vertex = 1, poly_vertex = 2, line = 3, poly_line = 4, triangle = 5, strip = 6, polygon = 7,
                     quad = 9, tet = 10, quadratic_edge = 21, quadratic_triangle = 22, quadratic_quad = 23, wedge = 13,
                     pyramid = 14, quadratic_tet = 24, quadratic_wedge = 26, quadratic_pyramid = 27;
}

void read_stl(MeshBytes& in, RawMesh& mesh);
void read_ply(MeshBytes& in, RawMesh& mesh);
void read_obj(MeshBytes& in, RawMesh& mesh);
void read_off(MeshBytes& in, RawMesh& mesh);
void read_vtk_xml(MeshBytes& in, RawMesh& mesh);  // .vtp and .vtu
void read_vtk_legacy(MeshBytes& in, RawMesh& mesh);
void read_msh(MeshBytes& in, RawMesh& mesh);
void read_inp(MeshBytes& in, RawMesh& mesh);
void read_medit(MeshBytes& in, RawMesh& mesh);

}  // namespace stackmesh
