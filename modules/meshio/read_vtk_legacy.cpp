// VTK's legacy files, 2.0 to 5.1, text and binary (big endian): PolyData and UnstructuredGrid.
#include <algorithm>

#include "base/text.h"
#include "meshio/raw_mesh.h"

namespace stackmesh {
namespace {

class LegacyReader {
 public:
  LegacyReader(MeshBytes& in, RawMesh& mesh) : in_(in), mesh_(mesh) {}

  void run() {
    std::string_view text;
    in_.line(text);
    if (lower_case(text).rfind("# vtk datafile version", 0) != 0)
      in_.fail("the file does not begin with '# vtk DataFile Version'");
    const auto version = to_number(trimmed(text.substr(22)));
    offsets_ = version && *version >= 5;
    if (!in_.line(text)) in_.fail("the file has no title");
    mesh_.note_space(text);
    const std::string kind = lower_case(in_.word());
    if (kind != "ascii" && kind != "binary") in_.fail("neither ASCII nor BINARY");
    text_ = kind == "ascii";
    if (lower_case(in_.word()) != "dataset") in_.fail("no DATASET");
    const std::string dataset = lower_case(in_.word());
    if (dataset != "polydata" && dataset != "unstructured_grid")
      in_.fail_plainly("the file holds " + dataset + ", not POLYDATA or UNSTRUCTURED_GRID",
                       "write the mesh as one of these");
    for (std::string key = lower_case(in_.word()); !key.empty(); key = lower_case(in_.word())) section(key);
    emit();
  }

 private:
  struct Cells {
    std::vector<std::int64_t> ends, nodes;
  };

  void section(const std::string& key) {
    if (key == "points") {
      const std::size_t n = in_.count(in_.integer("a count of points"), text_ ? 5 : 3, "points");
      const std::vector<double> v = numbers(3 * n, type_of(in_.word()), "points");
      for (std::size_t i = 0; i < n; ++i) mesh_.points.push_back({v[3 * i], v[3 * i + 1], v[3 * i + 2]});
    } else if (key == "polygons") {
      polygons_ = cells();
    } else if (key == "triangle_strips") {
      strips_ = cells();
    } else if (key == "vertices" || key == "lines") {
      others_ += cells().ends.size();
    } else if (key == "cells") {
      grid_ = cells();
    } else if (key == "cell_types") {
      const std::size_t n = in_.count(in_.integer("a count of cells"), 2, "cell types");
      types_ = wholes(n, Scalar::i32, "cell types");
    } else if (key == "cell_data" || key == "point_data") {
      of_cells_ = key == "cell_data";
      tuples_ = in_.count(in_.integer("a count of values"), 0, "values");
    } else if (key == "field") {
      field();
    } else if (key == "scalars") {
      scalars();
    } else if (key == "vectors" || key == "normals") {
      const std::string_view name = in_.word();
      data(std::string(name), 3, type_of(in_.word()));
    } else if (key == "tensors" || key == "tensors6") {
      const std::string_view name = in_.word();
      data(std::string(name), key == "tensors" ? 9 : 6, type_of(in_.word()));
    } else if (key == "texture_coordinates") {
      const std::string_view name = in_.word();
      const std::size_t parts = in_.count(in_.integer("a dimension"), 0, "components");
      data(std::string(name), parts, type_of(in_.word()));
    } else if (key == "color_scalars") {
      const std::string_view name = in_.word();
      const std::size_t parts = in_.count(in_.integer("a number of components"), 0, "components");
      data(std::string(name), parts, text_ ? Scalar::f32 : Scalar::u8);
    } else if (key == "global_ids" || key == "pedigree_ids") {
      const std::string_view name = in_.word();
      data(std::string(name), 1, type_of(in_.word()));
    } else if (key == "lookup_table") {
      in_.word();
      const std::size_t n = in_.count(in_.integer("a size"), 1, "table entries");
      numbers(4 * n, text_ ? Scalar::f32 : Scalar::u8, "a lookup table");
    } else if (key == "metadata") {
      std::string_view text;  // until an empty line
      in_.line(text);
      while (in_.line(text) && !trimmed(text).empty()) {
      }
    } else {
      in_.fail("an unknown section of a VTK file");
    }
  }

  Scalar type_of(std::string_view name) const {
    const std::optional<Scalar> type = scalar_type(name);
    if (!type) in_.fail("an unknown type of numbers");
    return *type;
  }

