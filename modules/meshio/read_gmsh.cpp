// Gmsh 2.2 and 4.1, text and binary.
#include <algorithm>
#include <unordered_map>

#include "meshio/raw_mesh.h"

namespace stackmesh {
namespace {

/// Nodes of Gmsh's element types, and VTK's type of those we know by name.
struct ElementType {
  int nodes = 0, vtk = 0;
};

std::optional<ElementType> element_type(std::int64_t gmsh) {
  static const std::map<std::int64_t, ElementType> kTypes = {
      {1, {2, 3}},  {2, {3, 5}},   {3, {4, 9}},    {4, {4, 10}},   {5, {8, 12}},   {6, {6, 13}},   {7, {5, 14}},
      {8, {3, 21}}, {9, {6, 22}},  {10, {9, 23}},  {11, {10, 24}}, {12, {27, 29}}, {13, {18, 26}}, {14, {14, 27}},
      {15, {1, 1}}, {16, {8, 23}}, {17, {20, 25}}, {18, {15, 26}}, {19, {13, 27}}};
  const auto it = kTypes.find(gmsh);
  if (it == kTypes.end()) return std::nullopt;
  return it->second;
}

class GmshReader {
 public:
  GmshReader(MeshBytes& in, RawMesh& mesh) : in_(in), mesh_(mesh) {}

  void run() {
    bool format = false, elements = false;
    std::string_view text;
    while (in_.line(text)) {
      const std::string_view key = trimmed(text);
      if (key.empty()) continue;
      if (key[0] != '$') in_.fail("a line that belongs to no section");
      if (key.rfind("$End", 0) == 0) continue;
      if (!format && key != "$MeshFormat" && key != "$Comments") in_.fail("the file does not begin with $MeshFormat");
      if (key == "$MeshFormat") read_format(), format = true;
      else if (key == "$PhysicalNames") read_names();
      else if (key == "$Entities") read_entities();
      else if (key == "$Nodes") new_format_ ? read_nodes4() : read_nodes2();
      else if (key == "$Elements") elements = true, new_format_ ? read_elements4() : read_elements2();
      else skip(std::string(key));
    }
    if (!format) in_.fail("the file does not begin with $MeshFormat");
    if (!elements) in_.fail("the file ends before its elements");
    mesh_.arrays.push_back({"gmsh:physical", std::move(physical_)});
    mesh_.arrays.push_back({"gmsh:geometrical", std::move(entity_)});
  }

 private:
  void read_format() {
    const double version = in_.number("a version");
    new_format_ = version >= 4;
    if (version != 2.2 && version != 2 && version != 2.1 && version != 4.1)
      in_.fail_plainly("Gmsh format " + std::to_string(version).substr(0, 3) + " is not read",
                       "write it as 2.2 or 4.1");
    binary_ = in_.integer("a file type") == 1;
    const std::int64_t size = in_.integer("a data size");
    if (size != 8) in_.fail("only a data size of 8 is read");
    std::string_view text;
    in_.line(text);
    if (!binary_) return;
    const std::string_view one = in_.take(4, "format");
    swap_ = read_integer(one.data(), Scalar::i32, false) != 1;
    if (swap_ && read_integer(one.data(), Scalar::i32, true) != 1) in_.fail("the byte order cannot be told");
  }

  void skip(const std::string& name) {
    const std::string end = "$End" + name.substr(1);
    const std::size_t at = in_.rest().find(end);
    if (at == std::string_view::npos) in_.fail("the file ends within " + name);
    if (name == "$Comments") mesh_.note_space(in_.rest().substr(0, at));
    in_.seek(in_.position() + at);
  }

  void read_names() {
    const std::size_t n = in_.count(in_.integer("a count of names"), 5, "names");
    for (std::size_t i = 0; i < n; ++i) {
      const std::int64_t dimension = in_.integer("a dimension"), tag = in_.integer("a tag");
      std::string_view text;
      in_.line(text);
      text = trimmed(text);
      if (text.size() >= 2 && text.front() == '"')
        text = text.substr(1, text.rfind('"') == 0 ? text.size() - 1 : text.rfind('"') - 1);
      mesh_.names.push_back({dimension, tag, std::string(text)});
    }
  }

