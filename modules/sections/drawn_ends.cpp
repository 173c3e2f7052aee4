#include "sections/drawn_ends.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>

#include "sections/missing_contours.h"
#include "sections/point_in_polygon.h"

namespace stackmesh {
namespace {

constexpr double kJitter_rel = 0.03;     // of the smallest gap: heights of different labels that are one
constexpr double kOwnJitter_rel = 0.01;  // of a label's gap
constexpr double kSameEnd_rel = 0.02;    // of half a gap: ends so near a section lie on it
constexpr double kLongGap_rel = 1.5;     // of its usual gap: a longer last gap is one with sections missing

using Point = std::array<double, 2>;

double usual_gap(const LabelContours& f) {
  std::vector<double> gaps;
  const ContourSection* last = nullptr;
  for (const ContourSection& s : f.sections) {
    if (s.polygons.empty()) continue;
    if (last != nullptr) gaps.push_back(s.z_mm - last->z_mm);
    last = &s;
  }
  if (gaps.empty()) return 0;
  std::nth_element(gaps.begin(), gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2), gaps.end());
  return gaps[gaps.size() / 2];
}

double smallest_usual_gap(const std::vector<LabelContours>& files) {
  double least = std::numeric_limits<double>::infinity();
  for (const LabelContours& f : files)
    if (const double gap = usual_gap(f); gap > 0) least = std::min(least, gap);
  return std::isfinite(least) ? least : 0;
}

/// The area within the outermost contours.
double filled_area(const ContourSection& s) {
  double sum = 0;
  for (std::size_t p = 0; p < s.polygons.size(); ++p) {
    const std::vector<Point>& points = s.polygons[p].points;
    if (points.size() < 3) continue;
    bool inner = false;
    for (std::size_t q = 0; q < s.polygons.size() && !inner; ++q)
      inner = q != p && s.polygons[q].points.size() > 2 && is_inside(points[0], s.polygons[q].points);
    if (inner) continue;
    double twice = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Point &a = points[i], &b = points[(i + 1) % points.size()];
      twice += (a[0] - points[0][0]) * (b[1] - points[0][1]) - (b[0] - points[0][0]) * (a[1] - points[0][1]);
    }
    sum += 0.5 * std::abs(twice);
  }
  return sum;
}

/// The sections of a file that hold contours.
std::vector<const ContourSection*> filled_sections(const LabelContours& f) {
  std::vector<const ContourSection*> list;
  for (const ContourSection& s : f.sections)
    if (!s.polygons.empty()) list.push_back(&s);
  return list;
}

class EndMaker {
 public:
  EndMaker(std::vector<LabelContours>& files, const ContourStackOptions& options)
      : files_(files), o_(options), smallest_(smallest_usual_gap(files)) {
    for (const LabelContours& f : files_)
      for (const ContourSection& s : f.sections) heights_.push_back(s.z_mm);
    std::sort(heights_.begin(), heights_.end());
    heights_.erase(std::unique(heights_.begin(), heights_.end()), heights_.end());
  }

  std::vector<DrawnEnds> run() {
    std::vector<DrawnEnds> ends;
    for (const LabelContours& f : files_) {
      ends.emplace_back();
      ends.back().label = f.label;
      if (filled_sections(f).empty()) continue;
      ends.back().low = end_of(f, false);
      ends.back().high = end_of(f, true);
    }
    if (!(smallest_ > 0)) return ends;
    for (bool high : {false, true}) place_flat(ends, high);
    std::sort(heights_.begin(), heights_.end());
    for (std::size_t f = 0; f < files_.size(); ++f)
      for (bool high : {false, true})
        if (!filled_sections(files_[f]).empty()) {
          DrawnEnd& end = high ? ends[f].high : ends[f].low;
          extend(files_[f], end, high);
          end.last_mm = (high ? filled_sections(files_[f]).back() : filled_sections(files_[f]).front())->z_mm;
        }
    return ends;
  }

 private:
  DrawnEnd end_of(const LabelContours& f, bool high) const {
    const std::vector<const ContourSection*> own = filled_sections(f);
    DrawnEnd end;
    const ContourSection& last = high ? *own.back() : *own.front();
    end.contour_mm = last.z_mm;
    double gap = smallest_;
    if (own.size() > 1) {
      const ContourSection& next = high ? *own[own.size() - 2] : *own[1];
      gap = std::abs(last.z_mm - next.z_mm);
      if (const double usual = usual_gap(f); gap > kLongGap_rel * usual) gap = usual;
      const double beside = filled_area(next);
      end.area_rel = beside > 0 ? filled_area(last) / beside : 0;
    }
    end.half_gap_mm = 0.5 * gap;
    const auto own_caps = o_.label_caps.find(f.label);
    const Caps caps = own_caps == o_.label_caps.end() ? o_.caps : high ? own_caps->second.high : own_caps->second.low;
    end.flat = caps == Caps::automatic ? end.area_rel >= StitchOptions().flat_area_rel : caps == Caps::flat;
    end.on_section = !o_.slices;
    return end;
  }

  /// The height in the list that is at most so far away; else the value itself.
  double snapped(double z, double tolerance) const {
    const auto it = std::lower_bound(heights_.begin(), heights_.end(), z);
    if (it != heights_.end() && *it - z <= tolerance) return *it;
    if (it != heights_.begin() && z - *std::prev(it) <= tolerance) return *std::prev(it);
    return z;
  }

