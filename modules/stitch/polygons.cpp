#include "stitch/polygons.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "base/error.h"
#include "stitch/planar.h"
#include "stitch/snap_rounding.h"

namespace stackmesh {
namespace {

constexpr double kSameHeight_mm = 1e-3;

using Mask = std::uint64_t;  // a bit per label: inside or not

/// All labels' polygons at one height.
struct Level {
  double z_mm;
  std::vector<const ContourSection*> of_file;  // null: the file has none at this height
  std::vector<std::size_t> index_in_file;
};

struct SourceSegment {
  std::size_t file, polygon, point;
};

class SectionMaker {
 public:
  SectionMaker(const std::vector<ContourFile>& files, std::vector<std::string>& warnings) : files_(files), warnings_(warnings) {}

  Stack run() {
    if (files_.size() > 64) fail_input("more than 64 contour files", files_[64].path, "mesh fewer labels at once");
    measure();
    rank_labels();
    Stack stack;
    stack.slices = false;
    stack.grid_x_mm = stack.grid_y_mm = grid_;
    stack.pixel_mm = median_edge_;
    stack.frame.origin = {x0_, y0_, 0};
    stack.labels.push_back({0, ""});
    std::set<Label> seen = {0};
    for (const ContourFile& f : files_) {
      if (!seen.insert(f.label).second)
        fail_input("two contour files for label " + std::to_string(f.label), f.path, "give each label one file");
      stack.labels.push_back({f.label, f.name});
    }
    std::sort(stack.labels.begin(), stack.labels.end(), [](const LabelInfo& a, const LabelInfo& b) { return a.number < b.number; });
    for (const Level& level : levels_) stack.sections.push_back(make_section(level));
    return stack;
  }

 private:
  void measure() {
    double x1 = -std::numeric_limits<double>::infinity(), y1 = x1;
    x0_ = y0_ = std::numeric_limits<double>::infinity();
    std::vector<double> edges;
    std::map<double, int> heights;
    for (const ContourFile& f : files_)
      for (const ContourSection& s : f.sections) {
        heights[s.z_mm] = 1;
        for (const ContourPolygon& p : s.polygons)
          for (std::size_t i = 0; i < p.points.size(); ++i) {
            const auto &a = p.points[i], &b = p.points[(i + 1) % p.points.size()];
            x0_ = std::min(x0_, a[0]);
            y0_ = std::min(y0_, a[1]);
            x1 = std::max(x1, a[0]);
            y1 = std::max(y1, a[1]);
            edges.push_back(std::hypot(b[0] - a[0], b[1] - a[1]));
          }
      }
    if (edges.empty()) fail_input("the file holds no contour", files_[0].path, "check the file");
    std::nth_element(edges.begin(), edges.begin() + edges.size() / 2, edges.end());
    median_edge_ = edges[edges.size() / 2];
    const double box = std::max(x1 - x0_, y1 - y0_);
    grid_ = std::exp2(std::floor(std::log2(1e-5 * box)));
    for (const auto& h : heights) {
      if (levels_.empty() || h.first - levels_.back().z_mm > kSameHeight_mm) levels_.push_back({h.first, {}, {}});
    }
    std::size_t filled = 0;
    for (Level& level : levels_) {
      level.of_file.assign(files_.size(), nullptr);
      level.index_in_file.assign(files_.size(), 0);
      bool any = false;
      for (std::size_t f = 0; f < files_.size(); ++f)
        for (std::size_t i = 0; i < files_[f].sections.size(); ++i) {
          const ContourSection& s = files_[f].sections[i];
          if (s.z_mm < level.z_mm || s.z_mm > level.z_mm + kSameHeight_mm) continue;
          level.of_file[f] = &s;
          level.index_in_file[f] = i;
          any = any || !s.polygons.empty();
        }
      filled += any ? 1 : 0;
    }
    if (filled < 2)
      fail_input("only " + std::to_string(filled) + " section with contours", files_[0].path, "give at least two sections");
    warn_missing();
  }

  void warn_missing() {
    for (std::size_t f = 0; f < files_.size(); ++f) {
      if (files_[f].sections.empty()) continue;
      const double low = files_[f].sections.front().z_mm, high = files_[f].sections.back().z_mm;
      std::size_t missing = 0;
      double first = 0;
      for (const Level& level : levels_)
        if (level.z_mm > low && level.z_mm < high - kSameHeight_mm && level.of_file[f] == nullptr && missing++ == 0) first = level.z_mm;
      if (missing > 0)
        warnings_.push_back(files_[f].path + " has no contour at " + std::to_string(missing) +
                            " height(s) that other labels have (first: z = " + std::to_string(first) + " mm); it is empty there");
    }
  }

