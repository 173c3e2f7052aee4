#include "meshio/read_mesh.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <set>
#include <tuple>

#include "base/error.h"
#include "base/text.h"
#include "meshio/raw_mesh.h"

namespace stackmesh {
namespace {

constexpr const char* kMend = "write or copy the file again";

using Reader = void (*)(MeshBytes&, RawMesh&);
struct Format {
  const char* name;
  Reader read;
};
constexpr Format kFormats[] = {
    {"stl", read_stl},     {"ply", read_ply},        {"obj", read_obj}, {"off", read_off}, {"vtp", read_vtk_xml},
    {"vtu", read_vtk_xml}, {"vtk", read_vtk_legacy}, {"msh", read_msh}, {"inp", read_inp}, {"mesh", read_medit}};

const Format* format_of(const std::string& path) {
  const std::size_t dot = path.rfind('.');
  if (dot == std::string::npos) return nullptr;
  const std::string ending = lower_case(path.substr(dot + 1));
  for (const Format& f : kFormats)
    if (ending == f.name) return &f;
  return nullptr;
}

std::string read_bytes(const std::string& path) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), std::fclose);
  if (!file) fail_input("the mesh cannot be opened", path, "check the name and the rights");
  std::string bytes;
  if (std::fseek(file.get(), 0, SEEK_END) == 0) {
    const long size = std::ftell(file.get());
    std::rewind(file.get());
    if (size > 0 && size < (1L << 40)) bytes.reserve(static_cast<std::size_t>(size));
  }
  char block[1 << 16];
  while (const std::size_t n = std::fread(block, 1, sizeof block, file.get())) bytes.append(block, n);
  if (std::ferror(file.get())) fail_input("the mesh cannot be read", path, "is it a file?");
  if (bytes.empty()) fail_input("the file is empty", path, kMend);
  return bytes;
}

std::string plain_name(const std::string& name) {  // "Material_ID" and "material id" are one
  std::string plain;
  for (const char c : lower_case(name))
    if (c != '_' && c != ' ') plain += c;
  return plain;
}

/// Turns a raw mesh into the checked one.
class MeshFinisher {
 public:
  MeshFinisher(RawMesh& raw, const MeshReadOptions& options) : raw_(raw), o_(options) {}

  MeshFile run() {
    out_.path = raw_.path;
    out_.format = raw_.format;
    check();
    out_.points = std::move(raw_.points);
    if (!raw_.space.empty()) out_.space = raw_.space == "LPS" ? Space::lps : Space::ras;
    find_labels();
    if (!is_volume()) take_surface();
    else take_volume();
    if (!out_.tets.empty() || !out_.wedges.empty()) return std::move(out_);
    if (out_.triangles.empty())
      fail_input("all triangles are degenerate or background", raw_.path, "give a surface or a volume mesh");
    return std::move(out_);
  }

 private:
  bool is_volume() const { return !raw_.tets.empty() || !raw_.wedges.empty(); }

