// VTP and VTU: text, base64 (inline or appended) and raw appended arrays, plain or zlib-compressed.
#include <zlib.h>

#include <algorithm>
#include <pugixml.hpp>

#include "base/error.h"
#include "base/text.h"
#include "meshio/raw_mesh.h"

namespace stackmesh {
namespace {

/// An array as it lies in memory, or as numbers where the file has text.
struct Values {
  std::string bytes;
  Scalar type = Scalar::f64;
  bool swap = false;
  std::vector<double> numbers;       // of text
  std::vector<std::int64_t> wholes;  // of text of a whole-number type
  bool text = false;

  std::size_t size() const {
    return !text ? bytes.size() / size_of(type) : numbers.empty() ? wholes.size() : numbers.size();
  }
  double number(std::size_t i) const {
    if (text) return numbers.empty() ? static_cast<double>(wholes[i]) : numbers[i];
    return read_scalar(bytes.data() + i * size_of(type), type, swap);
  }
  std::int64_t whole(std::size_t i) const {
    if (text) return numbers.empty() ? wholes[i] : std::llround(std::clamp(numbers[i], -9e18, 9e18));
    return read_integer(bytes.data() + i * size_of(type), type, swap);
  }
};

int base64_value(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  return c == '+' ? 62 : c == '/' ? 63 : -1;
}

/// Decodes from `at` until `wanted` bytes are there or an end mark or other sign comes; `at` then stands behind the
/// quartet. Each block of VTK's base64 is padded by itself.
std::string decode_base64(std::string_view text, std::size_t& at, std::size_t wanted) {
  std::string out;
  out.reserve(std::min(wanted, text.size() / 4 * 3 + 3));
  while (out.size() < wanted) {
    int v[4], n = 0;
    bool padded = false;
    while (n < 4 && at < text.size()) {
      const char c = text[at];
      if (c == '=') {
        ++at, padded = true, v[n++] = 0;
        continue;
      }
      const int value = base64_value(c);
      if (value < 0) {
        if (c != ' ' && c != '\n' && c != '\r' && c != '\t') return out;
        ++at;
        continue;
      }
      if (padded) return out;
      v[n++] = value, ++at;
    }
    if (n < 4) return out;
    int pads = padded ? (text[at - 1] == '=') + (at >= 2 && text[at - 2] == '=') : 0;
    const int word = v[0] << 18 | v[1] << 12 | v[2] << 6 | v[3];
    const char bytes[3] = {static_cast<char>(word >> 16), static_cast<char>(word >> 8), static_cast<char>(word)};
    out.append(bytes, static_cast<std::size_t>(3 - pads));
    if (pads > 0) return out;
  }
  return out;
}

class XmlReader {
 public:
  XmlReader(MeshBytes& in, RawMesh& mesh) : in_(in), mesh_(mesh) {}

  void run() {
    parse();
    const pugi::xml_node file = document_.child("VTKFile");
    if (!file) in_.fail_plainly("the file is not a VTK XML file", "write it as .vtp or .vtu");
    swap_ = std::string_view(file.attribute("byte_order").value()) == "BigEndian";
    wide_header_ = std::string_view(file.attribute("header_type").value()) == "UInt64";
    const std::string compressor = file.attribute("compressor").value();
    compressed_ = !compressor.empty();
    if (compressed_ && compressor != "vtkZLibDataCompressor")
      in_.fail_plainly("the arrays are compressed with " + compressor, "write it with zlib or without compression");
    const bool surface = file.child("PolyData"), grid = file.child("UnstructuredGrid");
    if (!surface && !grid)
      in_.fail_plainly(
          "the file holds '" + std::string(file.attribute("type").value()) + "', not PolyData or an UnstructuredGrid",
          "write the mesh as one of these");
    const pugi::xml_node data = file.child(surface ? "PolyData" : "UnstructuredGrid");
    read_space(data);
    int pieces = 0;
    for (const pugi::xml_node piece : data.children("Piece")) {
      ++pieces;
      surface ? read_surface(piece) : read_grid(piece);
    }
    if (pieces == 0) in_.fail("the file has no piece");
  }