  /// Inner labels win over outer ones: the smaller the area, the higher the rank.
  void rank_labels() {
    std::vector<double> area(files_.size(), 0);
    for (std::size_t f = 0; f < files_.size(); ++f)
      for (const ContourSection& s : files_[f].sections)
        for (const ContourPolygon& p : s.polygons) {
          double a = 0;
          for (std::size_t i = 0; i < p.points.size(); ++i) {
            const auto &u = p.points[i], &v = p.points[(i + 1) % p.points.size()];
            a += (u[0] - x0_) * (v[1] - y0_) - (v[0] - x0_) * (u[1] - y0_);
          }
          area[f] += std::abs(a);
        }
    for (std::size_t f = 0; f < files_.size(); ++f) by_rank_.push_back(f);
    std::stable_sort(by_rank_.begin(), by_rank_.end(), [&](std::size_t a, std::size_t b) { return area[a] < area[b]; });
  }

  Label winner(Mask mask) const {
    for (std::size_t f : by_rank_)
      if (mask >> f & 1) return files_[f].label;
    return 0;
  }

  GridPoint to_grid(const std::array<double, 2>& p) const {
    return {static_cast<std::int32_t>(std::lround((p[0] - x0_) / grid_)), static_cast<std::int32_t>(std::lround((p[1] - y0_) / grid_))};
  }

  std::string where(const Level& level, const SourceSegment& s) const {
    return files_[s.file].path + ", section " + std::to_string(level.index_in_file[s.file] + 1) + " at z = " +
           std::to_string(level.z_mm) + " mm, contour " + std::to_string(s.polygon + 1);
  }

  /// Contours of one label must not cross; decided on the given coordinates, exactly.
  void check_crossings(const Level& level, const std::vector<GridSegment>& segments, const std::vector<SourceSegment>& sources) const {
    const EdgeGrid grid(segments);
    for (std::size_t i = 0; i < segments.size(); ++i)
      grid.near_segment(segments[i], [&](std::int32_t k) {
        if (static_cast<std::size_t>(k) >= i || sources[k].file != sources[i].file || !properly_cross(segments[i], segments[k])) return;
        const auto [a, b] = ends(level, sources[i]);
        const auto [c, d] = ends(level, sources[k]);
        if (CGAL::orientation(a, b, c) * CGAL::orientation(a, b, d) >= 0 || CGAL::orientation(c, d, a) * CGAL::orientation(c, d, b) >= 0)
          return;  // only rounding makes them cross; snap rounding sees to that
        const std::string at = " near (" + std::to_string(CGAL::to_double(a.x())) + ", " + std::to_string(CGAL::to_double(a.y())) + ")";
        if (sources[i].polygon == sources[k].polygon)
          fail_input("contour crosses itself" + at, where(level, sources[i]), "mend the contour");
        fail_input("contour " + std::to_string(sources[k].polygon + 1) + " overlaps contour " +
                       std::to_string(sources[i].polygon + 1) + at,
                   where(level, sources[i]), "contours of one label must not cross");
      });
  }

  std::pair<PlanarPoint, PlanarPoint> ends(const Level& level, const SourceSegment& s) const {
    const auto& points = level.of_file[s.file]->polygons[s.polygon].points;
    const auto &a = points[s.point], &b = points[(s.point + 1) % points.size()];
    return {PlanarPoint(a[0], a[1]), PlanarPoint(b[0], b[1])};
  }

  struct MaskedEdge {
    std::int32_t a, b;
    Mask mask;
  };

  /// Noded edges with the labels that change over them; what is walked twice cancels.
  static std::vector<MaskedEdge> merge(const NodedSegments& noded, const std::vector<SourceSegment>& sources) {
    std::vector<MaskedEdge> edges;
    for (const NodedEdge& e : noded.edges)
      edges.push_back({std::min(e.a, e.b), std::max(e.a, e.b), Mask{1} << sources[e.source].file});
    std::sort(edges.begin(), edges.end(), [](const MaskedEdge& u, const MaskedEdge& v) { return u.a != v.a ? u.a < v.a : u.b < v.b; });
    std::size_t kept = 0;
    for (std::size_t i = 0, j; i < edges.size(); i = j) {
      MaskedEdge sum = edges[i];
      for (j = i + 1; j < edges.size() && edges[j].a == sum.a && edges[j].b == sum.b; ++j) sum.mask ^= edges[j].mask;
      if (sum.mask != 0) edges[kept++] = sum;
    }
    edges.resize(kept);
    return edges;
  }

