#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "meshio/element_nodes.h"
#include "meshio/formats.h"
#include "meshio/output_buffer.h"

namespace stackmesh {
namespace {

// VTK's cell types
constexpr std::int32_t kTriangle = 5, kTet = 10, kWedge = 13, kPyramid = 14, kTriangle6 = 22, kTet10 = 24,
                       kWedge15 = 26, kPyramid13 = 27;

/// Of a cell: the elements, then the triangles.
std::int32_t cell_type(const PreparedMesh& mesh, std::size_t cell) {
  const bool second = mesh.second_order();
  if (cell < mesh.tets.size()) return second ? kTet10 : kTet;
  if (cell >= mesh.elements()) return second ? kTriangle6 : kTriangle;
  return is_pyramid(mesh.wedges[cell - mesh.tets.size()]) ? (second ? kPyramid13 : kPyramid)
                                                          : (second ? kWedge15 : kWedge);
}

/// VTK's wedges, of second order too, have the first triangle's normal point away from the second: as if the first two
/// corners of each changed places.
std::vector<std::int32_t> vtk_wedge(const PreparedMesh& mesh, std::size_t wedge) {
  std::vector<std::int32_t> n = wedge_nodes_of(mesh, wedge, WedgeOrder::abaqus);
  if (is_pyramid(mesh.wedges[wedge])) return n;
  for (const auto& [a, b] : {std::pair(0, 1), std::pair(3, 4), std::pair(7, 8), std::pair(10, 11), std::pair(12, 13)})
    if (static_cast<std::size_t>(b) < n.size()) std::swap(n[a], n[b]);
  return n;
}

/// A VTK XML file whose arrays follow the header as raw bytes.
class XmlFile {
 public:
  explicit XmlFile(const std::string& type) : type_(type) {
    text_ = "<?xml version=\"1.0\"?>\n<VTKFile type=\"" + type +
            "\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<" + type + ">\n";
  }

  XmlFile& operator<<(const std::string& text) {
    text_ += text;
    return *this;
  }

  /// The array must live until finish().
  template <class T>
  void array(const std::string& name, const std::vector<T>& data, const char* type, int components = 1) {
    text_ += "<DataArray type=\"" + std::string(type) + "\" Name=\"" + name + "\"";
    if (components != 1) text_ += " NumberOfComponents=\"" + std::to_string(components) + "\"";
    text_ += " format=\"appended\" offset=\"" + std::to_string(offset_) + "\"/>\n";
    blocks_.push_back({data.data(), data.size() * sizeof(T)});
    offset_ += sizeof(std::uint64_t) + blocks_.back().size;
  }

  /// Field data that say the frame: a string, as 3D Slicer reads and writes it, or else its character codes.
  /// And the labels: number, name and colour of each (white where it has none); names of a file without strings are
  /// their UTF-8 codes, a line each.
  void field_data(const PreparedMesh& mesh, bool as_string) {
    if (!mesh.space.empty()) text_ += "<!-- SPACE=" + mesh.space + ", mm -->\n";
    text_ += "<FieldData>\n";
    if (!mesh.space.empty()) texts("SPACE", {mesh.space}, as_string);
    std::string numbers, colours;
    std::vector<std::string> names;
    for (const LabelInfo& l : mesh.named) {
      numbers += std::to_string(l.number) + " ";
      names.push_back(l.name);
      for (const int c : l.colour.value_or(std::array<std::uint8_t, 3>{255, 255, 255}))
        colours += std::to_string(c) + " ";
    }
    const std::string count = std::to_string(names.size());
    text_ += "<DataArray type=\"Int32\" Name=\"label_number\" NumberOfTuples=\"" + count + "\" format=\"ascii\">\n" +
             numbers + "\n</DataArray>\n";
    texts("label_name", names, as_string);
    text_ += "<DataArray type=\"UInt8\" Name=\"label_colour\" NumberOfComponents=\"3\" NumberOfTuples=\"" + count +
             "\" format=\"ascii\">\n" + colours + "\n</DataArray>\n</FieldData>\n";
  }