  std::int64_t whole(Scalar type, const char* what) {
    return binary_ ? read_integer(in_.take(size_of(type), what).data(), type, swap_) : in_.integer(what);
  }
  double real(const char* what) {
    return binary_ ? read_scalar(in_.take(8, what).data(), Scalar::f64, swap_) : in_.number(what);
  }
  std::size_t many(std::int64_t n, std::size_t text_bytes, std::size_t binary_bytes, const char* what) {
    return in_.count(n, binary_ ? binary_bytes : text_bytes, what);
  }

  void read_entities() {
    std::int64_t counts[4];
    for (std::int64_t& c : counts)
      c = static_cast<std::int64_t>(many(whole(Scalar::u64, "entities"), 2, 4, "entities"));
    for (int dimension = 0; dimension < 4; ++dimension)
      for (std::int64_t i = 0; i < counts[dimension]; ++i) {
        const std::int64_t tag = whole(Scalar::i32, "entities");
        for (int k = 0; k < (dimension == 0 ? 3 : 6); ++k) real("entities");
        const std::size_t tags = many(whole(Scalar::u64, "entities"), 2, 4, "tags");
        for (std::size_t k = 0; k < tags; ++k) {
          const std::int64_t physical = whole(Scalar::i32, "entities");
          if (k == 0) physical_of_[dimension][tag] = physical < 0 ? -physical : physical;
        }
        if (dimension == 0) continue;
        const std::size_t bounds = many(whole(Scalar::u64, "entities"), 2, 4, "bounds");
        for (std::size_t k = 0; k < bounds; ++k) whole(Scalar::i32, "entities");
      }
    end_block();
  }

  void end_block() {  // a binary block is followed by a line's end
    std::string_view text;
    in_.line(text);
    if (!trimmed(text).empty()) in_.fail("a section is longer than it says");
  }

  void add_node(std::int64_t tag, const Vec3& p) {
    if (!node_of_.emplace(tag, static_cast<std::int64_t>(mesh_.points.size())).second)
      in_.fail("node " + std::to_string(tag) + " is there twice");
    mesh_.points.push_back(p);
  }

  void read_nodes2() {
    const std::size_t n = many(in_.integer("a count of nodes"), 8, 28, "nodes");
    if (binary_) end_block();
    node_of_.reserve(n);
    for (std::size_t i = 0; i < n; ++i) {
      const std::int64_t tag = whole(Scalar::i32, "nodes");
      Vec3 p;
      p.x = real("nodes"), p.y = real("nodes"), p.z = real("nodes");
      add_node(tag, p);
    }
    end_block();
  }

  void read_nodes4() {
    const std::size_t blocks = many(whole(Scalar::u64, "nodes"), 8, 20, "node blocks");
    const std::size_t total = many(whole(Scalar::u64, "nodes"), 6, 24, "nodes");
    whole(Scalar::u64, "nodes"), whole(Scalar::u64, "nodes");
    node_of_.reserve(total);
    std::vector<std::int64_t> tags;
    for (std::size_t b = 0; b < blocks; ++b) {
      const std::int64_t dimension = whole(Scalar::i32, "nodes");
      whole(Scalar::i32, "nodes");
      const std::int64_t parametric = whole(Scalar::i32, "nodes");
      const std::size_t n = many(whole(Scalar::u64, "nodes"), 6, 24, "nodes");
      if (dimension < 0 || dimension > 3) in_.fail("a node block of dimension " + std::to_string(dimension));
      tags.clear();
      for (std::size_t i = 0; i < n; ++i) tags.push_back(whole(Scalar::u64, "nodes"));
      for (const std::int64_t tag : tags) {
        Vec3 p;
        p.x = real("nodes"), p.y = real("nodes"), p.z = real("nodes");
        if (parametric == 1)
          for (std::int64_t k = 0; k < dimension; ++k) real("nodes");
        add_node(tag, p);
      }
    }
    end_block();
  }