  Section make_section(const Level& level) const {
    std::vector<GridSegment> segments;
    std::vector<SourceSegment> sources;
    for (std::size_t f = 0; f < files_.size(); ++f) {
      if (level.of_file[f] == nullptr) continue;
      const auto& polygons = level.of_file[f]->polygons;
      for (std::size_t p = 0; p < polygons.size(); ++p)
        for (std::size_t i = 0; i < polygons[p].points.size(); ++i) {
          const GridPoint a = to_grid(polygons[p].points[i]), b = to_grid(polygons[p].points[(i + 1) % polygons[p].points.size()]);
          if (a == b) continue;
          segments.push_back({a, b});
          sources.push_back({f, p, i});
        }
    }
    check_crossings(level, segments, sources);
    NodedSegments noded = std::move(node_segments({segments}, 1)[0]);
    const std::vector<MaskedEdge> edges = merge(noded, sources);
    Section section;
    section.z_mm = level.z_mm;
    if (edges.empty()) return section;

    Cdt cdt;
    std::vector<VertexHandle> handles;
    for (const GridPoint p : noded.points) handles.push_back(cdt.insert(PlanarPoint(p.x, p.y)));
    for (const MaskedEdge& e : edges) cdt.insert_constraint(handles[e.a], handles[e.b]);
    const std::vector<Mask> region_mask = grow_regions(cdt, handles, edges);
    section.points = std::move(noded.points);
    for (const MaskedEdge& e : edges) {
      const auto [left, right] = sides(cdt, handles[e.a], handles[e.b]);
      const Label l = winner(region_mask[left->info().sheet]), r = winner(region_mask[right->info().sheet]);
      if (l != r) section.edges.push_back({e.a, e.b, l, r});
    }
    return section;
  }

  static std::pair<FaceHandle, FaceHandle> sides(const Cdt& cdt, VertexHandle a, VertexHandle b) {
    FaceHandle face;
    int i = 0;
    if (!cdt.is_edge(a, b, face, i)) fail_internal("a contour edge is missing in the triangulation", "orienting contours");
    const FaceHandle other = face->neighbor(i);
    return face->vertex(Cdt::ccw(i)) == a ? std::make_pair(face, other) : std::make_pair(other, face);
  }

  /// Regions grown without crossing a contour (paper 3.1.2), then which labels cover each, from the outside in.
  static std::vector<Mask> grow_regions(Cdt& cdt, const std::vector<VertexHandle>& handles, const std::vector<MaskedEdge>& edges) {
    std::int32_t regions = 0;
    const auto grow = [&](FaceHandle start) {
      std::vector<FaceHandle> stack = {start};
      start->info().sheet = regions;
      while (!stack.empty()) {
        const FaceHandle f = stack.back();
        stack.pop_back();
        for (int i = 0; i < 3; ++i)
          if (!f->is_constrained(i) && f->neighbor(i)->info().sheet < 0) {
            f->neighbor(i)->info().sheet = regions;
            stack.push_back(f->neighbor(i));
          }
      }
      ++regions;
    };
    grow(cdt.infinite_face());
    for (const FaceHandle f : cdt.all_face_handles())
      if (f->info().sheet < 0) grow(f);
    std::vector<std::vector<std::pair<std::int32_t, Mask>>> beside(regions);
    for (const MaskedEdge& e : edges) {
      const auto [left, right] = sides(cdt, handles[e.a], handles[e.b]);
      beside[left->info().sheet].emplace_back(right->info().sheet, e.mask);
      beside[right->info().sheet].emplace_back(left->info().sheet, e.mask);
    }
    std::vector<Mask> mask(regions, 0);
    std::vector<char> known(regions, 0);
    std::vector<std::int32_t> stack = {0};
    known[0] = 1;
    while (!stack.empty()) {
      const std::int32_t r = stack.back();
      stack.pop_back();
      for (const auto& [next, change] : beside[r])
        if (!known[next]) {
          known[next] = 1;
          mask[next] = mask[r] ^ change;
          stack.push_back(next);
        }
    }
    return mask;
  }

  const std::vector<ContourFile>& files_;
  std::vector<std::string>& warnings_;
  std::vector<Level> levels_;
  std::vector<std::size_t> by_rank_;
  double x0_ = 0, y0_ = 0, grid_ = 1, median_edge_ = 1;
};

}  // namespace

Stack sections_from_contours(const std::vector<ContourFile>& files, std::vector<std::string>& warnings) {
  return SectionMaker(files, warnings).run();
}

}  // namespace stackmesh
