#include "sections/polygons.h"

#include <algorithm>
#include <bitset>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <numeric>
#include <set>

#include "base/error.h"
#include "base/warning.h"
#include "planar/planar.h"
#include "planar/snap_rounding.h"
#include "sections/contour_copies.h"
#include "sections/contour_crossings.h"
#include "sections/drawn_detail.h"
#include "sections/drawn_ends.h"
#include "sections/missing_contours.h"
#include "sections/openings.h"

namespace stackmesh {
namespace {

constexpr std::size_t kMaxLabels = 256;
constexpr double kSafeUnion_rel = 0.05;  // of the union may be drawn over twice
constexpr double kInside_rel = 0.999;    // of a label in another one is all of it
constexpr double kCovered_rel = 0.95;    // of a label under another one leaves too little of it

constexpr double kMostlyOpen_rel = 0.25;  // of a label's outline outside another one: it does not lie inside

using Mask = std::bitset<kMaxLabels>;  // a bit per label: inside or not

std::string text_of(double value, const char* form = "%g") {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, form, value);
  return buffer;
}

/// "-3.5, 0, 3.5 and 4 more"
std::string list_heights(const std::vector<double>& z_mm) {
  std::string text;
  for (std::size_t i = 0; i < z_mm.size() && i < 8; ++i) text += (i > 0 ? ", " : "") + text_of(z_mm[i], "%.6g");
  return z_mm.size() > 8 ? text + " and " + std::to_string(z_mm.size() - 8) + " more" : text;
}

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
  SectionMaker(const std::vector<LabelContours>& files, std::vector<Warning>& warnings,
               const ContourStackOptions& options)
      : files_(files), warnings_(warnings), options_(options) {}

  Stack run() {
    if (files_.size() > kMaxLabels)
      fail_input("more than " + std::to_string(kMaxLabels) + " labels drawn as contours", files_[kMaxLabels].path,
                 "mesh fewer labels at once");
    for (LabelContours& f : files_) join_sections(f, options_.same_height_mm);
    align_heights(files_, options_.same_height_mm);
    drop_copies();
    const std::vector<DrawnEnds> ends = extend_ends(files_, options_);
    find_levels();
    if (options_.fill_missing) fill_missing();
    sort_into_levels();
    measure();
    std::vector<MaskedSection> masked;
    for (std::size_t i = 0; i < levels_.size(); ++i) masked.push_back(make_section(levels_[i], thickness(i)));
    if (!options_.merge || !options_.not_merged.empty()) warn_open_walls(masked);
    rank_labels();
    Stack stack;
    stack.slices = options_.slices;
    stack.grid_x_mm = stack.grid_y_mm = grid_;
    stack.drawn_ends = ends;
    stack.frame = options_.frame;
    stack.frame.origin = options_.frame.to_world({x0_, y0_, 0});
    stack.labels.push_back({0, ""});
    std::set<Label> seen = {0};
    for (const LabelContours& f : files_) {
      if (!seen.insert(f.label).second)
        fail_input("two contour files for label " + std::to_string(f.label), f.path, "give each label one file");
      stack.labels.push_back({f.label, f.name, f.colour});
    }
    std::sort(stack.labels.begin(), stack.labels.end(),
              [](const LabelInfo& a, const LabelInfo& b) { return a.number < b.number; });
    for (MaskedSection& m : masked) stack.sections.push_back(give_labels(std::move(m)));
    stack.pixel_mm = drawn_pixel_mm(stack, median_edge_);
    for (const auto& [f, heights] : repaired_)
      warnings_.push_back(warning_at(WarningCode::contours_mended, files_[f].path,
                                     name_of(f) + " has contours that cross themselves or each other at z = " +
                                         list_heights(heights) + " mm; what they go round is united"));
    if (options_.report_overlaps) warn_overlaps();
    if (options_.merge) merge_labels(stack);
    return stack;
  }

