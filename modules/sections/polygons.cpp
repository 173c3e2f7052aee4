#include "sections/polygons.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "base/error.h"
#include "base/warning.h"
#include "sections/contour_copies.h"
#include "sections/contour_names.h"
#include "sections/drawn_detail.h"
#include "sections/drawn_ends.h"
#include "sections/drawn_warnings.h"
#include "sections/masked_section.h"
#include "sections/mend_crossings.h"
#include "sections/missing_contours.h"

namespace stackmesh {
namespace {

constexpr double kCovered_rel = 0.95;  // of a label under another one leaves too little of it

class SectionMaker {
 public:
  SectionMaker(const std::vector<LabelContours>& files, std::vector<Warning>& warnings,
               const ContourStackOptions& options)
      : files_(files), warnings_(warnings), options_(options) {
    overlaps_.volume_mm3.assign(files.size(), 0);
  }

  Stack run() {
    if (files_.size() > kMostDrawnLabels)
      fail_input("more than " + std::to_string(kMostDrawnLabels) + " labels drawn as contours",
                 files_[kMostDrawnLabels].path, "mesh fewer labels at once");
    for (LabelContours& f : files_) join_sections(f, options_.same_height_mm);
    align_heights(files_, options_.same_height_mm);
    drop_copies();
    const std::vector<DrawnEnds> ends = extend_ends(files_, options_);
    find_levels();
    if (options_.fill_missing) fill_missing();
    sort_into_levels();
    measure();
    std::vector<MaskedSection> masked;
    std::vector<double> thickness_mm;
    for (std::size_t i = 0; i < levels_.size(); ++i) {
      thickness_mm.push_back(thickness(i));
      masked.push_back(make_section(levels_[i], thickness_mm[i]));
    }
    if (!options_.merge || !options_.not_merged.empty())
      warn_open_walls(files_, masked, thickness_mm, grid_, warnings_);
    rank_labels();
    Stack stack;
    stack.slices = options_.slices;
    stack.grid_x_mm = stack.grid_y_mm = grid_.unit_mm;
    stack.drawn_ends = ends;
    stack.frame = options_.frame;
    stack.frame.origin = options_.frame.to_world({grid_.x0_mm, grid_.y0_mm, 0});
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
                                     name_of(files_[f]) + " has contours that cross themselves or each other at z = " +
                                         list_heights(heights) + " mm; what they go round is united"));
    if (options_.report_overlaps) warn_overlaps(files_, overlaps_, by_rank_, warnings_);
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
                                       name_of(f) + " repeats " + std::to_string(copies) +
                                           " of its contours, or nearly so, at z = " + list_heights(where) +
                                           " mm; each counts once"));
    }
  }

  /// The heights of all labels.
  void find_levels() {
    std::vector<double> heights;
    for (const LabelContours& f : files_)
      for (const ContourSection& s : f.sections) heights.push_back(s.z_mm);
    std::sort(heights.begin(), heights.end());
    heights.erase(std::unique(heights.begin(), heights.end()), heights.end());
    for (double z : heights) levels_.push_back({z, {}, {}});
  }

  static bool is_at(const ContourSection& s, const DrawnLevel& level) { return s.z_mm == level.z_mm; }

  void sort_into_levels() {
    std::size_t filled = 0;
    for (DrawnLevel& level : levels_) {
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
    if (!options_.fill_missing) warn_missing_heights(files_, levels_, warnings_);
  }

  void measure() {
    double x1 = -std::numeric_limits<double>::infinity(), y1 = x1, x0 = -x1, y0 = -x1;
    std::vector<double> edges;
    for (const LabelContours& f : files_)
      for (const ContourSection& s : f.sections)
        for (const ContourPolygon& p : s.polygons)
          for (std::size_t i = 0; i < p.points.size(); ++i) {
            const auto &a = p.points[i], &b = p.points[(i + 1) % p.points.size()];
            x0 = std::min(x0, a[0]);
            y0 = std::min(y0, a[1]);
            x1 = std::max(x1, a[0]);
            y1 = std::max(y1, a[1]);
            edges.push_back(std::hypot(b[0] - a[0], b[1] - a[1]));
          }
    if (edges.empty()) fail_input("the file holds no contour", files_[0].path, "check the file");
    std::nth_element(edges.begin(), edges.begin() + edges.size() / 2, edges.end());
    median_edge_ = edges[edges.size() / 2];
    grid_ = {x0, y0, std::exp2(std::floor(std::log2(1e-5 * std::max(x1 - x0, y1 - y0))))};
  }

  /// Half the way to either neighbour.
  double thickness(std::size_t i) const {
    const std::size_t low = i > 0 ? i - 1 : i, high = std::min(i + 1, levels_.size() - 1);
    return (levels_[high].z_mm - levels_[low].z_mm) / (high - low > 1 ? 2 : 1);
  }

  /// Gives every label contours at the heights between its first and last section that only others have.
  void fill_missing() {
    for (std::size_t f = 0; f < files_.size(); ++f) {
      const std::vector<ContourSection> own = files_[f].sections;
      std::vector<ContourSection> all;
      std::vector<double> made;
      std::size_t next = 0;  // of own
      for (const DrawnLevel& level : levels_) {
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
                                       name_of(files_[f]) + " has no contour at z = " + list_heights(made) +
                                           " mm, where other labels have some; its contours there are interpolated"));
      warn_wide_gaps(files_[f], warnings_);
    }
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
      const std::vector<double>& own = overlaps_.volume_mm3;
      for (std::size_t f = 0; f < files_.size(); ++f) {
        const auto covers = [&](std::size_t g) {
          const auto shared = overlaps_.shared_mm3.find(std::minmax(f, g));
          return own[g] > own[f] &&
                 (shared == overlaps_.shared_mm3.end() ? 0 : shared->second) >= kCovered_rel * own[f];
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
            a += (u[0] - grid_.x0_mm) * (v[1] - grid_.y0_mm) - (v[0] - grid_.x0_mm) * (u[1] - grid_.y0_mm);
          }
          area[f] += std::abs(a);
        }
    for (std::size_t f = 0; f < files_.size(); ++f) by_rank_.push_back(f);
    std::stable_sort(by_rank_.begin(), by_rank_.end(), [&](std::size_t a, std::size_t b) { return area[a] < area[b]; });
  }

  Label winner(const LabelMask& mask) const {
    if (mask.none()) return 0;
    for (std::size_t f : by_rank_)
      if (mask[f]) return files_[f].label;
    return 0;
  }

  /// Adds what a region of an area (grid units squared) holds of each label, and of every two at once.
  void count_overlaps(const LabelMask& mask, double area, double thickness_mm) {
    const double volume = area * grid_.unit_mm * grid_.unit_mm * thickness_mm;
    for (std::size_t f = 0; f < files_.size(); ++f) {
      if (!mask[f]) continue;
      overlaps_.volume_mm3[f] += volume;
      for (std::size_t g = f + 1; g < files_.size(); ++g)
        if (mask[g]) overlaps_.shared_mm3[{f, g}] += volume;
    }
  }

  Section give_labels(MaskedSection m) const {
    for (const MaskedSection::Edge& e : m.edges) {
      const Label l = winner(e.left), r = winner(e.right);
      if (l != r) m.section.edges.push_back({e.a, e.b, l, r});
    }
    return std::move(m.section);
  }

  MaskedSection make_section(const DrawnLevel& level, double thickness_mm) {
    std::vector<GridSegment> segments;
    std::vector<SourceSegment> sources;
    for (std::size_t f = 0; f < files_.size(); ++f) {
      if (level.of_file[f] == nullptr) continue;
      const auto& polygons = level.of_file[f]->polygons;
      for (std::size_t p = 0; p < polygons.size(); ++p)
        for (std::size_t i = 0; i < polygons[p].points.size(); ++i) {
          const GridPoint a = grid_.nearest(polygons[p].points[i]),
                          b = grid_.nearest(polygons[p].points[(i + 1) % polygons[p].points.size()]);
          if (a == b) continue;
          segments.push_back({a, b});
          sources.push_back({f, p, i});
        }
    }
    for (const std::size_t f : mend_crossings(files_, level, grid_, options_.repair, segments, sources))
      repaired_[f].push_back(level.z_mm);
    MaskedSection result;
    result.section.z_mm = level.z_mm;
    result.section.interpolated = is_interpolated(level);
    mask_regions(std::move(segments), sources, result,
                 [&](const LabelMask& mask, double area) { count_overlaps(mask, area, thickness_mm); });
    return result;
  }

  static bool is_interpolated(const DrawnLevel& level) {
    bool any = false;
    for (const ContourSection* s : level.of_file) {
      if (s != nullptr && !s->interpolated) return false;
      any = any || s != nullptr;
    }
    return any;
  }

  std::vector<LabelContours> files_;
  std::vector<Warning>& warnings_;
  const ContourStackOptions options_;
  std::map<std::size_t, std::vector<double>> repaired_;  // heights where contours crossed
  DrawnOverlaps overlaps_;
  std::vector<DrawnLevel> levels_;
  std::vector<std::size_t> by_rank_;
  DrawnGrid grid_;
  double median_edge_ = 1;  // mm
};

}  // namespace

Stack sections_from_contours(const std::vector<LabelContours>& files, std::vector<Warning>& warnings,
                             const ContourStackOptions& options) {
  return SectionMaker(files, warnings, options).run();
}

}  // namespace stackmesh