  /// In binary files the data begin after the line's end.
  const char* block(std::size_t count, Scalar type, const char* what) {
    std::string_view rest;
    in_.line(rest);
    if (!trimmed(rest).empty()) in_.fail(std::string("the line before ") + what + " is too long");
    if (count > in_.left()) in_.fail(std::string("the file ends within its ") + what);
    return in_.take(count * size_of(type), what).data();
  }

  std::vector<double> numbers(std::size_t count, Scalar type, const char* what) {
    std::vector<double> v;
    if (text_) {
      v.reserve(in_.count(static_cast<std::int64_t>(count), 1, what));
      for (std::size_t i = 0; i < count; ++i) v.push_back(in_.number(what));
      return v;
    }
    const char* bytes = block(count, type, what);
    v.reserve(count);
    for (std::size_t i = 0; i < count; ++i) v.push_back(read_scalar(bytes + i * size_of(type), type, true));
    return v;
  }

  std::vector<std::int64_t> wholes(std::size_t count, Scalar type, const char* what) {
    std::vector<std::int64_t> v;
    if (text_) {
      v.reserve(in_.count(static_cast<std::int64_t>(count), 1, what));
      for (std::size_t i = 0; i < count; ++i) v.push_back(in_.integer(what));
      return v;
    }
    const char* bytes = block(count, type, what);
    v.reserve(count);
    for (std::size_t i = 0; i < count; ++i) v.push_back(read_integer(bytes + i * size_of(type), type, true));
    return v;
  }

  /// Either n and the total of numbers, then count and nodes of each; or (5.x) offsets and connectivity.
  Cells cells() {
    const std::int64_t first = in_.integer("a count of cells"), second = in_.integer("a size of cells");
    Cells c;
    if (offsets_) {
      const auto array = [&](const char* name, std::int64_t size) {
        if (lower_case(in_.word()) != name) in_.fail(std::string("no ") + name);
        const Scalar type = type_of(in_.word());
        return wholes(in_.count(size, text_ ? 1 : size_of(type), "cells"), type, name);
      };
      if (first == 0) return c;
      c.ends = array("offsets", first);
      c.nodes = array("connectivity", second);
      if (c.ends[0] != 0) in_.fail("the first offset is not 0");
      c.ends.erase(c.ends.begin());
      std::int64_t before = 0;
      for (const std::int64_t end : c.ends) {
        if (end < before || end > second) in_.fail("an offset outside the connectivity");
        before = end;
      }
      return c;
    }
    const std::size_t n = in_.count(first, text_ ? 2 : 4, "cells"),
                      total = in_.count(second, text_ ? 1 : 4, "cell numbers");
    const std::vector<std::int64_t> v = wholes(total, Scalar::i32, "cells");
    std::size_t at = 0;
    c.nodes.reserve(total);
    for (std::size_t i = 0; i < n; ++i) {
      if (at >= total || v[at] < 0 || static_cast<std::uint64_t>(v[at]) > total - at - 1)
        in_.fail("cell " + std::to_string(i) + " has more nodes than are there");
      c.nodes.insert(c.nodes.end(), v.begin() + static_cast<std::ptrdiff_t>(at) + 1,
                     v.begin() + static_cast<std::ptrdiff_t>(at + 1) + v[at]);
      at += 1 + static_cast<std::size_t>(v[at]);
      c.ends.push_back(static_cast<std::int64_t>(c.nodes.size()));
    }
    return c;
  }

  void scalars() {
    const std::string name(in_.word());
    std::string_view rest;
    in_.line(rest);
    MeshBytes words(in_.path(), rest);
    const Scalar type = type_of(words.word());
    std::int64_t parts = 1;
    if (const auto n = to_integer(words.word())) parts = *n;
    if (parts < 1 || parts > 9) in_.fail("an odd number of components");
    // The table's line is optional in practice.
    const char* here = in_.position();
    if (in_.line(rest) && lower_case(trimmed(rest)).rfind("lookup_table", 0) != 0) in_.seek(here);
    after_line_ = true;
    data(name, static_cast<std::size_t>(parts), type);
  }