 private:
  /// Contours that repeat another one of their section count once.
  void drop_copies() {
    for (LabelContours& f : files_) {
      std::vector<double> where;
      std::size_t copies = 0;
      for (ContourSection& s : f.sections)
        if (const std::size_t n = remove_copies(s.polygons); n > 0) {
          copies += n;
          where.push_back(s.z_mm);
        }
      if (copies > 0)
        warnings_.push_back(warning_at(WarningCode::repeated, f.path,
                                       (f.name.empty() ? "label " + std::to_string(f.label) : "'" + f.name + "'") +
                                           " repeats " + std::to_string(copies) +
                                           " of its contours, or nearly so, at z = " + list_heights(where) +
                                           " mm; each counts once"));
    }
  }

  /// A section whose sides know all labels that cover them.
  struct MaskedSection {
    struct Edge {
      std::int32_t a, b;
      Mask left, right;
    };
    Section section;
    std::vector<Edge> edges;
  };

  /// The heights of all labels.
  void find_levels() {
    std::vector<double> heights;
    for (const LabelContours& f : files_)
      for (const ContourSection& s : f.sections) heights.push_back(s.z_mm);
    std::sort(heights.begin(), heights.end());
    heights.erase(std::unique(heights.begin(), heights.end()), heights.end());
    for (double z : heights) levels_.push_back({z, {}, {}});
  }

  static bool is_at(const ContourSection& s, const Level& level) { return s.z_mm == level.z_mm; }

  void sort_into_levels() {
    std::size_t filled = 0;
    for (Level& level : levels_) {
      level.of_file.assign(files_.size(), nullptr);
      level.index_in_file.assign(files_.size(), 0);
      bool any = false;
      for (std::size_t f = 0; f < files_.size(); ++f)
        for (std::size_t i = 0; i < files_[f].sections.size(); ++i) {
          const ContourSection& s = files_[f].sections[i];
          if (!is_at(s, level)) continue;
          level.of_file[f] = &s;
          level.index_in_file[f] = i;
          any = any || !s.polygons.empty();
        }
      filled += any ? 1 : 0;
    }
    if (levels_.empty())
      fail_input("the file holds no contour", files_.empty() ? "" : files_[0].path, "check the file");
    if (filled < 2)
      fail_input("only " + std::to_string(filled) + " section with contours", files_[0].path,
                 "give at least two sections");
    if (!options_.fill_missing) warn_missing();
  }

  void measure() {
    double x1 = -std::numeric_limits<double>::infinity(), y1 = x1;
    x0_ = y0_ = std::numeric_limits<double>::infinity();
    std::vector<double> edges;
    for (const LabelContours& f : files_)
      for (const ContourSection& s : f.sections)
        for (const ContourPolygon& p : s.polygons)
          for (std::size_t i = 0; i < p.points.size(); ++i) {
            const auto &a = p.points[i], &b = p.points[(i + 1) % p.points.size()];
            x0_ = std::min(x0_, a[0]);
            y0_ = std::min(y0_, a[1]);
            x1 = std::max(x1, a[0]);
            y1 = std::max(y1, a[1]);
            edges.push_back(std::hypot(b[0] - a[0], b[1] - a[1]));
          }
    if (edges.empty()) fail_input("the file holds no contour", files_[0].path, "check the file");
    std::nth_element(edges.begin(), edges.begin() + edges.size() / 2, edges.end());
    median_edge_ = edges[edges.size() / 2];
    const double box = std::max(x1 - x0_, y1 - y0_);
    grid_ = std::exp2(std::floor(std::log2(1e-5 * box)));
  }

  /// Half the way to either neighbour.
  double thickness(std::size_t i) const {
    const std::size_t low = i > 0 ? i - 1 : i, high = std::min(i + 1, levels_.size() - 1);
    return (levels_[high].z_mm - levels_[low].z_mm) / (high - low > 1 ? 2 : 1);
  }

  std::string name_of(std::size_t f) const {
    return files_[f].name.empty() ? "label " + std::to_string(files_[f].label) : "'" + files_[f].name + "'";
  }