  void check() const {
    for (const auto& [kind, count] : raw_.unsupported)
      fail_input("the mesh has " + std::to_string(count) + " " + kind, raw_.path,
                 "triangles, quads, polygons, tetrahedra, wedges and pyramids of first or second order are judged: "
                 "split the others into tetrahedra");
    if (raw_.cells > 2000000000) fail_input("the mesh has more than 2,000,000,000 cells", raw_.path, "split it");
    if (raw_.triangles.empty() && !is_volume())
      fail_input("the mesh has no triangle and no tetrahedron", raw_.path, "give a surface or a volume mesh");
    for (std::size_t p = 0; p < raw_.points.size(); ++p) {
      const Vec3& v = raw_.points[p];
      if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z))
        fail_input("a coordinate is not a finite number", raw_.path + ", point " + std::to_string(p),
                   "mend the mesh where it was made");
      if (std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}) > 1e9)
        fail_input("a coordinate lies beyond 1,000 km", raw_.path + ", point " + std::to_string(p),
                   "give the mesh in mm");
    }
    if (raw_.points.size() > 2000000000)
      fail_input("the mesh has more than 2,000,000,000 points", raw_.path, "split it");
    const auto need = [&](const char* kind, std::size_t i, std::int32_t v) {
      if (v < 0 || static_cast<std::size_t>(v) >= raw_.points.size())
        fail_input(std::string("a ") + kind + " names a point that is not there",
                   raw_.path + ", " + kind + " " + std::to_string(i) + ", of " + std::to_string(raw_.points.size()) +
                       " points",
                   kMend);
    };
    for (std::size_t t = 0; t < raw_.triangles.size(); ++t)
      for (const std::int32_t v : raw_.triangles[t]) need("triangle", t, v);
    for (std::size_t t = 0; t < raw_.tets.size(); ++t)
      for (const std::int32_t v : raw_.tets[t]) need("tet", t, v);
    if (raw_.has_quadratic && raw_.midside.size() != raw_.tets.size())
      fail_input("tetrahedra of 4 and of 10 nodes are mixed", raw_.path, "write the mesh in one order");
    if (raw_.has_quadratic && raw_.wedge_midside.size() != raw_.wedges.size())
      fail_input("elements of first and of second order are mixed", raw_.path, "write the mesh in one order");
    for (std::size_t w = 0; w < raw_.wedges.size(); ++w)
      for (const std::int32_t v : raw_.wedges[w]) need("wedge", w, v);
    for (std::size_t w = 0; w < raw_.wedge_midside.size(); ++w) {
      if (raw_.wedge_midside[w][0] < 0 && raw_.wedge_midside[w][7] < 0)
        fail_input("elements of first and of second order are mixed", raw_.path, "write the mesh in one order");
      for (const std::int32_t v : raw_.wedge_midside[w]) need("wedge", w, v);
    }
    for (std::size_t t = 0; t < raw_.midside.size(); ++t) {
      if (raw_.midside[t][0] < 0 && raw_.midside[t][5] < 0)
        fail_input("tetrahedra of 4 and of 10 nodes are mixed", raw_.path, "write the mesh in one order");
      for (const std::int32_t v : raw_.midside[t]) need("tet", t, v);
    }
  }

  // ---- labels

  const RawMesh::Array* array(const std::string& plain) const {
    for (const RawMesh::Array& a : raw_.arrays)
      if (plain_name(a.name) == plain && static_cast<std::int64_t>(a.values.size()) == raw_.cells) return &a;
    return nullptr;
  }

  /// The cells whose labels count: tets, else triangles.
  std::vector<std::int32_t> judged_cells() const {
    if (!is_volume()) return raw_.triangle_cell;
    std::vector<std::int32_t> cells = raw_.tet_cell;
    cells.insert(cells.end(), raw_.wedge_cell.begin(), raw_.wedge_cell.end());
    return cells;
  }

  bool all_zero(const RawMesh::Array& a) const {
    for (const std::int32_t c : judged_cells())
      if (a.values[c] != 0) return false;
    return true;
  }

  void find_labels() {
    if (!o_.label_array.empty()) {
      for (const RawMesh::Array& a : raw_.arrays)
        if (a.name == o_.label_array) labels_ = array(plain_name(a.name)) ? &a : nullptr;
      if (!labels_) labels_ = array(plain_name(o_.label_array));
      if (labels_ && static_cast<std::int64_t>(labels_->values.size()) != raw_.cells) labels_ = nullptr;
      if (!labels_) {
        std::string known;
        for (const RawMesh::Array& a : raw_.arrays) known += (known.empty() ? "" : ", ") + a.name;
        fail_input("the mesh has no cell array '" + o_.label_array + "'", raw_.path,
                   known.empty() ? "it has none: leave --label-array out" : "it has " + known);
      }
    } else {
      below_ = array("labelbelow"), above_ = array("labelabove");
      for (const char* name : {"label", "labels", "material", "materialid", "materialids", "medit:ref", "gmsh:physical",
                               "gmsh:geometrical", "region", "regionid", "cellentityids", "part", "partid"}) {
        labels_ = array(name);
        if (labels_ && !all_zero(*labels_)) break;
        labels_ = nullptr;
      }
    }
    if (labels_) {
      out_.label_source = LabelSource::array;
      out_.label_array = labels_->name;
      for (const RawMesh::Name& n : raw_.names)
        if (n.dimension == (is_volume() ? 3 : 2) && labels_->name == "gmsh:physical" && n.number >= -2147483647 &&
            n.number <= 2147483647)
          out_.names.push_back({static_cast<Label>(n.number), n.text});
      sort_names();
    } else if (std::any_of(raw_.set_of_cell.begin(), raw_.set_of_cell.end(), [](std::int32_t s) { return s >= 0; })) {
      number_sets();
    }
  }

  void sort_names() {
    std::sort(out_.names.begin(), out_.names.end(),
              [](const LabelInfo& a, const LabelInfo& b) { return a.number < b.number; });
    out_.names.erase(std::unique(out_.names.begin(), out_.names.end(),
                                 [](const LabelInfo& a, const LabelInfo& b) { return a.number == b.number; }),
                     out_.names.end());
  }

  static Label to_label(double value, const std::string& name, const std::string& path) {
    if (!(std::abs(value) <= 2147483647.0) || value != std::floor(value)) {
      char text[32];
      std::snprintf(text, sizeof text, "%g", value);
      fail_input("the label array '" + name + "' holds " + text + ", not a whole number", path,
                 "name another array with --label-array");
    }
    return static_cast<Label>(value);
  }

  static std::optional<Label> number_in_name(const std::string& name) {
    if (lower_case(name) == "background") return 0;
    std::string_view text = name;
    if (lower_case(name).rfind("label_", 0) == 0) text.remove_prefix(6);
    const auto n = to_integer(text);
    if (!n || *n < 0 || *n > 2147483647) return std::nullopt;
    return static_cast<Label>(*n);
  }

  /// Numbers for names: what the file or the name tells, else the free ones from 1.
  void number_sets() {
    std::vector<char> used(raw_.sets.size(), 0);
    bool unnamed = false;
    for (const std::int32_t c : judged_cells()) {
      const std::int32_t s = raw_.set_of_cell[c];
      if (s >= 0) used[s] = 1;
      else unnamed = true;
    }
    std::map<std::string, Label> number;
    std::set<Label> taken = {0};
    std::vector<std::string> waiting;
    const auto want = [&](const std::string& name, std::optional<std::int64_t> told) {
      if (number.count(name)) return;
      std::optional<Label> n = told && *told >= 0 && *told <= 2147483647
                                   ? std::optional<Label>(static_cast<Label>(*told))
                                   : number_in_name(name);
      if (n && *n != 0 && !taken.insert(*n).second) n = std::nullopt;
      if (n) number[name] = *n;
      else waiting.push_back(name), number[name] = -1;
    };
    set_below_.assign(raw_.sets.size(), 0), set_above_.assign(raw_.sets.size(), 0);
    const auto parts_of = [](const RawMesh::Set& s) {
      const std::size_t bar = s.name.find('|');
      return bar == std::string::npos ? std::make_pair(s.name, std::string("background"))
                                      : std::make_pair(s.name.substr(0, bar), s.name.substr(bar + 1));
    };
    for (std::size_t s = 0; s < raw_.sets.size(); ++s) {
      if (!used[s]) continue;
      const auto parts = parts_of(raw_.sets[s]);
      want(parts.first, parts.first == raw_.sets[s].name ? raw_.sets[s].number : raw_.sets[s].below);
      want(parts.second, raw_.sets[s].above);
    }
    Label next = 1;
    for (const std::string& name : waiting) {
      while (taken.count(next)) ++next;
      taken.insert(next);
      number[name] = next;
    }
    if (unnamed) {
      while (taken.count(next)) ++next;
      unnamed_ = next;
      out_.notes.push_back("cells that are in no set have label " + std::to_string(next));
    }
    for (std::size_t s = 0; s < raw_.sets.size(); ++s) {
      if (!used[s]) continue;
      const auto parts = parts_of(raw_.sets[s]);
      set_below_[s] = number[parts.first], set_above_[s] = number[parts.second];
    }
    for (const auto& [name, n] : number)
      if (n > 0) out_.names.push_back({n, name});
    sort_names();
    out_.numbers_from_names = !waiting.empty();
    out_.label_source = LabelSource::sets;
  }

  Label label_of_cell(std::int32_t cell) const {
    if (labels_) return to_label(labels_->values[cell], labels_->name, raw_.path);
    if (out_.label_source == LabelSource::sets)
      return raw_.set_of_cell[cell] < 0 ? unnamed_ : set_below_[raw_.set_of_cell[cell]];
    return 1;
  }

  std::pair<Label, Label> sides_of_cell(std::int32_t cell) const {
    return {to_label(below_->values[cell], below_->name, raw_.path),
            to_label(above_->values[cell], above_->name, raw_.path)};
  }

  // ---- cells

  void note_conversions() {
    if (raw_.polygons > 0)
      out_.notes.push_back(std::to_string(raw_.polygons) + " quads or polygons were split into triangles");
    if (raw_.strips > 0) out_.notes.push_back(std::to_string(raw_.strips) + " triangle strips were taken apart");
    if (raw_.quadratic_triangles > 0) out_.notes.push_back("triangles of 6 nodes are judged by their corners");
  }

  /// Formats (and programs) differ in which way wedges are wound: all are turned where most are negative.
  void turn_wedges(TetMesh& mesh) const {
    std::size_t negative = 0;
    for (const auto& w : mesh.wedges) {
      const Vec3 o = out_.points[w[0]], a = out_.points[w[1]] - o, b = out_.points[w[2]] - o;
      const Vec3 up = 0.5 * (out_.points[w[3]] + out_.points[w[4]]) - 0.5 * (out_.points[w[0]] + out_.points[w[1]]);
      negative += dot(up, cross(a, b)) < 0;
    }
    if (2 * negative <= mesh.wedges.size()) return;
    for (std::size_t w = 0; w < mesh.wedges.size(); ++w)
      if (!is_pyramid(mesh.wedges[w])) turn_wedge_round(mesh, w);
  }

  void take_volume() {
    TetMesh mesh;
    for (const std::int32_t cell : judged_cells()) mesh.labels.push_back(label_of_cell(cell));
    mesh.tets = std::move(raw_.tets);
    mesh.mid = std::move(raw_.midside);
    mesh.wedges = std::move(raw_.wedges);
    mesh.wedge_mid = std::move(raw_.wedge_midside);
    turn_wedges(mesh);
    const auto background = static_cast<std::size_t>(std::count(mesh.labels.begin(), mesh.labels.end(), 0));
    if (background > 0) {
      const bool wedges = !mesh.wedges.empty();
      relabel(mesh, [](Label l) { return l; });
      out_.notes.push_back(std::to_string(background) + (wedges ? " elements" : " tets") +
                           " of label 0 are background and left out");
      if (mesh.elements() == 0)
        fail_input("all tetrahedra have label 0, the background", raw_.path, "name another array with --label-array");
    }
    out_.tets = std::move(mesh.tets);
    out_.midside = std::move(mesh.mid);
    out_.wedges = std::move(mesh.wedges);
    out_.wedge_midside = std::move(mesh.wedge_mid);
    out_.tet_labels = std::move(mesh.labels);
    if (!below_ || !above_) return;
    const std::set<Label> filled(out_.tet_labels.begin(), out_.tet_labels.end());
    for (std::size_t t = 0; t < raw_.triangles.size(); ++t) {
      auto [below, above] = sides_of_cell(raw_.triangle_cell[t]);
      if (below < 0 || above < 0) continue;
      Label behind = 0;
      for (Label* side : {&below, &above})
        if (*side != 0 && filled.count(*side) == 0) behind = *side, *side = 0;
      if (below == above) continue;
      out_.triangles.push_back({raw_.triangles[t], below, above});
      out_.behind.push_back(behind);
    }
  }

  void take_surface() {
    note_conversions();
    const bool sides = below_ && above_;
    if (sides) out_.label_source = LabelSource::sides, out_.label_array = "label_below, label_above";
    out_.triangles.reserve(raw_.triangles.size());
    for (std::size_t t = 0; t < raw_.triangles.size(); ++t) {
      const std::int32_t cell = raw_.triangle_cell[t];
      InterfaceTriangle triangle;
      triangle.v = raw_.triangles[t];
      if (sides) {
        std::tie(triangle.below, triangle.above) = sides_of_cell(cell);
      } else {
        triangle.below = label_of_cell(cell);
        if (out_.label_source == LabelSource::sets && raw_.set_of_cell[cell] >= 0)
          triangle.above = set_above_[raw_.set_of_cell[cell]];
      }
      out_.triangles.push_back(triangle);
    }
    raw_.triangles = {};
    merge_points();
    drop_degenerate();
    if (!sides) join_doubles();
  }

  /// Exactly equal points become one: the first.
  void merge_points() {
    const std::size_t n = out_.points.size();
    std::size_t size = 16;
    while (size < 2 * n) size *= 2;
    std::vector<std::int32_t> table(size, -1), number(n);
    std::vector<Vec3> kept;
    kept.reserve(out_.format == "stl" ? n / 5 : n);
    for (std::size_t i = 0; i < n; ++i) {
      Vec3 p = out_.points[i];
      p.x += 0.0, p.y += 0.0, p.z += 0.0;  // -0 is 0
      std::uint64_t bits[3];
      std::memcpy(bits, &p, sizeof bits);
      std::uint64_t h = bits[0] * 0x9e3779b97f4a7c15u;
      h = (h ^ (h >> 29) ^ bits[1]) * 0xbf58476d1ce4e5b9u;
      h = (h ^ (h >> 32) ^ bits[2]) * 0x94d049bb133111ebu;
      h ^= h >> 31;
      std::size_t at = h & (size - 1);
      while (table[at] >= 0 && !(kept[table[at]].x == p.x && kept[table[at]].y == p.y && kept[table[at]].z == p.z))
        at = (at + 1) & (size - 1);
      if (table[at] < 0) {
        table[at] = static_cast<std::int32_t>(kept.size());
        kept.push_back(p);
      }
      number[i] = table[at];
    }
    out_.merged_points = n - kept.size();
    if (out_.merged_points == 0) return;
    out_.points = std::move(kept);
    for (InterfaceTriangle& t : out_.triangles)
      for (std::int32_t& v : t.v) v = number[v];
    if (out_.format != "stl")
      out_.notes.push_back(std::to_string(out_.merged_points) +
                           " points that lie exactly on another were joined to it");
  }

  void drop_degenerate() {
    const auto bad = [](const InterfaceTriangle& t) {
      return t.v[0] == t.v[1] || t.v[1] == t.v[2] || t.v[2] == t.v[0] || t.below == t.above;
    };
    const std::size_t before = out_.triangles.size();
    out_.triangles.erase(std::remove_if(out_.triangles.begin(), out_.triangles.end(), bad), out_.triangles.end());
    out_.dropped_triangles = before - out_.triangles.size();
    if (out_.dropped_triangles > 0)
      out_.notes.push_back(
          std::to_string(out_.dropped_triangles) +
          " triangles with a point twice, or with one label on both sides, were left out: they bound nothing");
  }

  /// Two labels that each bring the triangle between them, turned against each other, share one interface.
  void join_doubles() {
    if (out_.label_source == LabelSource::none) return;
    std::vector<std::int32_t> order(out_.triangles.size());
    std::vector<std::array<std::int32_t, 3>> key(out_.triangles.size());
    for (std::size_t t = 0; t < order.size(); ++t) {
      order[t] = static_cast<std::int32_t>(t);
      key[t] = out_.triangles[t].v;
      std::sort(key[t].begin(), key[t].end());
    }
    std::sort(order.begin(), order.end(),
              [&](std::int32_t a, std::int32_t b) { return key[a] != key[b] ? key[a] < key[b] : a < b; });
    std::vector<char> gone(order.size(), 0);
    std::size_t joined = 0;
    for (std::size_t i = 0; i + 1 < order.size(); ++i) {
      InterfaceTriangle &a = out_.triangles[order[i]], &b = out_.triangles[order[i + 1]];
      if (key[order[i]] != key[order[i + 1]] || gone[order[i]] || a.above != 0 || b.above != 0 || a.below == b.below ||
          runs_alike(a.v, b.v))
        continue;
      a.above = b.below;
      gone[order[i + 1]] = 1;
      ++joined;
    }
    if (joined == 0) return;
    std::size_t kept = 0;
    for (std::size_t t = 0; t < out_.triangles.size(); ++t)
      if (!gone[t]) out_.triangles[kept++] = out_.triangles[t];
    out_.triangles.resize(kept);
    out_.notes.push_back(std::to_string(joined) + " triangles that two labels bring each were joined to one interface");
  }

  static bool runs_alike(const std::array<std::int32_t, 3>& a, const std::array<std::int32_t, 3>& b) {
    for (int k = 0; k < 3; ++k)
      if (a[0] == b[k]) return a[1] == b[(k + 1) % 3];
    return false;
  }

  RawMesh& raw_;
  const MeshReadOptions& o_;
  MeshFile out_;
  const RawMesh::Array *labels_ = nullptr, *below_ = nullptr, *above_ = nullptr;
  std::vector<Label> set_below_, set_above_;
  Label unnamed_ = 0;
};

}  // namespace

bool is_readable_mesh(const std::string& path) {
  return format_of(path) != nullptr;
}

MeshFile read_mesh(const std::string& path, const MeshReadOptions& options) {
  const Format* format = format_of(path);
  if (!format)
    fail_input("the ending of the mesh is unknown", path, "give .stl .ply .obj .off .vtp .vtk .vtu .msh .inp or .mesh");
  RawMesh raw;
  raw.path = path;
  raw.format = format->name;
  {
    const std::string bytes = read_bytes(path);
    MeshBytes in(path, bytes);
    format->read(in, raw);
  }
  return MeshFinisher(raw, options).run();
}

}  // namespace stackmesh