 private:
  /// Raw appended bytes are no XML: they are cut off before the text is parsed.
  void parse() {
    const std::string_view all = in_.rest();
    std::string_view text = all;
    const std::size_t cut = all.find("<AppendedData");
    std::string head;
    if (cut != std::string_view::npos) {
      const std::size_t open = all.find('>', cut), mark = open == std::string_view::npos ? open : all.find('_', open);
      if (mark == std::string_view::npos) in_.fail("the appended data do not begin");
      const std::string_view tag = all.substr(cut, open - cut);
      appended_raw_ = tag.find("raw") != std::string_view::npos;
      appended_ = all.substr(mark + 1);
      head = std::string(all.substr(0, cut)) + "</VTKFile>";
      text = head;
    }
    const pugi::xml_parse_result result =
        document_.load_buffer(text.data(), text.size(), pugi::parse_default | pugi::parse_comments);
    if (!result)
      in_.fail_plainly(std::string("the XML cannot be read (") + result.description() + ", byte " +
                           std::to_string(result.offset) + ")",
                       "write or copy the file again");
    for (const pugi::xml_node node : document_.child("VTKFile").first_child().children())
      if (node.type() == pugi::node_comment) mesh_.note_space(node.value());
  }

  void read_space(const pugi::xml_node& data) {
    for (const pugi::xml_node array : data.child("FieldData").children()) {
      if (std::string_view(array.attribute("Name").value()) != "SPACE") continue;
      std::string text;
      const std::string_view type = array.attribute("type").value();
      if (type == "String" && std::string_view(array.attribute("format").value()) == "ascii") {
        MeshBytes words(in_.path(), array.child_value());
        for (std::string_view w = words.word(); !w.empty() && text.size() < 16; w = words.word())
          if (const auto code = to_integer(w); code && *code > 0) text += static_cast<char>(*code);
      } else if (scalar_type(type) || type == "String") {
        const Values v = read_values(array, type == "String" ? Scalar::u8 : *scalar_type(type), "field data");
        for (std::size_t i = 0; i < std::min<std::size_t>(16, v.size()); ++i)
          if (v.whole(i) > 0) text += static_cast<char>(v.whole(i));
      }
      mesh_.note_space("SPACE=" + text);
    }
  }

  std::uint64_t header_number(const std::string& bytes, std::size_t i) const {
    const Scalar type = wide_header_ ? Scalar::u64 : Scalar::u32;
    return static_cast<std::uint64_t>(read_integer(bytes.data() + i * size_of(type), type, swap_));
  }

  /// Bytes of an encoded array from `source`, which is base64 or raw.
  std::string decode(std::string_view source, bool raw, const std::string& name) const {
    const std::size_t word = wide_header_ ? 8 : 4;
    std::size_t at = 0;
    const auto fetch = [&](std::uint64_t size, std::size_t& from) {
      if (size > source.size())
        in_.fail_plainly("array '" + name + "' claims more bytes than the file has", "write or copy the file again");
      std::string bytes;
      if (raw) {
        if (size > source.size() - std::min(from, source.size()))
          in_.fail_plainly("the file ends within array '" + name + "'", "write or copy the file again");
        bytes = source.substr(from, size);
        from += size;
      } else {
        bytes = decode_base64(source, from, size);
        if (bytes.size() < size)
          in_.fail_plainly("the file ends within array '" + name + "'", "write or copy the file again");
      }
      return bytes;
    };
    if (!compressed_) {
      if (raw) {
        const std::string header = fetch(word, at);
        return fetch(header_number(header, 0), at);
      }
      // Header and data are one run of base64.
      std::size_t begin = 0;
      const std::string header = fetch(word, begin);
      const std::uint64_t size = header_number(header, 0);
      if (size > source.size())
        in_.fail_plainly("array '" + name + "' claims more bytes than the file has", "write or copy the file again");
      if (begin > 0 && source[begin - 1] == '=') {  // or two, each padded
        std::string bytes = fetch(size, begin);
        bytes.resize(size);
        return bytes;
      }
      std::string bytes = fetch(word + size, at);
      bytes.resize(word + size);
      return bytes.substr(word);
    }
    // blocks, size of a block, size of the last one (0: full), compressed size of each
    std::size_t begin = 0;
    const std::string counts = fetch(word, begin);
    const std::uint64_t blocks = header_number(counts, 0);
    if (blocks > source.size())
      in_.fail_plainly("array '" + name + "' claims more bytes than the file has", "write or copy the file again");
    const std::string header = fetch(word * (3 + blocks), at);
    const std::uint64_t block_size = header_number(header, 1), last_size = header_number(header, 2);
    std::uint64_t packed = 0;
    for (std::uint64_t b = 0; b < blocks; ++b) {
      const std::uint64_t size = header_number(header, 3 + b);
      if (size > source.size() || packed > source.size())
        in_.fail_plainly("array '" + name + "' claims more bytes than the file has", "write or copy the file again");
      packed += size;
    }
    const std::string data = fetch(packed, at);
    std::string bytes;
    const char* from = data.data();
    for (std::uint64_t b = 0; b < blocks; ++b) {
      const std::uint64_t size = header_number(header, 3 + b);
      const std::uint64_t plain = b + 1 == blocks && last_size > 0 ? last_size : block_size;
      if (plain / 1032 > size + 64)
        in_.fail_plainly("array '" + name + "' claims more than zlib can hold", "write or copy the file again");
      const std::size_t old = bytes.size();
      bytes.resize(old + plain);
      uLongf got = static_cast<uLongf>(plain);
      if (uncompress(reinterpret_cast<Bytef*>(&bytes[old]), &got, reinterpret_cast<const Bytef*>(from),
                     static_cast<uLong>(size)) != Z_OK ||
          got != plain)
        in_.fail_plainly("the compressed array '" + name + "' is broken", "write or copy the file again");
      from += size;
    }
    return bytes;
  }

