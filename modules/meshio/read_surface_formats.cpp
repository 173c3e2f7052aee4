// STL, PLY, OBJ and OFF.
#include <algorithm>

#include "base/text.h"
#include "meshio/raw_mesh.h"

namespace stackmesh {
namespace {

constexpr std::size_t kStlHeader = 84, kStlTriangle = 50;

void read_binary_stl(MeshBytes& in, RawMesh& mesh, std::uint32_t count) {
  mesh.note_space(in.take(80, "header"));
  in.take(4, "count");
  mesh.points.reserve(3 * static_cast<std::size_t>(count));
  for (std::uint32_t t = 0; t < count; ++t) {
    const char* bytes = in.take(kStlTriangle, "triangles").data() + 12;
    std::int64_t corners[3];
    for (std::int64_t& corner : corners) {
      corner = static_cast<std::int64_t>(mesh.points.size());
      Vec3 p;
      p.x = read_scalar(bytes, Scalar::f32, false), p.y = read_scalar(bytes + 4, Scalar::f32, false),
      p.z = read_scalar(bytes + 8, Scalar::f32, false);
      mesh.points.push_back(p);
      bytes += 12;
    }
    mesh.add_cell(vtk_cell::triangle, corners, 3);
  }
}

void read_text_stl(MeshBytes& in, RawMesh& mesh) {
  std::string_view head;
  in.line(head);
  mesh.note_space(head);
  std::int32_t solid = head.size() > 6 ? 0 : -1;
  std::vector<std::int64_t> corners;
  bool ended = false;
  for (std::string_view word = in.word(); !word.empty(); word = in.word()) {
    const std::string key = lower_case(word);
    if (key == "vertex") {
      Vec3 p;
      p.x = in.number("a coordinate"), p.y = in.number("a coordinate"), p.z = in.number("a coordinate");
      corners.push_back(static_cast<std::int64_t>(mesh.points.size()));
      mesh.points.push_back(p);
    } else if (key == "endloop") {
      if (corners.size() < 3) in.fail("a facet with " + std::to_string(corners.size()) + " vertices");
      mesh.add_polygon(corners.data(), corners.size());
      corners.clear();
    } else if (key == "solid") {
      std::string_view name;
      in.line(name);
      mesh.note_space(name);
      ++solid;
      ended = false;
    } else if (key == "endsolid") {
      std::string_view name;
      in.line(name);
      ended = true;
    } else if (key == "facet") {
      in.word();
      for (int k = 0; k < 3; ++k) in.word();  // some programs write a normal that is not a number
    } else if (key != "outer" && key != "loop" && key != "endfacet") {
      in.fail("a word that does not belong into a text STL");
    }
  }
  if (!ended || !corners.empty()) in.fail("the file ends within its facets");
}

// ---- PLY

struct PlyProperty {
  std::string name;
  Scalar type = Scalar::f32;
  std::optional<Scalar> count_type;  // of a list
};
struct PlyElement {
  std::string name;
  std::int64_t count = 0;
  std::vector<PlyProperty> properties;
};

class PlyReader {
 public:
  PlyReader(MeshBytes& in, RawMesh& mesh) : in_(in), mesh_(mesh) {}

  void run() {
    read_header();
    bool vertices = false;
    for (const PlyElement& e : elements_) {
      std::size_t least = 0;
      for (const PlyProperty& p : e.properties)
        least += text_ ? 2 : p.count_type ? size_of(*p.count_type) : size_of(p.type);
      const std::size_t count =
          in_.count(e.count, std::max<std::size_t>(1, least) - (text_ ? 1 : 0), "'" + e.name + "'");
      if (e.name == "vertex") vertices = true, read_vertices(e, count);
      else if (e.name == "face") read_faces(e, count);
      else skip(e, count);
    }
    if (!vertices) in_.fail("the file has no element 'vertex'");
  }

 private:
  void read_header() {
    std::string_view text;
    in_.line(text);
    if (trimmed(text) != "ply") in_.fail("the file does not begin with 'ply'");
    bool format = false;
    for (;;) {
      if (!in_.line(text)) in_.fail("the file ends within its header");
      MeshBytes words(in_.path(), text);
      const std::string_view key = words.word();
      if (key == "end_header") break;
      if (key == "comment" || key == "obj_info") {
        mesh_.note_space(text);
      } else if (key == "format") {
        const std::string_view kind = words.word();
        format = true;
        text_ = kind == "ascii", swap_ = kind == "binary_big_endian";
        if (!text_ && !swap_ && kind != "binary_little_endian") in_.fail("an unknown format of PLY");
      } else if (key == "element") {
        PlyElement e;
        e.name = words.word();
        e.count = words.integer("a count");
        elements_.push_back(std::move(e));
      } else if (key == "property") {
        if (elements_.empty()) in_.fail("a property before any element");
        PlyProperty p;
        std::string_view type = words.word();
        if (type == "list") {
          p.count_type = type_of(words.word());
          type = words.word();
        }
        p.type = type_of(type);
        p.name = words.word();
        elements_.back().properties.push_back(std::move(p));
      } else if (!key.empty()) {
        in_.fail("an unknown line in the header");
      }
    }
    if (!format) in_.fail("the header tells no format");
  }

