#include "validate/check_volume.h"

#include <algorithm>
#include <limits>
#include <map>
#include <set>
#include <string>

#include "base/error.h"
#include "base/parallel.h"
#include "validate/check_wedges.h"
#include "validate/exact.h"
#include "validate/statistics.h"

namespace stackmesh {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

void check_input(const TetMesh& mesh) {
  const auto fine = [n = static_cast<std::int64_t>(mesh.points.size())](std::int32_t v) { return v >= 0 && v < n; };
  if (mesh.labels.size() != mesh.elements())
    fail_input(std::to_string(mesh.labels.size()) + " labels for " + std::to_string(mesh.elements()) +
                   (mesh.wedges.empty() ? " tets" : " elements"),
               "tetrahedral mesh", "write the mesh again");
  for (std::size_t t = mesh.tets.size(); t < mesh.elements(); ++t)
    each_node(mesh, t, [&](std::int32_t v) {
      if (!fine(v))
        fail_input("a wedge names a point that does not exist", "element " + std::to_string(t), "write the mesh again");
    });
  const bool all = mesh.wedge_mid.size() == mesh.wedges.size(), none = mesh.wedge_mid.empty();
  if (!(all || none) || (!mesh.tets.empty() && !mesh.wedges.empty() && mesh.mid.empty() != none))
    fail_input("mid-side nodes for " + std::to_string(mesh.wedge_mid.size()) + " of " +
                   std::to_string(mesh.wedges.size()) + " wedges",
               "tetrahedral mesh", "write the mesh again");
  for (std::size_t t = 0; t < mesh.tets.size(); ++t)
    if (!std::all_of(mesh.tets[t].begin(), mesh.tets[t].end(), fine))
      fail_input("a tet names a point that does not exist", "tet " + std::to_string(t), "write the mesh again");
  if (!mesh.mid.empty() && mesh.mid.size() != mesh.tets.size())
    fail_input(
        "mid-side nodes for " + std::to_string(mesh.mid.size()) + " of " + std::to_string(mesh.tets.size()) + " tets",
        "tetrahedral mesh", "write the mesh again");
  for (std::size_t t = 0; t < mesh.mid.size(); ++t)
    if (!std::all_of(mesh.mid[t].begin(), mesh.mid[t].end(), fine))
      fail_input("a mid-side node does not exist", "tet " + std::to_string(t), "write the mesh again");
  for (std::size_t t = 0; t < mesh.faces.size(); ++t)
    if (!std::all_of(mesh.faces[t].v.begin(), mesh.faces[t].v.end(), fine))
      fail_input("a face names a point that does not exist", "face " + std::to_string(t), "write the mesh again");
  for (std::size_t p = 0; p < mesh.points.size(); ++p)
    if (!std::isfinite(mesh.points[p].x) || !std::isfinite(mesh.points[p].y) || !std::isfinite(mesh.points[p].z))
      fail_input("a coordinate is not a finite number", "point " + std::to_string(p), "write the mesh again");
}

struct Shape {
  double dihedral_min_deg, dihedral_max_deg, radius_edge, scaled_jacobian, volume_mm3;
  std::array<std::int8_t, 2> sharpest = {0, 1};  // corners of the edge with the smallest dihedral
  std::array<std::uint8_t, 6> bins = {0, 0, 0, 0, 0, 35};
};

/// Edge between faces i and j of a tet: the two corners that both have.
constexpr std::int8_t kEdgeOfFaces[4][4][2] = {{{0, 0}, {2, 3}, {1, 3}, {1, 2}},
                                               {{2, 3}, {0, 0}, {0, 3}, {0, 2}},
                                               {{1, 3}, {0, 3}, {0, 0}, {0, 1}},
                                               {{1, 2}, {0, 2}, {0, 1}, {0, 0}}};

Shape shape_of(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 u = b - a, v = c - a, w = d - a, e = c - b, f = d - b, g = d - c;
  const double det = dot(u, cross(v, w));
  const double lu = norm(u), lv = norm(v), lw = norm(w), le = norm(e), lf = norm(f), lg = norm(g);
  Shape s{0, 180, kInfinity, 0, det / 6};
  const double product = std::max({lu * lv * lw, lu * le * lf, lv * le * lg, lw * lf * lg});
  if (product > 0) s.scaled_jacobian = std::sqrt(2.0) * det / product;
  if (det != 0) {
    const Vec3 to_centre = dot(u, u) * cross(v, w) + dot(v, v) * cross(w, u) + dot(w, w) * cross(u, v);
    s.radius_edge = norm(to_centre) / (2 * std::abs(det)) / std::min({lu, lv, lw, le, lf, lg});
  }
  Vec3 n[4] = {cross(e, f), cross(w, v), cross(u, w), cross(v, u)};
  int count = 0;
  double smallest = 1, largest = -1;  // cosines of the dihedrals, largest dihedral first
  for (Vec3& m : n) {
    const double length = norm(m);
    if (length == 0) return s;
    m = (1 / length) * m;
  }
  for (int i = 0; i < 4; ++i)
    for (int j = i + 1; j < 4; ++j) {
      const double cosine = -dot(n[i], n[j]);
      if (cosine > largest) s.sharpest = {kEdgeOfFaces[i][j][0], kEdgeOfFaces[i][j][1]};
      smallest = std::min(smallest, cosine), largest = std::max(largest, cosine);
      const double angle = kDegrees * std::acos(std::clamp(cosine, -1.0, 1.0));
      s.bins[count++] = static_cast<std::uint8_t>(std::min(35.0, angle / 5));
    }
  s.dihedral_min_deg = kDegrees * std::acos(std::clamp(largest, -1.0, 1.0));
  s.dihedral_max_deg = kDegrees * std::acos(std::clamp(smallest, -1.0, 1.0));
  return s;
}

/// The Jacobian determinant of a 10-node tet at barycentric coordinates l, from its shape functions.
double determinant(const std::array<Vec3, 10>& node, const std::array<double, 4>& l) {
  static constexpr int kEnds[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
  std::array<Vec3, 4> d = {};  // derivatives by each barycentric coordinate
  for (int i = 0; i < 4; ++i) d[i] = (4 * l[i] - 1) * node[i];
  for (int e = 0; e < 6; ++e) {
    d[kEnds[e][0]] = d[kEnds[e][0]] + 4 * l[kEnds[e][1]] * node[4 + e];
    d[kEnds[e][1]] = d[kEnds[e][1]] + 4 * l[kEnds[e][0]] * node[4 + e];
  }
  return dot(d[1] - d[0], cross(d[2] - d[0], d[3] - d[0]));
}

/// Takes the mid-side nodes into account. A tet whose nodes lie in the middle of its edges, but for rounding, is as its
/// corners are.
void judge_curved(const TetMesh& mesh, std::size_t t, Shape& shape, char& inverted) {
  std::array<Vec3, 10> node;
  for (int i = 0; i < 4; ++i) node[i] = mesh.points[mesh.tets[t][i]];
  for (int i = 0; i < 6; ++i) node[4 + i] = mesh.points[mesh.mid[t][i]];
  double size = 0, off = 0;
  for (int i = 0; i < 4; ++i) size = std::max({size, std::abs(node[i].x), std::abs(node[i].y), std::abs(node[i].z)});
  static constexpr int kEnds[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
  for (int e = 0; e < 6; ++e) off = std::max(off, norm(node[4 + e] - 0.5 * (node[kEnds[e][0]] + node[kEnds[e][1]])));
  if (off <= 4 * std::numeric_limits<double>::epsilon() * size) return;
  double least = kInfinity;
  const auto at = [&](double a, double b, double c, double d) {
    const double value = determinant(node, {a, b, c, d});
    least = std::min(least, value);
    return value;
  };
  const auto at_all_corners = [&](double a) {  // a at one corner, the rest shared by the others
    const double b = (1 - a) / 3;
    return at(a, b, b, b) + at(b, a, b, b) + at(b, b, a, b) + at(b, b, b, a);
  };
  const auto at_all_edges = [&](double a) {
    const double b = 0.5 - a;
    at(a, a, b, b), at(a, b, a, b), at(a, b, b, a), at(b, a, a, b), at(b, a, b, a), at(b, b, a, a);
  };
  at_all_corners(1), at_all_corners(0), at_all_edges(0.5);
  at_all_corners(0.5854101966249685);                                    // 4 integration points: CalculiX, Abaqus C3D10
  at_all_corners(0.7857142857142857), at_all_edges(0.3994035761667992);  // and 11
  const double integral = -0.8 * at(0.25, 0.25, 0.25, 0.25) + 0.45 * at_all_corners(0.5);  // exact for a cubic
  const double straight = 6 * shape.volume_mm3;
  shape.volume_mm3 = integral / 6;
  if (straight > 0) shape.scaled_jacobian *= least / straight;
  inverted = inverted || !(least > 0);
}

/// Tets below 10 degrees whose sharp edge is one of the surface, where the tets between the two surface triangles next
/// to them span less than 10 degrees together.
std::size_t count_in_narrow_wedges(const TetMesh& mesh, const std::vector<Shape>& shapes) {
  using Edge = std::array<std::int32_t, 2>;
  using Triangle = std::array<std::int32_t, 3>;
  const auto edge_of = [](std::int32_t a, std::int32_t b) { return Edge{std::min(a, b), std::max(a, b)}; };
  struct Around {
    std::size_t tet;
    std::int32_t wing[2];  // the corners that are not on the edge
    double angle;
    std::size_t group;
  };
  std::map<Edge, std::vector<Around>> edges;
  std::vector<char> ends(mesh.points.size(), 0);
  for (std::size_t t = 0; t < shapes.size(); ++t) {
    if (!(shapes[t].dihedral_min_deg < 10)) continue;
    const Edge e = edge_of(mesh.tets[t][shapes[t].sharpest[0]], mesh.tets[t][shapes[t].sharpest[1]]);
    edges[e];
    ends[e[0]] = ends[e[1]] = 1;
  }
  if (edges.empty()) return 0;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t)
    for (int i = 0; i < 4; ++i)
      for (int j = i + 1; j < 4; ++j) {
        const auto& v = mesh.tets[t];
        if (!ends[v[i]] || !ends[v[j]]) continue;
        const auto at = edges.find(edge_of(v[i], v[j]));
        if (at == edges.end()) continue;
        const int k = 6 - i - j;  // the others are k - m and m
        int m = 0;
        while (m == i || m == j) ++m;
        const Vec3 axis = mesh.points[v[j]] - mesh.points[v[i]];
        const Vec3 a = cross(axis, mesh.points[v[m]] - mesh.points[v[i]]),
                   b = cross(axis, mesh.points[v[k - m]] - mesh.points[v[i]]);
        at->second.push_back(
            {t, {v[m], v[k - m]}, kDegrees * std::atan2(norm(cross(a, b)), dot(a, b)), at->second.size()});
      }
  std::set<Triangle> walls;
  for (const InterfaceTriangle& f : mesh.faces)
    if (ends[f.v[0]] + ends[f.v[1]] + ends[f.v[2]] >= 2) {
      Triangle key = f.v;
      std::sort(key.begin(), key.end());
      walls.insert(key);
    }
  std::size_t count = 0;
  for (auto& [edge, around] : edges) {
    const auto wall = [&, e = edge](std::int32_t wing) {
      Triangle key = {e[0], e[1], wing};
      std::sort(key.begin(), key.end());
      return walls.count(key) > 0;
    };
    bool bounded = false;
    for (std::size_t i = 0; i < around.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        for (const std::int32_t w : around[i].wing)
          if ((w == around[j].wing[0] || w == around[j].wing[1]) && !wall(w)) {
            const std::size_t from = std::max(around[i].group, around[j].group),
                              to = std::min(around[i].group, around[j].group);
            for (Around& a : around)
              if (a.group == from) a.group = to;
          }
    std::map<std::size_t, double> span;
    for (const Around& a : around) {
      span[a.group] += a.angle;
      bounded = bounded || wall(a.wing[0]) || wall(a.wing[1]);
    }
    if (!bounded) continue;
    for (const Around& a : around)
      if (shapes[a.tet].dihedral_min_deg < 10 && span[a.group] < 10 &&
          edge_of(mesh.tets[a.tet][shapes[a.tet].sharpest[0]], mesh.tets[a.tet][shapes[a.tet].sharpest[1]]) == edge)
        ++count;
  }
  return count;
}

/// Tets below 10 degrees that have no inner edge, or a corner on the surface right above a face on the surface.
std::size_t count_pinched(const TetMesh& mesh, const std::vector<Shape>& shapes) {
  std::vector<std::size_t> bad;
  std::vector<char> corner(mesh.points.size(), 0);
  for (std::size_t t = 0; t < shapes.size(); ++t) {
    if (!(shapes[t].dihedral_min_deg < 10)) continue;
    bad.push_back(t);
    for (const std::int32_t v : mesh.tets[t]) corner[v] = 1;
  }
  std::set<std::array<std::int32_t, 2>> edges;
  std::set<std::array<std::int32_t, 3>> walls;
  for (const InterfaceTriangle& f : mesh.faces) {
    for (int k = 0; k < 3; ++k) {
      const std::int32_t a = f.v[k], b = f.v[(k + 1) % 3];
      if (corner[a] && corner[b]) edges.insert({std::min(a, b), std::max(a, b)});
    }
    for (const std::int32_t v : f.v)
      if (corner[v]) corner[v] = 2;  // on the surface
    std::array<std::int32_t, 3> key = f.v;
    std::sort(key.begin(), key.end());
    if (corner[key[0]] && corner[key[1]] && corner[key[2]]) walls.insert(key);
  }
  const auto stands_above_a_wall = [&](const std::array<std::int32_t, 4>& v, int apex) {
    if (corner[v[apex]] != 2) return false;
    std::array<std::int32_t, 3> face = {v[(apex + 1) & 3], v[(apex + 2) & 3], v[(apex + 3) & 3]};
    std::sort(face.begin(), face.end());
    if (walls.count(face) == 0) return false;
    const Vec3 &a = mesh.points[face[0]], &b = mesh.points[face[1]], &c = mesh.points[face[2]],
               &p = mesh.points[v[apex]];
    const Vec3 n = cross(b - a, c - a);
    return dot(cross(b - a, p - a), n) > 0 && dot(cross(c - b, p - b), n) > 0 && dot(cross(a - c, p - c), n) > 0;
  };
  std::size_t count = 0;
  for (const std::size_t t : bad) {
    int found = 0;
    for (int i = 0; i < 4; ++i)
      for (int j = i + 1; j < 4; ++j) {
        const auto [a, b] = std::minmax(mesh.tets[t][i], mesh.tets[t][j]);
        found += static_cast<int>(edges.count({a, b}));
      }
    bool above = false;
    for (int apex = 0; apex < 4; ++apex) above = above || stands_above_a_wall(mesh.tets[t], apex);
    count += found == 6 || above;
  }
  return count;
}

void measure(const TetMesh& mesh, int threads, std::size_t limit, VolumeCheck& check) {
  std::vector<Shape> shapes(mesh.tets.size());
  std::vector<char> inverted(mesh.tets.size());
  constexpr std::size_t kChunk = 1 << 13;
  parallel_for((shapes.size() + kChunk - 1) / kChunk, threads, [&](std::size_t chunk) {
    for (std::size_t t = chunk * kChunk; t < std::min(shapes.size(), (chunk + 1) * kChunk); ++t) {
      const auto& v = mesh.tets[t];
      const Vec3 &a = mesh.points[v[0]], &b = mesh.points[v[1]], &c = mesh.points[v[2]], &d = mesh.points[v[3]];
      shapes[t] = shape_of(a, b, c, d);
      inverted[t] = exact_orientation(a, b, c, d) <= 0;
      if (!mesh.mid.empty()) judge_curved(mesh, t, shapes[t], inverted[t]);
    }
  });
  struct Sum {
    LabelTets row;
    long double volume_mm3 = 0;
  };
  std::map<Label, Sum> labels;
  std::vector<double> dihedrals(shapes.size());
  for (std::size_t t = 0; t < shapes.size(); ++t) {
    const Shape& s = shapes[t];
    Sum& label = labels[mesh.labels[t]];
    ++label.row.tets;
    label.volume_mm3 += s.volume_mm3;
    label.row.dihedral_min_deg = std::min(label.row.dihedral_min_deg, s.dihedral_min_deg);
    label.row.dihedral_max_deg = std::max(label.row.dihedral_max_deg, s.dihedral_max_deg);
    check.inverted += inverted[t];
    for (const std::uint8_t bin : s.bins) ++check.dihedral_histogram[bin];
    if (inverted[t] && check.inverted_list.size() < limit) check.inverted_list.push_back(static_cast<std::int32_t>(t));
    dihedrals[t] = s.dihedral_min_deg;
    check.dihedral_below_10 += s.dihedral_min_deg < 10;
    check.dihedral_max_deg = std::max(check.dihedral_max_deg, s.dihedral_max_deg);
    check.radius_edge_max = std::max(check.radius_edge_max, s.radius_edge);
    check.scaled_jacobian_min = t == 0 ? s.scaled_jacobian : std::min(check.scaled_jacobian_min, s.scaled_jacobian);
  }
  for (std::size_t w = 0; w < mesh.wedges.size(); ++w) {
    const WedgeShape shape = wedge_shape(mesh, w);
    const std::size_t element = mesh.tets.size() + w;
    Sum& label = labels[mesh.labels[element]];
    ++label.row.wedges;
    label.volume_mm3 += shape.volume_mm3;
    ++(is_pyramid(mesh.wedges[w]) ? check.pyramids : check.wedges);
    check.inverted += shape.inverted;
    if (shape.inverted && check.inverted_list.size() < limit)
      check.inverted_list.push_back(static_cast<std::int32_t>(element));
    check.wedge_scaled_jacobian_min =
        w == 0 ? shape.scaled_jacobian : std::min(check.wedge_scaled_jacobian_min, shape.scaled_jacobian);
  }
  check.pinched = count_pinched(mesh, shapes);
  check.in_narrow_wedges = count_in_narrow_wedges(mesh, shapes);
  check.dihedral_p1_deg = percentile(dihedrals, 0.01);
  check.dihedral_min_deg = percentile(dihedrals, 0);
  for (auto& [label, sum] : labels) {
    sum.row.label = label;
    sum.row.volume_mm3 = static_cast<double>(sum.volume_mm3);
    check.labels.push_back(sum.row);
  }
}

/// A triangle with its points ascending. `even`: as written it runs like its ascending points, so that for a
/// face of a tet, seen from outside, the tet lies below the ascending triangle.
struct Face {
  std::int32_t middle, high;
  Label below, above;  // of a tet: its own label twice
  bool of_tet, even;
};

class ConformityCheck {
 public:
  ConformityCheck(const TetMesh& mesh, int threads, std::size_t limit, VolumeCheck& check)
      : mesh_(mesh), threads_(threads), limit_(limit), check_(check) {}

  void run() {
    std::vector<std::int64_t> start(mesh_.points.size() + 1, 0);
    each([&](std::int32_t low, const Face&) { ++start[low + 1]; });
    for (std::size_t p = 0; p < mesh_.points.size(); ++p) start[p + 1] += start[p];
    std::vector<Face> faces(start.back());
    each([&](std::int32_t low, const Face& face) { faces[start[low]++] = face; });
    constexpr std::size_t kChunk = 1 << 12;  // points
    struct Found {
      std::size_t count = 0;
      std::vector<std::array<std::int32_t, 3>> list;
    };
    std::vector<Found> found((mesh_.points.size() + kChunk - 1) / kChunk);
    parallel_for(found.size(), threads_, [&](std::size_t chunk) {
      for (std::size_t low = chunk * kChunk; low < std::min(mesh_.points.size(), (chunk + 1) * kChunk); ++low) {
        const std::int64_t begin = low == 0 ? 0 : start[low - 1], end = start[low];
        std::sort(faces.begin() + begin, faces.begin() + end, [](const Face& a, const Face& b) {
          return a.middle != b.middle ? a.middle < b.middle : a.high < b.high;
        });
        for (std::int64_t i = begin, j; i < end; i = j) {
          for (j = i; j < end && faces[j].middle == faces[i].middle && faces[j].high == faces[i].high; ++j) {
          }
          if (conforming(&faces[i], &faces[i] + (j - i))) continue;
          ++found[chunk].count;
          if (found[chunk].list.size() < limit_)
            found[chunk].list.push_back({static_cast<std::int32_t>(low), faces[i].middle, faces[i].high});
        }
      }
    });
    for (const Found& f : found) {
      check_.nonconforming_faces += f.count;
      for (const auto& face : f.list)
        if (check_.nonconforming_list.size() < limit_) check_.nonconforming_list.push_back(face);
    }
    for (const auto& side : unshared_sides(mesh_)) {
      ++check_.nonconforming_faces;
      if (check_.nonconforming_list.size() < limit_) check_.nonconforming_list.push_back({side[0], side[1], side[2]});
    }
    check_.conforms = check_.nonconforming_faces == 0;
  }

 private:
  template <class Visit>
  void add(std::array<std::int32_t, 3> v, bool of_tet, Label below, Label above, Visit& visit) {
    bool even = true;
    const auto order = [&](int i, int j) {
      if (v[i] > v[j]) std::swap(v[i], v[j]), even = !even;
    };
    order(0, 1), order(1, 2), order(0, 1);
    visit(v[0], Face{v[1], v[2], even ? below : above, even ? above : below, of_tet, even});
  }

  template <class Visit>
  void each(Visit visit) {
    for (std::size_t t = 0; t < mesh_.tets.size(); ++t) {
      const auto& [a, b, c, d] = mesh_.tets[t];
      const Label l = mesh_.labels[t];
      add({b, c, d}, true, l, l, visit);
      add({a, d, c}, true, l, l, visit);
      add({a, b, d}, true, l, l, visit);
      add({a, c, b}, true, l, l, visit);
    }
    for (std::size_t w = 0; w < mesh_.wedges.size(); ++w) {
      const Label l = mesh_.labels[mesh_.tets.size() + w];
      each_wedge_triangle(mesh_.wedges[w], [&](const std::array<std::int32_t, 3>& v) { add(v, true, l, l, visit); });
    }
    for (const auto& f : mesh_.faces) add(f.v, false, f.below, f.above, visit);
  }

  /// One triangle: the tets and the interface faces on it.
  static bool conforming(const Face* begin, const Face* end) {
    Label below = 0, above = 0;
    int tets_below = 0, tets_above = 0, interfaces = 0;
    const Face* interface = nullptr;
    for (const Face* f = begin; f != end; ++f) {
      if (!f->of_tet) interface = f, ++interfaces;
      if (f->of_tet && f->even) below = f->below, ++tets_below;
      if (f->of_tet && !f->even) above = f->above, ++tets_above;
    }
    if (tets_below > 1 || tets_above > 1 || tets_below + tets_above == 0) return false;
    if (below == above) return interfaces == 0;
    return interfaces == 1 && interface->below == below && interface->above == above;
  }

  const TetMesh& mesh_;
  const int threads_;
  const std::size_t limit_;
  VolumeCheck& check_;
};

/// Elements that share an edge share its node, and no node is on two edges, or a corner.
std::size_t count_unshared_edges(const TetMesh& mesh) {
  struct Edge {
    std::int32_t low, high, mid;
    bool operator<(const Edge& o) const {
      return low != o.low ? low < o.low : high != o.high ? high < o.high : mid < o.mid;
    }
    bool operator==(const Edge& o) const { return low == o.low && high == o.high && mid == o.mid; }
  };
  static constexpr int kEnds[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
  std::vector<Edge> edges;
  edges.reserve(6 * mesh.mid.size());
  std::vector<char> taken(mesh.points.size(), 0);
  for (std::size_t t = 0; t < mesh.mid.size(); ++t) {
    for (int e = 0; e < 6; ++e) {
      const std::int32_t a = mesh.tets[t][kEnds[e][0]], b = mesh.tets[t][kEnds[e][1]];
      edges.push_back({std::min(a, b), std::max(a, b), mesh.mid[t][e]});
    }
    for (const std::int32_t v : mesh.tets[t]) taken[v] = 1;
  }
  for (std::size_t w = 0; w < mesh.wedge_mid.size(); ++w) {
    static constexpr int kSides[9][2] = {{0, 1}, {1, 2}, {2, 0}, {3, 4}, {4, 5}, {5, 3}, {0, 3}, {1, 4}, {2, 5}};
    for (int e = 0; e < (is_pyramid(mesh.wedges[w]) ? 8 : 9); ++e) {
      const std::int32_t a = mesh.wedges[w][kSides[e][0]], b = mesh.wedges[w][kSides[e][1]];
      edges.push_back({std::min(a, b), std::max(a, b), mesh.wedge_mid[w][e]});
    }
    for (const std::int32_t v : mesh.wedges[w]) taken[v] = 1;
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  std::size_t bad = 0;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const bool again = i > 0 && edges[i].low == edges[i - 1].low && edges[i].high == edges[i - 1].high;
    bad += again || taken[edges[i].mid];
    taken[edges[i].mid] = 1;
  }
  return bad;
}

}  // namespace

VolumeCheck check_volume(const TetMesh& mesh, const VolumeCheckOptions& options) {
  check_input(mesh);
  VolumeCheck check;
  check.nodes = mesh.points.size();
  check.tets = mesh.tets.size();
  check.order = mesh.mid.empty() && mesh.wedge_mid.empty() ? 1 : 2;
  measure(mesh, options.threads, options.list_limit, check);
  ConformityCheck(mesh, options.threads, options.list_limit, check).run();
  check.nonconforming_edges = count_unshared_edges(mesh);
  check.conforms = check.conforms && check.nonconforming_edges == 0;
  return check;
}

}  // namespace stackmesh