  void data(const std::string& name, std::size_t parts, Scalar type) {
    if (parts > 16 || tuples_ > in_.left()) in_.fail("the file ends within its data");
    std::vector<double> v;
    if (after_line_ && !text_) {
      after_line_ = false;
      const std::size_t count = tuples_ * parts;
      const char* bytes = in_.take(count * size_of(type), "data").data();
      if (of_cells_ && parts == 1)
        for (std::size_t i = 0; i < count; ++i) v.push_back(read_scalar(bytes + i * size_of(type), type, true));
    } else {
      after_line_ = false;
      v = numbers(tuples_ * parts, type, "data");
    }
    if (of_cells_ && parts == 1) mesh_.arrays.push_back({name, std::move(v)});
  }

  void field() {
    in_.word();
    const std::int64_t arrays = in_.integer("a count of arrays");
    for (std::int64_t a = 0; a < arrays; ++a) {
      const std::string name(in_.word());
      if (name.empty()) in_.fail("the file ends within its field data");
      if (lower_case(name) == "metadata") {
        std::string_view text;
        in_.line(text);
        while (in_.line(text) && !trimmed(text).empty()) {
        }
        --a;
        continue;
      }
      const std::size_t parts = in_.count(in_.integer("a number of components"), 0, "components");
      const std::size_t tuples = in_.count(in_.integer("a count"), 0, "values");
      const std::string type = lower_case(in_.word());
      if (parts > 0 && tuples > in_.left() / parts) in_.fail("the file ends within array '" + name + "'");
      if (type == "string") {
        strings(name, parts * tuples);
      } else if (name == "SPACE") {
        characters(parts * tuples, type_of(type));
      } else {
        std::vector<double> v = numbers(parts * tuples, type_of(type), "field data");
        if (of_cells_ && parts == 1 && tuples == tuples_) mesh_.arrays.push_back({name, std::move(v)});
      }
    }
  }

  /// Our own mark: the letters as `char`.
  void characters(std::size_t count, Scalar type) {
    std::string text;
    if (text_ || size_of(type) != 1) {
      const char* here = in_.position();
      const std::string word(in_.word());
      if (!word.empty() && word[0] >= 'A') {
        text = word;
      } else {
        in_.seek(here);
        for (const double v : numbers(count, type, "field data"))
          if (v > 0 && v < 127) text += static_cast<char>(v);
      }
    } else {
      text = std::string(block(count, type, "field data"), count);
    }
    mesh_.note_space("SPACE=" + text);
  }

  void strings(const std::string& name, std::size_t count) {
    std::string_view rest;
    in_.line(rest);
    for (std::size_t i = 0; i < count; ++i) {
      std::string text;
      if (text_) {
        if (!in_.line(rest)) in_.fail("the file ends within its strings");
        text = rest;
      } else {  // the length in 1, 2, 4 or 8 bytes, which the first two bits tell
        const unsigned first = static_cast<unsigned char>(in_.take(1, "strings")[0]);
        const int more = first >> 6 == 3 ? 0 : first >> 6 == 2 ? 1 : first >> 6 == 1 ? 3 : 7;
        std::uint64_t length = first & 63u;
        for (int k = 0; k < more; ++k) length = length << 8 | static_cast<unsigned char>(in_.take(1, "strings")[0]);
        text = in_.take(length, "strings");
      }
      if (name == "SPACE") mesh_.note_space("SPACE=" + text);
    }
  }

  void emit() {
    mesh_.cells = static_cast<std::int64_t>(others_);
    const auto add = [&](const Cells& c, auto type_of_cell) {
      std::int64_t begin = 0;
      for (std::size_t i = 0; i < c.ends.size(); ++i) {
        mesh_.add_cell(type_of_cell(i), c.nodes.data() + begin, static_cast<std::size_t>(c.ends[i] - begin));
        begin = c.ends[i];
      }
    };
    add(polygons_, [](std::size_t) { return vtk_cell::polygon; });
    add(strips_, [](std::size_t) { return vtk_cell::strip; });
    if (grid_.ends.size() != types_.size())
      in_.fail(std::to_string(grid_.ends.size()) + " cells, but " + std::to_string(types_.size()) + " cell types");
    add(grid_, [&](std::size_t i) { return static_cast<int>(types_[i]); });
  }

  MeshBytes& in_;
  RawMesh& mesh_;
  bool text_ = false, offsets_ = false, of_cells_ = false, after_line_ = false;
  std::size_t tuples_ = 0, others_ = 0;
  Cells polygons_, strips_, grid_;
  std::vector<std::int64_t> types_;
};

}  // namespace

void read_vtk_legacy(MeshBytes& in, RawMesh& mesh) {
  LegacyReader(in, mesh).run();
}

}  // namespace stackmesh