  Values read_values(const pugi::xml_node& array, Scalar type, const std::string& name) const {
    Values v;
    v.type = type;
    v.swap = swap_;
    const std::string_view format = array.attribute("format").value();
    if (format == "appended") {
      const std::uint64_t offset = array.attribute("offset").as_ullong();
      if (offset >= appended_.size())
        in_.fail_plainly("the appended data end before array '" + name + "'", "write or copy the file again");
      v.bytes = decode(appended_.substr(offset), appended_raw_, name);
      return v;
    }
    if (format == "binary") {
      v.bytes = decode(trimmed(array.child_value()), false, name);
      return v;
    }
    v.text = true;
    MeshBytes words(in_.path(), array.child_value());
    const bool real = type == Scalar::f32 || type == Scalar::f64;
    for (std::string_view w = words.word(); !w.empty(); w = words.word()) {
      if (real) {
        const auto n = to_number(w);
        if (!n) in_.fail_plainly("array '" + name + "' holds what is not a number", "write the file again");
        v.numbers.push_back(*n);
      } else {
        const auto n = to_integer(w);
        if (!n) in_.fail_plainly("array '" + name + "' holds what is not a whole number", "write the file again");
        v.wholes.push_back(*n);
      }
    }
    return v;
  }

  Values read_array(const pugi::xml_node& array, const std::string& what) const {
    if (!array) in_.fail_plainly("array '" + what + "' is missing", "write or copy the file again");
    const std::optional<Scalar> type = scalar_type(array.attribute("type").value());
    if (!type) in_.fail_plainly("array '" + what + "' has an unknown type", "write the file again");
    return read_values(array, *type, what);
  }

  static pugi::xml_node named(const pugi::xml_node& parent, const char* name) {
    for (const pugi::xml_node a : parent.children("DataArray"))
      if (lower_case(a.attribute("Name").value()) == name) return a;
    return {};
  }

  std::int64_t read_points(const pugi::xml_node& piece) {
    const std::int64_t first = static_cast<std::int64_t>(mesh_.points.size());
    const pugi::xml_node array = piece.child("Points").child("DataArray");
    if (!array) {
      if (piece.attribute("NumberOfPoints").as_llong() == 0) return first;
      in_.fail_plainly("the points are missing", "write or copy the file again");
    }
    const Values v = read_array(array, "Points");
    const std::int64_t claimed = piece.attribute("NumberOfPoints").as_llong(-1);
    if (claimed < 0 || v.size() % 3 != 0 || static_cast<std::uint64_t>(claimed) != v.size() / 3)
      in_.fail_plainly(
          "the file claims " + std::to_string(claimed) + " points, but holds " + std::to_string(v.size() / 3),
          "write or copy the file again");
    mesh_.points.reserve(mesh_.points.size() + v.size() / 3);
    for (std::size_t i = 0; i + 2 < v.size(); i += 3)
      mesh_.points.push_back({v.number(i), v.number(i + 1), v.number(i + 2)});
    return first;
  }