  void finish(std::FILE* file) {
    OutputBuffer out(file);
    out << text_ << "</" << type_ << ">\n<AppendedData encoding=\"raw\">\n_";
    for (const Block& b : blocks_) {
      out.binary(static_cast<std::uint64_t>(b.size));
      out.bytes(b.data, b.size);
    }
    out << "\n</AppendedData>\n</VTKFile>\n";
  }

 private:
  struct Block {
    const void* data;
    std::size_t size;
  };
  std::string type_, text_;
  void texts(const std::string& name, const std::vector<std::string>& values, bool as_string) {
    std::size_t codes = 0;
    std::string text;
    for (std::size_t i = 0; i < values.size(); ++i) {
      for (const char c : values[i] + (as_string || i + 1 == values.size() ? "" : "\n")) {
        text += std::to_string(static_cast<int>(static_cast<unsigned char>(c))) + " ";
        ++codes;
      }
      if (as_string) text += "0 ";
    }
    const std::string kind = as_string ? "Array" : "DataArray";
    text_ += "<" + kind + (as_string ? " type=\"String\"" : " type=\"UInt8\"") + " Name=\"" + name +
             "\" NumberOfTuples=\"" + std::to_string(as_string ? values.size() : codes) + "\" format=\"ascii\">\n" +
             text + "\n</" + kind + ">\n";
  }

  std::vector<Block> blocks_;
  std::uint64_t offset_ = 0;
};

/// Cell data of the elements followed by the triangles. A triangle has the label of the tet behind it (of two, that of
/// `below`; a void has none), so that a viewer, which draws both, shows one colour.
struct CellLabels {
  std::vector<std::int32_t> label, below, above;

  explicit CellLabels(const PreparedMesh& mesh) {
    const std::size_t cells = mesh.elements() + mesh.triangles.size();
    label.reserve(cells);
    for (const LabelGroup& g : mesh.labels) label.insert(label.end(), g.end - g.begin, g.label);
    for (const LabelGroup& g : mesh.labels) label.insert(label.end(), g.wedge_end - g.wedge_begin, g.label);
    if (mesh.sets.parts.empty()) {
      const auto has_tets = [&](Label l) {
        return std::any_of(mesh.labels.begin(), mesh.labels.end(), [&](const LabelGroup& g) { return g.label == l; });
      };
      for (const PairGroup& g : mesh.pairs)
        label.insert(label.end(), g.end - g.begin,
                     g.below != 0 && (g.above == 0 || mesh.elements() == 0 || has_tets(g.below)) ? g.below : g.above);
    } else {  // each part has its own side
      for (const TetFace f : face_owners(mesh, false)) label.push_back(label[f.tet]);
    }
    below.assign(mesh.elements(), -1);
    above.assign(mesh.elements(), -1);
    for (const PairGroup& g : mesh.pairs) {
      below.insert(below.end(), g.end - g.begin, g.below);
      above.insert(above.end(), g.end - g.begin, g.above);
    }
  }
};

/// Nodes of the elements followed by those of the triangles, and where each cell ends.
struct Connectivity {
  std::vector<std::int64_t> ends;
  std::vector<std::int32_t> corners;