  void warn_missing() {
    for (std::size_t f = 0; f < files_.size(); ++f) {
      if (files_[f].sections.empty()) continue;
      const double low = files_[f].sections.front().z_mm, high = files_[f].sections.back().z_mm;
      std::size_t missing = 0;
      double first = 0;
      for (const Level& level : levels_)
        if (level.z_mm > low && level.z_mm < high && level.of_file[f] == nullptr && missing++ == 0) first = level.z_mm;
      if (missing > 0)
        warnings_.push_back({WarningCode::missing_contours, files_[f].path,
                             files_[f].path + " has no contour at " + std::to_string(missing) +
                                 " height(s) that other labels have (first: z = " + std::to_string(first) +
                                 " mm); it is empty there"});
    }
  }

  /// Gives every label contours at the heights between its first and last section that only others have.
  void fill_missing() {
    for (std::size_t f = 0; f < files_.size(); ++f) {
      const std::vector<ContourSection> own = files_[f].sections;
      std::vector<ContourSection> all;
      std::vector<double> made;
      std::size_t next = 0;  // of own
      for (const Level& level : levels_) {
        if (next < own.size() && is_at(own[next], level)) {
          while (next < own.size() && is_at(own[next], level)) all.push_back(own[next++]);
        } else if (next > 0 && next < own.size()) {
          all.push_back(contours_between(own[next - 1], own[next], level.z_mm));
          made.push_back(level.z_mm);
        }
      }
      files_[f].sections = std::move(all);
      if (!made.empty())
        warnings_.push_back(warning_at(WarningCode::missing_contours, files_[f].path,
                                       name_of(f) + " has no contour at z = " + list_heights(made) +
                                           " mm, where other labels have some; its contours there are interpolated"));
      warn_gaps(f);
    }
  }

  /// Heights that nobody has: told by a label's own gaps, where one is a multiple of its usual gap.
  void warn_gaps(std::size_t f) {
    std::vector<ContourSection> s;
    for (const ContourSection& own : files_[f].sections)
      if (!own.interpolated) s.push_back(own);
    if (s.size() < 4) return;
    std::vector<double> gaps;
    for (std::size_t i = 1; i < s.size(); ++i) gaps.push_back(s[i].z_mm - s[i - 1].z_mm);
    std::vector<double> sorted = gaps;
    std::nth_element(sorted.begin(), sorted.begin() + sorted.size() / 2, sorted.end());
    const double usual = sorted[sorted.size() / 2];
    std::vector<double> lost;
    for (std::size_t i = 0; i < gaps.size(); ++i) {
      const double missing = std::round(gaps[i] / usual) - 1;
      for (int k = 1; gaps[i] > 1.5 * usual && k <= missing && k <= 1000; ++k)
        lost.push_back(s[i].z_mm + k * gaps[i] / (missing + 1));
    }
    if (!lost.empty())
      warnings_.push_back(warning_at(WarningCode::missing_contours, files_[f].path,
                                     name_of(f) + " has no contour at about z = " + list_heights(lost) +
                                         " mm, where its usual gap of " + text_of(usual, "%.3g") +
                                         " mm asks for some; it is interpolated there"));
  }

  /// The labels that are merged become the smallest of them; what lay between two of them goes.
  void merge_labels(Stack& stack) const {
    const auto merges = [&](Label l) { return l != 0 && options_.not_merged.count(l) == 0; };
    const auto first =
        std::find_if(stack.labels.begin(), stack.labels.end(), [&](const LabelInfo& l) { return merges(l.number); });
    if (first == stack.labels.end()) return;
    const Label kept = first->number;
    stack.labels.erase(std::remove_if(stack.labels.begin(), stack.labels.end(),
                                      [&](const LabelInfo& l) { return merges(l.number) && l.number != kept; }),
                       stack.labels.end());
    for (Section& s : stack.sections) {
      for (SectionEdge& e : s.edges)
        for (Label* side : {&e.left, &e.right})
          if (merges(*side)) *side = kept;
      s.edges.erase(
          std::remove_if(s.edges.begin(), s.edges.end(), [](const SectionEdge& e) { return e.left == e.right; }),
          s.edges.end());
    }
  }

