#include "sections/drawn_warnings.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "sections/contour_names.h"
#include "sections/openings.h"

namespace stackmesh {
namespace {

constexpr double kInside_rel = 0.999;     // of a label in another one is all of it
constexpr double kMostlyOpen_rel = 0.25;  // of a label's outline outside another one: it does not lie inside

/// How one label's outline lies in another label, in one section.
struct Exposure {
  double outline_mm = 0, bare_mm = 0;  // all of it; what is not within the other label
  std::vector<OpenEdge> open;          // the bare edges
};

Exposure exposure_of(std::size_t label, std::size_t around, const MaskedSection& m, const DrawnGrid& grid) {
  Exposure out;
  for (const MaskedSection::Edge& e : m.edges) {
    if (e.left[label] == e.right[label]) continue;
    const GridPoint a = m.section.points[e.a], b = m.section.points[e.b];
    const double length = std::hypot(static_cast<double>(b.x) - a.x, static_cast<double>(b.y) - a.y) * grid.unit_mm;
    out.outline_mm += length;
    if (e.left[label] ? e.right[around] : e.left[around]) continue;
    out.bare_mm += length;
    out.open.push_back({e.a, e.b, grid.place_of(a), grid.place_of(b)});
  }
  return out;
}

}  // namespace

void warn_missing_heights(const std::vector<LabelContours>& files, const std::vector<DrawnLevel>& levels,
                          std::vector<Warning>& warnings) {
  for (std::size_t f = 0; f < files.size(); ++f) {
    if (files[f].sections.empty()) continue;
    const double low = files[f].sections.front().z_mm, high = files[f].sections.back().z_mm;
    std::size_t missing = 0;
    double first = 0;
    for (const DrawnLevel& level : levels)
      if (level.z_mm > low && level.z_mm < high && level.of_file[f] == nullptr && missing++ == 0) first = level.z_mm;
    if (missing > 0)
      warnings.push_back({WarningCode::missing_contours, files[f].path,
                          files[f].path + " has no contour at " + std::to_string(missing) +
                              " height(s) that other labels have (first: z = " + std::to_string(first) +
                              " mm); it is empty there"});
  }
}

void warn_wide_gaps(const LabelContours& file, std::vector<Warning>& warnings) {
  std::vector<double> z_mm;
  for (const ContourSection& own : file.sections)
    if (!own.interpolated) z_mm.push_back(own.z_mm);
  if (z_mm.size() < 4) return;
  std::vector<double> gaps;
  for (std::size_t i = 1; i < z_mm.size(); ++i) gaps.push_back(z_mm[i] - z_mm[i - 1]);
  std::vector<double> sorted = gaps;
  std::nth_element(sorted.begin(), sorted.begin() + sorted.size() / 2, sorted.end());
  const double usual = sorted[sorted.size() / 2];
  std::vector<double> lost;
  for (std::size_t i = 0; i < gaps.size(); ++i) {
    const double missing = std::round(gaps[i] / usual) - 1;
    for (int k = 1; gaps[i] > 1.5 * usual && k <= missing && k <= 1000; ++k)
      lost.push_back(z_mm[i] + k * gaps[i] / (missing + 1));
  }
  if (!lost.empty())
    warnings.push_back(warning_at(WarningCode::missing_contours, file.path,
                                  name_of(file) + " has no contour at about z = " + list_heights(lost) +
                                      " mm, where its usual gap of " + formatted(usual, "%.3g") +
                                      " mm asks for some; it is interpolated there"));
}

void warn_open_walls(const std::vector<LabelContours>& files, const std::vector<MaskedSection>& sections,
                     const std::vector<double>& thickness_mm, const DrawnGrid& grid, std::vector<Warning>& warnings) {
  struct Pair {
    std::size_t inside = 0;  // sections
    std::vector<double> open_z_mm;
    double area_mm2 = 0;
    std::string openings;  // one by one
  };
  std::map<std::pair<std::size_t, std::size_t>, Pair> pairs;
  for (std::size_t i = 0; i < sections.size(); ++i) {
    const Section& section = sections[i].section;
    if (section.interpolated) continue;
    for (std::size_t f = 0; f < files.size(); ++f)
      for (std::size_t g = 0; g < files.size(); ++g) {
        if (f == g) continue;
        const Exposure e = exposure_of(f, g, sections[i], grid);
        if (e.outline_mm == 0 || e.bare_mm > kMostlyOpen_rel * e.outline_mm) continue;
        Pair& p = pairs[{f, g}];
        if (e.bare_mm == 0) {
          ++p.inside;
        } else {
          p.open_z_mm.push_back(section.z_mm);
          p.area_mm2 += e.bare_mm * thickness_mm[i];
          p.openings += list_openings(e.open, section.z_mm, thickness_mm[i]) + ";";
        }
      }
  }
  for (const auto& [pair, p] : pairs)
    if (!p.open_z_mm.empty() && p.inside >= p.open_z_mm.size())
      warnings.push_back(warning_at(WarningCode::open_wall, files[pair.first].path,
                                    name_of(files[pair.first]) + " lies inside " + name_of(files[pair.second]) +
                                        ", but reaches its outline at z = " + list_heights(p.open_z_mm) +
                                        " mm: the wall between them is open there, over about " +
                                        formatted(p.area_mm2, "%.3g") +
                                        " mm2:" + p.openings.substr(0, p.openings.size() - 1)));
}

void warn_overlaps(const std::vector<LabelContours>& files, const DrawnOverlaps& overlaps,
                   const std::vector<std::size_t>& by_rank, std::vector<Warning>& warnings) {
  std::map<std::size_t, std::string> inside;  // outer -> names of what lies in it
  const std::vector<double>& own = overlaps.volume_mm3;
  for (const auto& [pair, volume] : overlaps.shared_mm3) {
    const auto place = [&](std::size_t f) { return std::find(by_rank.begin(), by_rank.end(), f); };
    const bool in_order = place(pair.first) < place(pair.second);
    const std::size_t first = in_order ? pair.first : pair.second, loser = in_order ? pair.second : pair.first;
    if (!(volume > 1e-4 * std::min(own[first], own[loser]))) continue;  // rounding, a line shared
    const std::string how_much = formatted(volume, "%.4g") + " mm3";
    const std::string winner_name = name_of(files[first]), loser_name = name_of(files[loser]);
    if (volume >= kInside_rel * own[loser])
      warnings.push_back(warning_at(WarningCode::overlap, files[loser].path,
                                    loser_name + " lies wholly under " + winner_name +
                                        ", which has priority: nothing of its " + how_much + " is left"));
    else if (volume >= kInside_rel * own[first])
      inside[loser] += (inside[loser].empty() ? "" : ", ") + winner_name + " (" + how_much + ")";
    else
      warnings.push_back(warning_at(WarningCode::overlap, files[loser].path,
                                    winner_name + " and " + loser_name + " overlap in " + how_much + " (" +
                                        formatted(100 * volume / own[first], "%.2g") + " and " +
                                        formatted(100 * volume / own[loser], "%.2g") + " % of them), which went to " +
                                        winner_name));
  }
  for (const auto& [outer, names] : inside)
    warnings.push_back(warning_at(WarningCode::taken_out, files[outer].path,
                                  "inside " + name_of(files[outer]) + ", and taken out of it: " + names));
}

}  // namespace stackmesh