  explicit Connectivity(const PreparedMesh& mesh) {
    corners.reserve(4 * mesh.tets.size() + 3 * mesh.triangles.size());
    ends.reserve(mesh.tets.size() + mesh.triangles.size());
    for (std::size_t i = 0; i < mesh.tets.size(); ++i) {
      corners.insert(corners.end(), mesh.tets[i].begin(), mesh.tets[i].end());
      if (mesh.second_order()) corners.insert(corners.end(), mesh.tet_mids[i].begin(), mesh.tet_mids[i].end());
      ends.push_back(static_cast<std::int64_t>(corners.size()));
    }
    for (std::size_t i = 0; i < mesh.wedges.size(); ++i) {
      const std::vector<std::int32_t> nodes = vtk_wedge(mesh, i);
      corners.insert(corners.end(), nodes.begin(), nodes.end());
      ends.push_back(static_cast<std::int64_t>(corners.size()));
    }
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      corners.insert(corners.end(), mesh.triangles[i].v.begin(), mesh.triangles[i].v.end());
      if (mesh.second_order())
        corners.insert(corners.end(), mesh.triangle_mids[i].begin(), mesh.triangle_mids[i].end());
      ends.push_back(static_cast<std::int64_t>(corners.size()));
    }
  }
};

/// What a solver model has per cell: modulus, density, element quality, fibres, thickness of skins (0 where there is
/// none). Triangles have what the tet behind them has.
struct CellFields {
  struct Field {
    std::string name;
    int components;
    std::vector<double> values;
  };
  std::vector<Field> list;

  explicit CellFields(const PreparedMesh& mesh) {
    const SolverSets& sets = mesh.sets;
    const std::size_t cells = mesh.elements() + mesh.triangles.size();
    std::vector<TetFace> behind;
    if (!sets.modulus_mpa.empty() || !sets.quality.empty()) behind = face_owners(mesh, false);
    const auto add = [&](const std::string& name, std::vector<double> of_tets, int components = 1) {
      of_tets.reserve(static_cast<std::size_t>(components) * cells);
      for (const TetFace f : behind)
        for (int c = 0; c < components; ++c)
          of_tets.push_back(of_tets[static_cast<std::size_t>(components) * f.tet + c]);
      list.push_back({name, components, std::move(of_tets)});
    };
    if (!sets.modulus_mpa.empty()) add("modulus_MPa", sets.modulus_mpa);
    if (!sets.density_t_mm3.empty()) add("density_t_mm3", sets.density_t_mm3);
    if (!sets.quality.empty()) add("scaled_jacobian", sets.quality);
    if (!sets.axes.empty()) {
      std::vector<double> fibre;
      for (const auto& [along, across] : sets.axes) fibre.insert(fibre.end(), {along.x, along.y, along.z});
      add("fibre", std::move(fibre), 3);
    }
    if (!sets.shells.empty()) list.push_back({"skin_mm", 1, std::vector<double>(cells, 0)});
    for (const ShellSet& s : sets.shells) {
      std::map<std::array<std::int32_t, 3>, std::size_t> cell_of;
      for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
        cell_of[sorted(mesh.triangles[i].v)] = mesh.elements() + i;
      for (const TetFace f : s.faces) {
        const std::array<std::int32_t, 6> nodes = mesh.outward_face(f);
        const auto found = cell_of.find(sorted({nodes[0], nodes[1], nodes[2]}));
        if (found != cell_of.end()) list.back().values[found->second] = s.thickness_mm;
      }
    }
  }

 private:
  static std::array<std::int32_t, 3> sorted(std::array<std::int32_t, 3> v) {
    std::sort(v.begin(), v.end());
    return v;
  }
};

void add_points(XmlFile& xml, const PreparedMesh& mesh) {
  static_assert(sizeof(Vec3) == 3 * sizeof(double));
  xml << "<Points>\n";
  xml.array("Points", mesh.points, "Float64", 3);
  xml << "</Points>\n";
}

}  // namespace

void write_vtp(std::FILE* file, const PreparedMesh& mesh) {
  const CellLabels cells(mesh);
  const Connectivity polygons(mesh);
  XmlFile xml("PolyData");
  xml.field_data(mesh, true);
  xml << "<Piece NumberOfPoints=\"" + std::to_string(mesh.points.size()) +
             "\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"" +
             std::to_string(mesh.triangles.size()) + "\">\n<CellData>\n";
  xml.array("label_below", cells.below, "Int32");
  xml.array("label_above", cells.above, "Int32");
  xml << "</CellData>\n";
  add_points(xml, mesh);
  xml << "<Polys>\n";
  xml.array("connectivity", polygons.corners, "Int32");
  xml.array("offsets", polygons.ends, "Int64");
  xml << "</Polys>\n</Piece>\n";
  xml.finish(file);
}