  /// Inner labels win over outer ones: the smaller the area, the higher the rank; or the order given, but a label that
  /// would all but vanish under an earlier, larger one goes before it.
  void rank_labels() {
    if (options_.first_wins) {
      for (std::size_t f = 0; f < files_.size(); ++f) {
        const auto covers = [&](std::size_t g) {
          return volume_[g] > volume_[f] && overlap_[std::minmax(f, g)] >= kCovered_rel * volume_[f];
        };
        by_rank_.insert(std::find_if(by_rank_.begin(), by_rank_.end(), covers), f);
      }
      return;
    }
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

  Label winner(const Mask& mask) const {
    if (mask.none()) return 0;
    for (std::size_t f : by_rank_)
      if (mask[f]) return files_[f].label;
    return 0;
  }

  /// Adds what a region of an area (grid units squared) holds of each label, and of every two at once.
  void count_overlaps(const Mask& mask, double area, double thickness_mm) {
    const double volume = area * grid_ * grid_ * thickness_mm;
    for (std::size_t f = 0; f < files_.size(); ++f) {
      if (!mask[f]) continue;
      volume_[f] += volume;
      for (std::size_t g = f + 1; g < files_.size(); ++g)
        if (mask[g]) overlap_[{f, g}] += volume;
    }
  }

  /// A label that lies inside another one in most sections, but reaches its outline in some: the other one is open
  /// there.
  void warn_open_walls(const std::vector<MaskedSection>& masked) {
    struct Pair {
      std::size_t inside = 0;  // sections
      std::vector<double> open_z_mm;
      double area_mm2 = 0;
      std::string openings;  // one by one
    };
    std::map<std::pair<std::size_t, std::size_t>, Pair> pairs;
    for (std::size_t i = 0; i < masked.size(); ++i) {
      const MaskedSection& m = masked[i];
      if (m.section.interpolated) continue;
      std::map<std::pair<std::size_t, std::size_t>, double> exposed;  // of the first label, not within the second, mm
      for (std::size_t f = 0; f < files_.size(); ++f)
        for (std::size_t g = 0; g < files_.size(); ++g) {
          if (f == g) continue;
          double bare = 0, all = 0;
          std::vector<OpenEdge> open;
          for (const MaskedSection::Edge& e : m.edges) {
            if (e.left[f] == e.right[f]) continue;
            const GridPoint a = m.section.points[e.a], b = m.section.points[e.b];
            const double length = std::hypot(static_cast<double>(b.x) - a.x, static_cast<double>(b.y) - a.y) * grid_;
            all += length;
            if (!(e.left[f] ? e.right[g] : e.left[g]))
              bare += length,
                  open.push_back(
                      {e.a, e.b, {x0_ + grid_ * a.x, y0_ + grid_ * a.y}, {x0_ + grid_ * b.x, y0_ + grid_ * b.y}});
          }
          if (all == 0 || bare > kMostlyOpen_rel * all) continue;
          Pair& p = pairs[{f, g}];
          if (bare == 0) {
            ++p.inside;
          } else {
            p.open_z_mm.push_back(m.section.z_mm);
            p.area_mm2 += bare * thickness(i);
            p.openings += list_openings(open, m.section.z_mm, thickness(i)) + ";";
          }
        }
    }
    for (const auto& [pair, p] : pairs)
      if (!p.open_z_mm.empty() && p.inside >= p.open_z_mm.size())
        warnings_.push_back(warning_at(
            WarningCode::open_wall, files_[pair.first].path,
            name_of(pair.first) + " lies inside " + name_of(pair.second) + ", but reaches its outline at z = " +
                list_heights(p.open_z_mm) + " mm: the wall between them is open there, over about " +
                text_of(p.area_mm2, "%.3g") + " mm2:" + p.openings.substr(0, p.openings.size() - 1)));
  }

  /// Who lies inside whom, and who shares how much with whom.
  void warn_overlaps() {
    std::map<std::size_t, std::string> inside;  // outer -> names of what lies in it
    for (const auto& [pair, volume] : overlap_) {
      const auto place = [&](std::size_t f) { return std::find(by_rank_.begin(), by_rank_.end(), f); };
      const bool in_order = place(pair.first) < place(pair.second);
      const std::size_t first = in_order ? pair.first : pair.second, loser = in_order ? pair.second : pair.first;
      if (!(volume > 1e-4 * std::min(volume_[first], volume_[loser]))) continue;  // rounding, a line shared
      const std::string how_much = text_of(volume, "%.4g") + " mm3";
      if (volume >= kInside_rel * volume_[loser])
        warnings_.push_back(warning_at(WarningCode::overlap, files_[loser].path,
                                       name_of(loser) + " lies wholly under " + name_of(first) +
                                           ", which has priority: nothing of its " + how_much + " is left"));
      else if (volume >= kInside_rel * volume_[first])
        inside[loser] += (inside[loser].empty() ? "" : ", ") + name_of(first) + " (" + how_much + ")";
      else
        warnings_.push_back(warning_at(WarningCode::overlap, files_[loser].path,
                                       name_of(first) + " and " + name_of(loser) + " overlap in " + how_much + " (" +
                                           text_of(100 * volume / volume_[first], "%.2g") + " and " +
                                           text_of(100 * volume / volume_[loser], "%.2g") +
                                           " % of them), which went to " + name_of(first)));
    }
    for (const auto& [outer, names] : inside)
      warnings_.push_back(warning_at(WarningCode::taken_out, files_[outer].path,
                                     "inside " + name_of(outer) + ", and taken out of it: " + names));
  }

  GridPoint to_grid(const std::array<double, 2>& p) const {
    return {static_cast<std::int32_t>(std::lround((p[0] - x0_) / grid_)),
            static_cast<std::int32_t>(std::lround((p[1] - y0_) / grid_))};
  }

  std::string where(const Level& level, const SourceSegment& s) const {
    const std::string name = files_[s.file].name.empty() ? "" : ", '" + files_[s.file].name + "'";
    return files_[s.file].path + name + ", section " + std::to_string(level.index_in_file[s.file] + 1) +
           " at z = " + std::to_string(level.z_mm) + " mm, contour " + std::to_string(s.polygon + 1);
  }

  struct Crossing {
    SourceSegment first, second;
    std::string near;
  };

  /// Where contours of one label cross; decided on the given coordinates, exactly.
  std::vector<Crossing> find_crossings(const Level& level, const std::vector<GridSegment>& segments,
                                       const std::vector<SourceSegment>& sources) const {
    std::vector<Crossing> found;
    const EdgeGrid grid(segments);
    for (std::size_t i = 0; i < segments.size(); ++i)
      grid.near_segment(segments[i], [&](std::int32_t k) {
        if (static_cast<std::size_t>(k) >= i || sources[k].file != sources[i].file ||
            !properly_cross(segments[i], segments[k]))
          return;
        const auto [a, b] = ends(level, sources[i]);
        const auto [c, d] = ends(level, sources[k]);
        if (CGAL::orientation(a, b, c) * CGAL::orientation(a, b, d) >= 0 ||
            CGAL::orientation(c, d, a) * CGAL::orientation(c, d, b) >= 0)
          return;  // only rounding makes them cross; snap rounding sees to that
        found.push_back(
            {sources[i], sources[k],
             " near (" + std::to_string(CGAL::to_double(a.x())) + ", " + std::to_string(CGAL::to_double(a.y())) + ")"});
      });
    return found;
  }

  [[noreturn]] void refuse_crossing(const Level& level, const Crossing& c) const {
    if (c.first.polygon == c.second.polygon)
      fail_input("contour crosses itself" + c.near, where(level, c.first), "mend the contour");
    fail_input("contour " + std::to_string(c.second.polygon + 1) + " overlaps contour " +
                   std::to_string(c.first.polygon + 1) + c.near,
               where(level, c.first), "contours of one label must not cross");
  }

  /// Contours of a label that cross are replaced by their union, if little of it is drawn over twice.
  void unite_crossings(const Level& level, const std::vector<Crossing>& crossings, std::vector<GridSegment>& segments,
                       std::vector<SourceSegment>& sources) {
    std::set<std::size_t> files;
    for (const Crossing& c : crossings) files.insert(c.first.file);
    for (std::size_t f : files) {
      const auto& polygons = level.of_file[f]->polygons;
      std::vector<std::size_t> group(polygons.size());
      std::iota(group.begin(), group.end(), 0);
      const auto root = [&](std::size_t p) {
        while (group[p] != p) p = group[p];
        return p;
      };
      std::map<std::size_t, Crossing> crossing_of;
      for (const Crossing& c : crossings)
        if (c.first.file == f)
          group[std::max(root(c.first.polygon), root(c.second.polygon))] =
              std::min(root(c.first.polygon), root(c.second.polygon));
      for (const Crossing& c : crossings)
        if (c.first.file == f) crossing_of.emplace(root(c.first.polygon), c);
      for (const auto& [first, crossing] : crossing_of) {
        std::vector<std::vector<GridPoint>> contours;
        std::set<std::size_t> members;
        for (std::size_t p = 0; p < polygons.size(); ++p)
          if (root(p) == first) {
            members.insert(p);
            contours.emplace_back();
            for (const auto& point : polygons[p].points) contours.back().push_back(to_grid(point));
          }
        const UnitedContours united = unite_contours(contours);
        if (united.disputed > kSafeUnion_rel * united.area) refuse_crossing(level, crossing);
        std::size_t kept = 0;
        for (std::size_t i = 0; i < segments.size(); ++i)
          if (sources[i].file != f || members.count(sources[i].polygon) == 0) {
            segments[kept] = segments[i];
            sources[kept++] = sources[i];
          }
        segments.resize(kept);
        sources.resize(kept);
        for (const auto& loop : united.loops)
          for (std::size_t i = 0; i < loop.size(); ++i) {
            segments.push_back({loop[i], loop[(i + 1) % loop.size()]});
            sources.push_back({f, first, 0});
          }
        auto& repaired = repaired_[f];
        if (repaired.empty() || repaired.back() != level.z_mm) repaired.push_back(level.z_mm);
      }
    }
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

  Section give_labels(MaskedSection m) const {
    for (const MaskedSection::Edge& e : m.edges) {
      const Label l = winner(e.left), r = winner(e.right);
      if (l != r) m.section.edges.push_back({e.a, e.b, l, r});
    }
    return std::move(m.section);
  }

  /// Noded edges with the labels that change over them; what is walked twice cancels.
  static std::vector<MaskedEdge> merge(const NodedSegments& noded, const std::vector<SourceSegment>& sources) {
    std::vector<MaskedEdge> edges;
    for (const NodedEdge& e : noded.edges)
      edges.push_back({std::min(e.a, e.b), std::max(e.a, e.b), Mask(1) << sources[e.source].file});
    std::sort(edges.begin(), edges.end(),
              [](const MaskedEdge& u, const MaskedEdge& v) { return u.a != v.a ? u.a < v.a : u.b < v.b; });
    std::size_t kept = 0;
    for (std::size_t i = 0, j; i < edges.size(); i = j) {
      MaskedEdge sum = edges[i];
      for (j = i + 1; j < edges.size() && edges[j].a == sum.a && edges[j].b == sum.b; ++j) sum.mask ^= edges[j].mask;
      if (sum.mask.any()) edges[kept++] = sum;
    }
    edges.resize(kept);
    return edges;
  }

  MaskedSection make_section(const Level& level, double thickness_mm) {
    std::vector<GridSegment> segments;
    std::vector<SourceSegment> sources;
    for (std::size_t f = 0; f < files_.size(); ++f) {
      if (level.of_file[f] == nullptr) continue;
      const auto& polygons = level.of_file[f]->polygons;
      for (std::size_t p = 0; p < polygons.size(); ++p)
        for (std::size_t i = 0; i < polygons[p].points.size(); ++i) {
          const GridPoint a = to_grid(polygons[p].points[i]),
                          b = to_grid(polygons[p].points[(i + 1) % polygons[p].points.size()]);
          if (a == b) continue;
          segments.push_back({a, b});
          sources.push_back({f, p, i});
        }
    }
    const std::vector<Crossing> crossings = find_crossings(level, segments, sources);
    if (!crossings.empty() && !options_.repair) refuse_crossing(level, crossings[0]);
    if (!crossings.empty()) unite_crossings(level, crossings, segments, sources);
    NodedSegments noded = std::move(node_segments({segments}, 1)[0]);
    const std::vector<MaskedEdge> edges = merge(noded, sources);
    MaskedSection result;
    result.section.z_mm = level.z_mm;
    result.section.interpolated = is_interpolated(level);
    if (edges.empty()) return result;

    Cdt cdt;
    std::vector<VertexHandle> handles;
    for (const GridPoint p : noded.points) handles.push_back(cdt.insert(PlanarPoint(p.x, p.y)));
    for (const MaskedEdge& e : edges) cdt.insert_constraint(handles[e.a], handles[e.b]);
    const std::vector<Mask> region_mask = grow_regions(cdt, handles, edges);
    for (const FaceHandle f : cdt.finite_face_handles())
      count_overlaps(region_mask[f->info().sheet], std::abs(cdt.triangle(f).area()), thickness_mm);
    result.section.points = std::move(noded.points);
    for (const MaskedEdge& e : edges) {
      const auto [left, right] = sides(cdt, handles[e.a], handles[e.b]);
      result.edges.push_back({e.a, e.b, region_mask[left->info().sheet], region_mask[right->info().sheet]});
    }
    return result;
  }

  static bool is_interpolated(const Level& level) {
    bool any = false;
    for (const ContourSection* s : level.of_file) {
      if (s != nullptr && !s->interpolated) return false;
      any = any || s != nullptr;
    }
    return any;
  }

  static std::pair<FaceHandle, FaceHandle> sides(const Cdt& cdt, VertexHandle a, VertexHandle b) {
    FaceHandle face;
    int i = 0;
    if (!cdt.is_edge(a, b, face, i))
      fail_internal("a contour edge is missing in the triangulation", "orienting contours");
    const FaceHandle other = face->neighbor(i);
    return face->vertex(Cdt::ccw(i)) == a ? std::make_pair(face, other) : std::make_pair(other, face);
  }

  /// Regions grown without crossing a contour (paper 3.1.2), then which labels cover each, from the outside in.
  static std::vector<Mask> grow_regions(Cdt& cdt, const std::vector<VertexHandle>& handles,
                                        const std::vector<MaskedEdge>& edges) {
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
    std::vector<Mask> mask(regions);
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

  std::vector<LabelContours> files_;
  std::vector<Warning>& warnings_;
  const ContourStackOptions options_;
  std::map<std::size_t, std::vector<double>> repaired_;            // heights where contours crossed
  std::map<std::size_t, double> volume_;                           // mm3 of each label's contours
  std::map<std::pair<std::size_t, std::size_t>, double> overlap_;  // (a, b), a < b -> mm3
  std::vector<Level> levels_;
  std::vector<std::size_t> by_rank_;
  double x0_ = 0, y0_ = 0, grid_ = 1, median_edge_ = 1;
};

}  // namespace

Stack sections_from_contours(const std::vector<LabelContours>& files, std::vector<Warning>& warnings,
                             const ContourStackOptions& options) {
  return SectionMaker(files, warnings, options).run();
}

}  // namespace stackmesh
