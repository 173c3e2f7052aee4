#include "sections/mend_crossings.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <string>
#include <utility>

#include "base/error.h"
#include "planar/planar.h"
#include "sections/contour_crossings.h"

namespace stackmesh {
namespace {

constexpr double kSafeUnion_rel = 0.05;  // of the union may be drawn over twice

struct Crossing {
  SourceSegment first, second;
  std::string near;
};

class CrossingMender {
 public:
  CrossingMender(const std::vector<LabelContours>& files, const DrawnLevel& level, const DrawnGrid& grid,
                 std::vector<GridSegment>& segments, std::vector<SourceSegment>& sources)
      : files_(files), level_(level), grid_(grid), segments_(segments), sources_(sources) {}

  std::set<std::size_t> run(bool repair) {
    const std::vector<Crossing> crossings = find();
    if (!crossings.empty() && !repair) refuse(crossings[0]);
    std::set<std::size_t> files;
    for (const Crossing& c : crossings) files.insert(c.first.file);
    for (const std::size_t f : files) unite(f, crossings);
    return files;
  }

 private:
  std::vector<Crossing> find() const {
    std::vector<Crossing> found;
    const EdgeGrid grid(segments_);
    for (std::size_t i = 0; i < segments_.size(); ++i)
      grid.near_segment(segments_[i], [&](std::int32_t k) {
        if (static_cast<std::size_t>(k) >= i || sources_[k].file != sources_[i].file ||
            !properly_cross(segments_[i], segments_[k]))
          return;
        const auto [a, b] = ends(sources_[i]);
        const auto [c, d] = ends(sources_[k]);
        if (CGAL::orientation(a, b, c) * CGAL::orientation(a, b, d) >= 0 ||
            CGAL::orientation(c, d, a) * CGAL::orientation(c, d, b) >= 0)
          return;  // only rounding makes them cross; snap rounding sees to that
        found.push_back(
            {sources_[i], sources_[k],
             " near (" + std::to_string(CGAL::to_double(a.x())) + ", " + std::to_string(CGAL::to_double(a.y())) + ")"});
      });
    return found;
  }

  std::pair<PlanarPoint, PlanarPoint> ends(const SourceSegment& s) const {
    const auto& points = level_.of_file[s.file]->polygons[s.polygon].points;
    const auto &a = points[s.point], &b = points[(s.point + 1) % points.size()];
    return {PlanarPoint(a[0], a[1]), PlanarPoint(b[0], b[1])};
  }

  std::string where(const SourceSegment& s) const {
    const std::string name = files_[s.file].name.empty() ? "" : ", '" + files_[s.file].name + "'";
    return files_[s.file].path + name + ", section " + std::to_string(level_.index_in_file[s.file] + 1) +
           " at z = " + std::to_string(level_.z_mm) + " mm, contour " + std::to_string(s.polygon + 1);
  }

  [[noreturn]] void refuse(const Crossing& c) const {
    if (c.first.polygon == c.second.polygon)
      fail_input("contour crosses itself" + c.near, where(c.first), "mend the contour");
    fail_input("contour " + std::to_string(c.second.polygon + 1) + " overlaps contour " +
                   std::to_string(c.first.polygon + 1) + c.near,
               where(c.first), "contours of one label must not cross");
  }

  /// Each group of a label's contours that cross becomes its union.
  void unite(std::size_t f, const std::vector<Crossing>& crossings) {
    const auto& polygons = level_.of_file[f]->polygons;
    std::vector<std::size_t> group(polygons.size());
    std::iota(group.begin(), group.end(), 0);
    const auto root = [&](std::size_t p) {
      while (group[p] != p) p = group[p];
      return p;
    };
    for (const Crossing& c : crossings)
      if (c.first.file == f)
        group[std::max(root(c.first.polygon), root(c.second.polygon))] =
            std::min(root(c.first.polygon), root(c.second.polygon));
    std::map<std::size_t, Crossing> crossing_of;
    for (const Crossing& c : crossings)
      if (c.first.file == f) crossing_of.emplace(root(c.first.polygon), c);
    for (const auto& [first, crossing] : crossing_of) {
      std::vector<std::vector<GridPoint>> contours;
      std::set<std::size_t> members;
      for (std::size_t p = 0; p < polygons.size(); ++p)
        if (root(p) == first) {
          members.insert(p);
          contours.emplace_back();
          for (const auto& point : polygons[p].points) contours.back().push_back(grid_.nearest(point));
        }
      const UnitedContours united = unite_contours(contours);
      if (united.disputed > kSafeUnion_rel * united.area) refuse(crossing);
      replace(f, first, members, united);
    }
  }

  /// The segments of the contours `members` of file f by those of their union.
  void replace(std::size_t f, std::size_t first, const std::set<std::size_t>& members, const UnitedContours& united) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < segments_.size(); ++i)
      if (sources_[i].file != f || members.count(sources_[i].polygon) == 0) {
        segments_[kept] = segments_[i];
        sources_[kept++] = sources_[i];
      }
    segments_.resize(kept);
    sources_.resize(kept);
    for (const auto& loop : united.loops)
      for (std::size_t i = 0; i < loop.size(); ++i) {
        segments_.push_back({loop[i], loop[(i + 1) % loop.size()]});
        sources_.push_back({f, first, 0});
      }
  }

  const std::vector<LabelContours>& files_;
  const DrawnLevel& level_;
  const DrawnGrid& grid_;
  std::vector<GridSegment>& segments_;
  std::vector<SourceSegment>& sources_;
};

}  // namespace

std::set<std::size_t> mend_crossings(const std::vector<LabelContours>& files, const DrawnLevel& level,
                                     const DrawnGrid& grid, bool repair, std::vector<GridSegment>& segments,
                                     std::vector<SourceSegment>& sources) {
  return CrossingMender(files, level, grid, segments, sources).run(repair);
}

}  // namespace stackmesh