  Scalar type_of(std::string_view name) const {
    const std::optional<Scalar> type = scalar_type(name);
    if (!type) in_.fail("an unknown type of a property");
    return *type;
  }

  double value(Scalar type) {
    if (text_) return in_.number("values");
    return read_scalar(in_.take(size_of(type), "values").data(), type, swap_);
  }
  std::int64_t whole(Scalar type) {
    if (text_) return in_.integer("values");
    return read_integer(in_.take(size_of(type), "values").data(), type, swap_);
  }

  void read_list(const PlyProperty& p, std::vector<std::int64_t>& list) {
    const std::size_t size = in_.count(whole(*p.count_type), text_ ? 1 : size_of(p.type), "list entries");
    list.clear();
    for (std::size_t i = 0; i < size; ++i) {
      if (p.type == Scalar::f32 || p.type == Scalar::f64) value(p.type), list.push_back(-1);
      else list.push_back(whole(p.type));
    }
  }

  void read_vertices(const PlyElement& e, std::size_t count) {
    int at[3] = {-1, -1, -1};
    for (std::size_t k = 0; k < e.properties.size(); ++k)
      for (int c = 0; c < 3; ++c)
        if (e.properties[k].name == std::string(1, "xyz"[c])) at[c] = static_cast<int>(k);
    if (at[0] < 0 || at[1] < 0 || at[2] < 0) in_.fail("the vertices have no x, y and z");
    mesh_.points.reserve(count);
    std::vector<std::int64_t> list;
    for (std::size_t i = 0; i < count; ++i) {
      double p[3] = {0, 0, 0};
      for (std::size_t k = 0; k < e.properties.size(); ++k) {
        if (e.properties[k].count_type) {
          read_list(e.properties[k], list);
          continue;
        }
        const double v = value(e.properties[k].type);
        for (int c = 0; c < 3; ++c)
          if (at[c] == static_cast<int>(k)) p[c] = v;
      }
      mesh_.points.push_back({p[0], p[1], p[2]});
    }
  }

  void read_faces(const PlyElement& e, std::size_t count) {
    std::vector<int> array(e.properties.size(), -1);
    bool corners = false;
    for (std::size_t k = 0; k < e.properties.size(); ++k) {
      const PlyProperty& p = e.properties[k];
      if (p.count_type) {
        corners = corners || p.name == "vertex_indices" || p.name == "vertex_index";
        continue;
      }
      array[k] = static_cast<int>(mesh_.arrays.size());
      mesh_.arrays.push_back({p.name, {}});
      mesh_.arrays.back().values.reserve(count);
    }
    if (!corners && count > 0) in_.fail("the faces have no vertex_indices");
    std::vector<std::int64_t> list;
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t k = 0; k < e.properties.size(); ++k) {
        const PlyProperty& p = e.properties[k];
        if (array[k] >= 0) {
          mesh_.arrays[array[k]].values.push_back(value(p.type));
          continue;
        }
        read_list(p, list);
        if (p.name == "vertex_indices" || p.name == "vertex_index") mesh_.add_polygon(list.data(), list.size());
      }
  }

  void skip(const PlyElement& e, std::size_t count) {
    std::vector<std::int64_t> list;
    for (std::size_t i = 0; i < count; ++i)
      for (const PlyProperty& p : e.properties) {
        if (p.count_type) read_list(p, list);
        else value(p.type);
      }
  }

  MeshBytes& in_;
  RawMesh& mesh_;
  std::vector<PlyElement> elements_;
  bool text_ = false, swap_ = false;
};

/// "below|above" of our own OBJ groups, where both are numbers, label_<n> or background.
std::optional<std::int64_t> label_of_name(std::string_view name) {
  if (name == "background") return 0;
  if (name.rfind("label_", 0) == 0) name.remove_prefix(6);
  return to_integer(name);
}

}  // namespace

void read_stl(MeshBytes& in, RawMesh& mesh) {
  const std::string_view all = in.rest();
  const bool has_header = all.size() >= kStlHeader;
  const std::uint32_t count =
      has_header ? static_cast<std::uint32_t>(read_integer(all.data() + 80, Scalar::u32, false)) : 0;
  const std::uint64_t size = kStlHeader + kStlTriangle * static_cast<std::uint64_t>(count);
  const std::string head = lower_case(all.substr(0, 4096));
  const bool text = trimmed(head).substr(0, 5) == "solid" &&
                    (head.find("facet") != std::string::npos || head.find("endsolid") != std::string::npos);
  if (!has_header && !text) in.fail("the file is too short for an STL");
  if (text && size != all.size()) return read_text_stl(in, mesh);
  if (size > all.size())
    in.fail_plainly("the header claims " + std::to_string(count) + " triangles (" + std::to_string(size) +
                        " bytes), the file has " + std::to_string(all.size()) + " bytes",
                    "write or copy the file again");
  read_binary_stl(in, mesh, count);
}