  void add_element(std::int64_t gmsh, const ElementType& type, const std::int64_t* nodes, std::int64_t physical,
                   std::int64_t entity) {
    std::int64_t n[32] = {};
    for (int k = 0; k < type.nodes; ++k) {
      const auto it = node_of_.find(nodes[k]);
      n[k] = it == node_of_.end() ? -1 : it->second;
    }
    if (gmsh == 11) std::swap(n[8], n[9]);  // Gmsh's last two edges are 23 and 13
    // Gmsh sorts edges by their ends
    static constexpr int kWedge[15] = {0, 1, 2, 3, 4, 5, 6, 9, 7, 12, 14, 13, 8, 10, 11};
    static constexpr int kPyramid[13] = {0, 1, 2, 3, 4, 5, 8, 10, 6, 7, 9, 11, 12};
    if (gmsh == 18 || gmsh == 19) {
      std::int64_t sorted[15];
      for (int k = 0; k < type.nodes; ++k) sorted[k] = n[(gmsh == 18 ? kWedge : kPyramid)[k]];
      std::copy(sorted, sorted + type.nodes, n);
    }
    mesh_.add_cell(type.vtk, n, gmsh == 10 ? 8 : static_cast<std::size_t>(type.nodes));
    physical_.push_back(static_cast<double>(physical));
    entity_.push_back(static_cast<double>(entity));
  }

  ElementType known(std::int64_t type) const {
    const std::optional<ElementType> t = element_type(type);
    if (!t)
      in_.fail_plainly("elements of Gmsh type " + std::to_string(type) + " are not read",
                       "write triangles and tetrahedra of first or second order");
    return *t;
  }

  void read_elements2() {
    const std::size_t n = many(in_.integer("a count of elements"), 6, 8, "elements");
    if (binary_) end_block();
    std::int64_t nodes[32];
    std::vector<std::int64_t> tags;
    std::size_t done = 0;
    while (done < n) {
      std::int64_t type = 0, block = 1, tag_count = 0;
      if (binary_) {
        type = whole(Scalar::i32, "elements"), block = whole(Scalar::i32, "elements"),
        tag_count = whole(Scalar::i32, "elements");
        if (block < 1) in_.fail("an empty block of elements");
      } else {
        whole(Scalar::i32, "elements");
        type = whole(Scalar::i32, "elements"), tag_count = whole(Scalar::i32, "elements");
      }
      const ElementType known_type = known(type);
      const std::size_t tag_size = many(tag_count, 2, 4, "tags");
      for (std::int64_t i = 0; i < block && done < n; ++i, ++done) {
        if (binary_) whole(Scalar::i32, "elements");
        tags.clear();
        for (std::size_t k = 0; k < tag_size; ++k) tags.push_back(whole(Scalar::i32, "elements"));
        for (int k = 0; k < known_type.nodes; ++k) nodes[k] = whole(Scalar::i32, "elements");
        add_element(type, known_type, nodes, tags.empty() ? 0 : tags[0], tags.size() < 2 ? 0 : tags[1]);
      }
    }
    end_block();
  }

  void read_elements4() {
    const std::size_t blocks = many(whole(Scalar::u64, "elements"), 8, 20, "element blocks");
    for (int k = 0; k < 3; ++k) whole(Scalar::u64, "elements");
    std::int64_t nodes[32];
    for (std::size_t b = 0; b < blocks; ++b) {
      const std::int64_t dimension = whole(Scalar::i32, "elements"), entity = whole(Scalar::i32, "elements"),
                         type = whole(Scalar::i32, "elements");
      const ElementType known_type = known(type);
      const std::size_t n = many(whole(Scalar::u64, "elements"), 4, 16, "elements");
      if (dimension < 0 || dimension > 3) in_.fail("an element block of dimension " + std::to_string(dimension));
      const auto it = physical_of_[dimension].find(entity);
      const std::int64_t physical = it == physical_of_[dimension].end() ? 0 : it->second;
      for (std::size_t i = 0; i < n; ++i) {
        whole(Scalar::u64, "elements");
        for (int k = 0; k < known_type.nodes; ++k) nodes[k] = whole(Scalar::u64, "elements");
        add_element(type, known_type, nodes, physical, entity);
      }
    }
    end_block();
  }

  MeshBytes& in_;
  RawMesh& mesh_;
  bool new_format_ = false, binary_ = false, swap_ = false;
  std::unordered_map<std::int64_t, std::int64_t> physical_of_[4], node_of_;
  std::vector<double> physical_, entity_;
};

}  // namespace

void read_msh(MeshBytes& in, RawMesh& mesh) {
  GmshReader(in, mesh).run();
}

}  // namespace stackmesh