  static double beyond(const DrawnEnd& e, bool high, double way) { return e.contour_mm + (high ? way : -way); }

  /// Slices end flat half a gap beyond their last one. At the end of the stack the stitcher sees to that, if the gaps
  /// there are the label's own; else a section on the end itself does.
  void place_flat(std::vector<DrawnEnds>& ends, bool high) {
    if (!o_.slices) return;
    const double top = high ? heights_.back() : heights_.front();
    const double joint =
        heights_.size() > 1 ? std::abs(top - (high ? heights_[heights_.size() - 2] : heights_[1])) / 2 : 0;
    bool any = false;
    for (const DrawnEnds& both : ends) {
      const DrawnEnd& e = high ? both.high : both.low;
      if (!e.flat) continue;
      const bool at_top = e.contour_mm == top;
      any = any || (at_top ? std::abs(joint - e.half_gap_mm) > kSameEnd_rel * e.half_gap_mm
                           : (high ? 1 : -1) * (beyond(e, high, e.half_gap_mm) - top) > 0);
    }
    std::vector<double> added;
    for (DrawnEnds& both : ends) {
      DrawnEnd& e = high ? both.high : both.low;
      if (!e.flat || (e.contour_mm == top && !any)) continue;
      e.on_section = true;
      added.push_back(snapped(beyond(e, high, e.half_gap_mm), kSameEnd_rel * e.half_gap_mm));
      heights_.insert(std::lower_bound(heights_.begin(), heights_.end(), added.back()), added.back());
    }
    heights_.erase(std::unique(heights_.begin(), heights_.end()), heights_.end());
  }

  /// Contours between the last one and the end, wherever the stack has heights.
  void extend(LabelContours& f, const DrawnEnd& e, bool high) const {
    if (e.flat && !e.on_section) return;
    if (e.flat && !o_.slices) return;
    const ContourSection last = high ? *filled_sections(f).back() : *filled_sections(f).front();
    const double reach = e.flat ? e.half_gap_mm * (1 + kSameEnd_rel) : (o_.slices ? 1.5 : 1.0) * e.half_gap_mm;
    std::vector<ContourSection> made;
    for (double z : heights_) {
      const double way = high ? z - e.contour_mm : e.contour_mm - z;
      if (way <= 0 || way > reach || (!e.flat && way > 0.95 * reach)) continue;
      ContourSection s = e.flat ? last : dome_section(last, 2 * e.half_gap_mm, o_.slices, way);
      s.z_mm = z;
      s.interpolated = true;
      if (!s.polygons.empty()) made.push_back(std::move(s));
    }
    // Its own empty sections there give way.
    f.sections.erase(std::remove_if(f.sections.begin(), f.sections.end(),
                                    [&](const ContourSection& s) {
                                      return std::any_of(made.begin(), made.end(),
                                                         [&](const ContourSection& m) { return m.z_mm == s.z_mm; });
                                    }),
                     f.sections.end());
    f.sections.insert(f.sections.end(), made.begin(), made.end());
    std::stable_sort(f.sections.begin(), f.sections.end(),
                     [](const ContourSection& a, const ContourSection& b) { return a.z_mm < b.z_mm; });
  }

  std::vector<LabelContours>& files_;
  const ContourStackOptions& o_;
  const double smallest_;
  std::vector<double> heights_;
};

}  // namespace

void join_sections(LabelContours& file, double same_height_mm) {
  const double tolerance = std::max(same_height_mm, kOwnJitter_rel * usual_gap(file));
  std::vector<ContourSection> joined;
  for (ContourSection& s : file.sections) {
    if (joined.empty() || s.z_mm - joined.back().z_mm > tolerance) {
      joined.push_back(std::move(s));
      continue;
    }
    std::vector<ContourPolygon>& to = joined.back().polygons;
    to.insert(to.end(), std::make_move_iterator(s.polygons.begin()), std::make_move_iterator(s.polygons.end()));
  }
  file.sections = std::move(joined);
}

void align_heights(std::vector<LabelContours>& files, double same_height_mm) {
  const double tolerance = std::max(same_height_mm, kJitter_rel * smallest_usual_gap(files));
  struct Height {
    double z;
    std::size_t file;
    ContourSection* section;
  };
  std::vector<Height> all;
  for (std::size_t f = 0; f < files.size(); ++f)
    for (ContourSection& s : files[f].sections) all.push_back({s.z_mm, f, &s});
  std::sort(all.begin(), all.end(),
            [](const Height& a, const Height& b) { return a.z != b.z ? a.z < b.z : a.file < b.file; });
  for (std::size_t i = 0, j; i < all.size(); i = j) {
    std::vector<std::size_t> members;
    double sum = 0;
    for (j = i; j < all.size() && all[j].z - all[i].z <= tolerance &&
                std::find(members.begin(), members.end(), all[j].file) == members.end();
         ++j) {
      members.push_back(all[j].file);
      sum += all[j].z;
    }
    const double z = all[j - 1].z == all[i].z ? all[i].z : sum / static_cast<double>(j - i);
    for (std::size_t k = i; k < j; ++k) all[k].section->z_mm = z;
  }
}

std::vector<DrawnEnds> extend_ends(std::vector<LabelContours>& files, const ContourStackOptions& options) {
  return EndMaker(files, options).run();
}

}  // namespace stackmesh