void read_ply(MeshBytes& in, RawMesh& mesh) {
  PlyReader(in, mesh).run();
}

void read_obj(MeshBytes& in, RawMesh& mesh) {
  std::string_view text;
  std::int32_t set = -1;
  std::map<std::string, std::int32_t, std::less<>> set_of_name;
  std::vector<std::int64_t> corners;
  std::string joined;
  while (in.line(text)) {
    joined.clear();
    while (!text.empty() && text.back() == '\\') {  // a line that goes on
      joined.append(text.substr(0, text.size() - 1)).push_back(' ');
      if (!in.line(text)) text = {};
    }
    if (!joined.empty()) text = joined.append(text);
    MeshBytes words(in.path(), text);
    const std::string_view key = words.word();
    if (key.empty() || key[0] == '#') {
      mesh.note_space(text);
    } else if (key == "v") {
      double p[3];
      for (double& c : p) {
        const std::optional<double> v = to_number(words.word());
        if (!v) in.fail("a vertex without three coordinates");
        c = *v;
      }
      mesh.points.push_back({p[0], p[1], p[2]});
    } else if (key == "f") {
      corners.clear();
      for (std::string_view word = words.word(); !word.empty(); word = words.word()) {
        const std::optional<std::int64_t> n = to_integer(word.substr(0, word.find('/')));
        if (!n || *n == 0) in.fail("a face with a corner that is not a number from 1");
        corners.push_back(*n > 0 ? *n - 1 : static_cast<std::int64_t>(mesh.points.size()) + *n);
      }
      if (corners.size() < 3) in.fail("a face with fewer than three corners");
      mesh.set_of_cell.push_back(set);
      mesh.add_polygon(corners.data(), corners.size());
    } else if (key == "g" || key == "o") {
      const std::string name(trimmed(words.rest()));
      const auto [it, is_new] = set_of_name.emplace(name, static_cast<std::int32_t>(mesh.sets.size()));
      set = it->second;
      if (!is_new) continue;
      RawMesh::Set s;
      s.name = name;
      s.number = label_of_name(name);
      const std::size_t bar = name.find('|');
      if (bar != std::string::npos) {
        s.below = label_of_name(std::string_view(name).substr(0, bar));
        s.above = label_of_name(std::string_view(name).substr(bar + 1));
      }
      mesh.sets.push_back(std::move(s));
    }
  }
}

void read_off(MeshBytes& in, RawMesh& mesh) {
  std::string_view text;
  std::string_view head = in.word('#');
  const std::string kind = lower_case(head);
  if (kind.size() < 3 || kind.substr(kind.size() - 3) != "off" || kind.find("4") != std::string::npos ||
      kind.find("n") == 0)
    in.fail(kind.size() >= 3 && kind.substr(kind.size() - 3) == "off" ? "only OFF, COFF and STOFF are read"
                                                                      : "the file does not begin with 'OFF'");
  const auto next_line = [&](const char* what) {
    do {
      if (!in.line(text)) in.fail(std::string("the file ends within its ") + what);
      if (text.find('#') != std::string_view::npos) {
        mesh.note_space(text.substr(text.find('#')));
        text = text.substr(0, text.find('#'));
      }
      text = trimmed(text);
    } while (text.empty());
    return MeshBytes(in.path(), text);
  };
  MeshBytes counts = next_line("counts");
  if (lower_case(trimmed(text)) == "binary") in.fail("binary OFF is not read");
  const std::size_t vertices = in.count(counts.integer("a count of points"), 4, "points");
  const std::size_t faces = in.count(counts.integer("a count of faces"), 4, "faces");
  mesh.points.reserve(vertices);
  for (std::size_t i = 0; i < vertices; ++i) {
    MeshBytes words = next_line("points");
    Vec3 p;
    p.x = words.number("a coordinate"), p.y = words.number("a coordinate"), p.z = words.number("a coordinate");
    mesh.points.push_back(p);
  }
  std::vector<std::int64_t> corners;
  for (std::size_t i = 0; i < faces; ++i) {
    MeshBytes words = next_line("faces");
    const std::size_t n = words.count(words.integer("a number of corners"), 1, "corners");
    corners.clear();
    for (std::size_t k = 0; k < n; ++k) corners.push_back(words.integer("a corner"));
    mesh.add_polygon(corners.data(), corners.size());
  }
}

}  // namespace stackmesh