  /// Cells of connectivity and offsets; `types` may be one type for all.
  template <class TypeOf>
  void read_cells(const pugi::xml_node& cells, std::int64_t first, std::int64_t claimed, TypeOf type_of) {
    if (claimed == 0) return;
    const Values nodes = read_array(named(cells, "connectivity"), "connectivity"),
                 ends = read_array(named(cells, "offsets"), "offsets");
    if (claimed < 0 || static_cast<std::uint64_t>(claimed) != ends.size())
      in_.fail_plainly(
          "the file claims " + std::to_string(claimed) + " cells, but holds " + std::to_string(ends.size()),
          "write or copy the file again");
    std::vector<std::int64_t> cell;
    std::int64_t begin = 0;
    for (std::size_t i = 0; i < ends.size(); ++i) {
      const std::int64_t end = ends.whole(i);
      if (end < begin || static_cast<std::uint64_t>(end) > nodes.size())
        in_.fail_plainly("cell " + std::to_string(i) + " lies outside the connectivity",
                         "write or copy the file again");
      cell.clear();
      for (std::int64_t k = begin; k < end; ++k) {
        const std::int64_t node = nodes.whole(static_cast<std::size_t>(k));
        cell.push_back(node < 0 ? -1 : node + first);
      }
      mesh_.add_cell(type_of(i), cell.data(), cell.size());
      begin = end;
    }
  }

  void read_surface(const pugi::xml_node& piece) {
    const std::int64_t first = read_points(piece), first_cell = mesh_.cells;
    // Cell data count vertices and lines too, first.
    mesh_.cells += std::max<std::int64_t>(0, piece.attribute("NumberOfVerts").as_llong()) +
                   std::max<std::int64_t>(0, piece.attribute("NumberOfLines").as_llong());
    if (mesh_.cells > first_cell + static_cast<std::int64_t>(in_.left()))
      in_.fail("the file claims more cells than it can hold");
    read_cells(piece.child("Polys"), first, piece.attribute("NumberOfPolys").as_llong(),
               [](std::size_t) { return vtk_cell::polygon; });
    read_cells(piece.child("Strips"), first, piece.attribute("NumberOfStrips").as_llong(),
               [](std::size_t) { return vtk_cell::strip; });
    read_cell_data(piece, first_cell);
  }

  void read_grid(const pugi::xml_node& piece) {
    const std::int64_t first = read_points(piece), first_cell = mesh_.cells;
    const std::int64_t claimed = piece.attribute("NumberOfCells").as_llong();
    const pugi::xml_node cells = piece.child("Cells");
    Values types;
    if (claimed != 0) types = read_array(named(cells, "types"), "types");
    read_cells(cells, first, claimed, [&](std::size_t i) {
      if (i >= types.size()) in_.fail_plainly("the types end before the cells do", "write or copy the file again");
      return static_cast<int>(types.whole(i));
    });
    read_cell_data(piece, first_cell);
  }

  void read_cell_data(const pugi::xml_node& piece, std::int64_t first_cell) {
    for (const pugi::xml_node array : piece.child("CellData").children("DataArray")) {
      const std::string name = array.attribute("Name").value();
      if (array.attribute("NumberOfComponents").as_int(1) != 1 || !scalar_type(array.attribute("type").value()))
        continue;
      const Values v = read_array(array, name);
      if (static_cast<std::int64_t>(v.size()) != mesh_.cells - first_cell)
        in_.fail_plainly("cell array '" + name + "' has " + std::to_string(v.size()) + " values for " +
                             std::to_string(mesh_.cells - first_cell) + " cells",
                         "write or copy the file again");
      auto it = std::find_if(mesh_.arrays.begin(), mesh_.arrays.end(),
                             [&](const RawMesh::Array& a) { return a.name == name; });
      if (it == mesh_.arrays.end()) it = mesh_.arrays.insert(it, {name, {}});
      if (static_cast<std::int64_t>(it->values.size()) != first_cell) continue;  // not in every piece
      for (std::size_t i = 0; i < v.size(); ++i) it->values.push_back(v.number(i));
    }
  }

  MeshBytes& in_;
  RawMesh& mesh_;
  pugi::xml_document document_;
  std::string_view appended_;
  bool appended_raw_ = false, swap_ = false, wide_header_ = false, compressed_ = false;
};

}  // namespace

void read_vtk_xml(MeshBytes& in, RawMesh& mesh) {
  XmlReader(in, mesh).run();
}

}  // namespace stackmesh