void write_vtu(std::FILE* file, const PreparedMesh& mesh) {
  const CellLabels cells(mesh);
  const Connectivity connectivity(mesh);
  const CellFields fields(mesh);
  std::vector<std::uint8_t> types(mesh.elements() + mesh.triangles.size());
  for (std::size_t i = 0; i < types.size(); ++i) types[i] = static_cast<std::uint8_t>(cell_type(mesh, i));
  XmlFile xml("UnstructuredGrid");
  xml.field_data(mesh, false);  // meshio refuses a file that holds a string
  xml << "<Piece NumberOfPoints=\"" + std::to_string(mesh.points.size()) + "\" NumberOfCells=\"" +
             std::to_string(types.size()) + "\">\n<CellData Scalars=\"label\">\n";
  xml.array("label", cells.label, "Int32");
  xml.array("label_below", cells.below, "Int32");
  xml.array("label_above", cells.above, "Int32");
  for (const auto& [name, components, values] : fields.list) xml.array(name, values, "Float64", components);
  xml << "</CellData>\n";
  add_points(xml, mesh);
  xml << "<Cells>\n";
  xml.array("connectivity", connectivity.corners, "Int32");
  xml.array("offsets", connectivity.ends, "Int64");
  xml.array("types", types, "UInt8");
  xml << "</Cells>\n</Piece>\n";
  xml.finish(file);
}

// Legacy format 3.0, whose binary numbers are big endian.
void write_vtk(std::FILE* file, const PreparedMesh& mesh) {
  const CellLabels cells(mesh);
  OutputBuffer out(file);
  out << "# vtk DataFile Version 3.0\nstackmesh, mm" << (mesh.space.empty() ? "" : ". " + mesh.space_mark())
      << "\nBINARY\nDATASET UNSTRUCTURED_GRID\n";
  if (!mesh.space.empty())  // as characters: meshio refuses a file that holds a string
    out << "FIELD FieldData 1\nSPACE 1 " << mesh.space.size() << " char\n" << mesh.space << '\n';
  out << "POINTS " << mesh.points.size() << " double\n";
  for (const Vec3 p : mesh.points) {
    out.big_endian(p.x);
    out.big_endian(p.y);
    out.big_endian(p.z);
  }
  const std::size_t count = mesh.elements() + mesh.triangles.size();
  const Connectivity connectivity(mesh);
  out << "\nCELLS " << count << ' ' << count + connectivity.corners.size() << '\n';
  std::int64_t begin = 0;
  for (const std::int64_t end : connectivity.ends) {
    out.big_endian(static_cast<std::int32_t>(end - begin));
    for (; begin < end; ++begin) out.big_endian(connectivity.corners[begin]);
  }
  out << "\nCELL_TYPES " << count << '\n';
  for (std::size_t i = 0; i < count; ++i) out.big_endian(cell_type(mesh, i));
  const CellFields fields(mesh);
  out << "\nCELL_DATA " << count << "\nFIELD FieldData " << 3 + fields.list.size() << '\n';
  const auto field = [&](const char* name, const std::vector<std::int32_t>& values) {
    out << name << " 1 " << count << " int\n";
    for (const std::int32_t v : values) out.big_endian(v);
    out << '\n';
  };
  field("label", cells.label);
  field("label_below", cells.below);
  field("label_above", cells.above);
  for (const auto& [name, components, values] : fields.list) {
    out << name << ' ' << components << ' ' << count << " double\n";
    for (const double v : values) out.big_endian(v);
    out << '\n';
  }
}

}  // namespace stackmesh
