#include "report/comparison.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace stackmesh {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

std::string printed(const char* format, double value) {
  if (std::isnan(value)) return "-";
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

template <class D>
double worst_distance(const RunReport& r, std::optional<D> LabelReport::*which, double D::*part) {
  double worst = kNaN;
  for (const LabelReport& l : r.labels)
    if (l.*which && !std::isnan((*(l.*which)).*part))
      worst = std::isnan(worst) ? (*(l.*which)).*part : std::max(worst, (*(l.*which)).*part);
  return worst;
}

/// Columns as wide as their widest cell; the first is flush left, as is the last when asked.
class Table {
 public:
  void row(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }
  std::string text(std::size_t left_columns, bool last_left = false) const {
    std::vector<std::size_t> width;
    for (const auto& r : rows_) {
      width.resize(std::max(width.size(), r.size()), 0);
      for (std::size_t c = 0; c < r.size(); ++c) width[c] = std::max(width[c], columns(r[c]));
    }
    std::string text;
    for (const auto& r : rows_) {
      std::string line;
      for (std::size_t c = 0; c < r.size(); ++c) {
        const std::string space(width[c] - columns(r[c]), ' ');
        const bool left = c < left_columns || (last_left && c + 1 == r.size());
        line += (c ? "  " : "") + (left ? r[c] + space : space + r[c]);
      }
      while (!line.empty() && line.back() == ' ') line.pop_back();
      text += line + "\n";
    }
    return text;
  }

 private:
  static std::size_t columns(const std::string& utf8) {
    return static_cast<std::size_t>(
        std::count_if(utf8.begin(), utf8.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
  }
  std::vector<std::vector<std::string>> rows_;
};

std::string file_name(const std::string& path) {
  return path.substr(path.rfind('/') + 1);
}

enum class Better { less, more, neither };

/// Rows of a table, one figure after the other.
class Rows {
 public:
  explicit Rows(const std::vector<RunReport>& reports) : reports_(reports) {}

  /// @param value of a report; NaN: not measured @param format for std::printf
  template <class Value>
  void add(const char* id, const char* name, const char* format, Better better, Value value) {
    ComparisonRow row;
    row.id = id, row.name = name;
    for (const RunReport& r : reports_) {
      row.values.push_back(value(r));
      row.texts.push_back(printed(format, row.values.back()));
    }
    double best = kNaN;
    bool differ = false;
    const auto rank = [&](double v) { return better == Better::more ? -v : std::abs(v); };
    for (const double v : row.values) {
      if (std::isnan(v)) continue;
      if (!std::isnan(best) && rank(v) != rank(best)) differ = true;
      if (std::isnan(best) || rank(v) < rank(best)) best = v;
    }
    if (better != Better::neither && differ)
      for (std::size_t i = 0; i < row.values.size(); ++i)
        if (rank(row.values[i]) == rank(best)) row.best.push_back(i);
    rows_.push_back(std::move(row));
  }

  std::vector<ComparisonRow> take() { return std::move(rows_); }

 private:
  const std::vector<RunReport>& reports_;
  std::vector<ComparisonRow> rows_;
};

template <class Field>
auto surface_figure(Field field) {
  return [field](const RunReport& r) { return r.surface ? static_cast<double>((*r.surface).*field) : kNaN; };
}

template <class Field>
auto volume_figure(Field field) {
  return [field](const RunReport& r) { return r.volume ? static_cast<double>((*r.volume).*field) : kNaN; };
}

template <class Which, class Part>
auto distance_figure(Which which, Part part) {
  return [which, part](const RunReport& r) { return worst_distance(r, which, part); };
}

void add_sizes_and_validity(Rows& rows) {
  rows.add("triangles", "triangles", "%.0f", Better::neither, surface_figure(&SurfaceCheck::triangles));
  rows.add("tets", "tetrahedra", "%.0f", Better::neither, volume_figure(&VolumeCheck::tets));
  rows.add("open_edges", "open edges", "%.0f", Better::less, surface_figure(&SurfaceCheck::open_edges));
  rows.add("self_intersections", "self-intersections", "%.0f", Better::less,
           surface_figure(&SurfaceCheck::self_intersections));
  rows.add("inverted", "inverted tetrahedra", "%.0f", Better::less, volume_figure(&VolumeCheck::inverted));
}

void add_likeness(Rows& rows) {
  rows.add("components", "components (surface)", "%.0f", Better::neither, [](const RunReport& r) {
    double n = 0;
    for (const LabelReport& l : r.labels) n += l.components;
    return n;
  });
  rows.add("volume_error_percent", "volume error %", "%+.2f", Better::less, [](const RunReport& r) {
    double input = 0, mesh = 0;
    for (const LabelReport& l : r.labels)
      if (l.input_volume_mm3) input += *l.input_volume_mm3, mesh += l.surface_volume_mm3;
    return input > 0 ? 100 * (mesh / input - 1) : kNaN;
  });
  rows.add("dice_min", "least Dice", "%.4f", Better::more, [](const RunReport& r) {
    double least = kNaN;
    for (const LabelReport& l : r.labels)
      if (l.dice && !std::isnan(*l.dice)) least = std::isnan(least) ? *l.dice : std::min(least, *l.dice);
    return least;
  });
  rows.add("wrong_centres_percent", "voxel centres wrong, %", "%.2f", Better::less, [](const RunReport& r) {
    double worst = kNaN;
    for (const LabelReport& l : r.labels)
      if (l.wrong_centres_share && !std::isnan(*l.wrong_centres_share))
        worst = std::isnan(worst) ? 100 * *l.wrong_centres_share : std::max(worst, 100 * *l.wrong_centres_share);
    return worst;
  });
}

void add_distances_and_bends(Rows& rows) {
  rows.add("band_mean_mm", "outside the band, mean mm", "%.4f", Better::less,
           distance_figure(&LabelReport::band_distance_mm, &BandDistance::mean));
  rows.add("band_max_mm", "outside the band, largest mm", "%.3f", Better::less,
           distance_figure(&LabelReport::band_distance_mm, &BandDistance::max));
  rows.add("mean_bend_deg", "mean bend, degrees", "%.1f", Better::neither,
           [](const RunReport& r) { return r.bends ? r.bends->mean_deg : kNaN; });
  rows.add("bends_above_40_percent", "edges that bend above 40 degrees, %", "%.2f", Better::less,
           [](const RunReport& r) { return r.bends ? 100 * r.bends->above_40_share : kNaN; });
  rows.add("distance_mean_mm", "labels to mesh, mean mm", "%.3f", Better::neither,
           distance_figure(&LabelReport::distance_mm, &Distance::mean));
  rows.add("distance_p95_mm", "labels to mesh, 95 % mm", "%.3f", Better::neither,
           distance_figure(&LabelReport::distance_mm, &Distance::p95));
  rows.add("distance_max_mm", "labels to mesh, largest mm", "%.3f", Better::neither,
           distance_figure(&LabelReport::distance_mm, &Distance::max));
  rows.add("reverse_mean_mm", "mesh to labels, mean mm", "%.3f", Better::neither,
           distance_figure(&LabelReport::reverse_distance_mm, &Distance::mean));
  rows.add("reverse_p95_mm", "mesh to labels, 95 % mm", "%.3f", Better::neither,
           distance_figure(&LabelReport::reverse_distance_mm, &Distance::p95));
  rows.add("reverse_max_mm", "mesh to labels, largest mm", "%.3f", Better::neither,
           distance_figure(&LabelReport::reverse_distance_mm, &Distance::max));
}

void add_quality(Rows& rows) {
  rows.add("angle_min_deg", "smallest angle", "%.2f", Better::more, surface_figure(&SurfaceCheck::angle_min_deg));
  rows.add("angle_median_deg", "median of smallest angles", "%.2f", Better::more,
           surface_figure(&SurfaceCheck::angle_median_deg));
  rows.add("dihedral_min_deg", "smallest dihedral", "%.2f", Better::more,
           volume_figure(&VolumeCheck::dihedral_min_deg));
  rows.add("dihedral_max_deg", "largest dihedral", "%.2f", Better::less, volume_figure(&VolumeCheck::dihedral_max_deg));
  rows.add("scaled_jacobian_min", "least scaled Jacobian", "%.3f", Better::more,
           volume_figure(&VolumeCheck::scaled_jacobian_min));
}

}  // namespace

std::vector<ComparisonRow> compare(const std::vector<RunReport>& reports) {
  Rows table(reports);
  add_sizes_and_validity(table);
  add_likeness(table);
  add_distances_and_bends(table);
  add_quality(table);
  std::vector<ComparisonRow> rows = table.take();
  // What was measured of no mesh is no row.
  rows.erase(std::remove_if(rows.begin(), rows.end(),
                            [](const ComparisonRow& r) {
                              return std::all_of(r.values.begin(), r.values.end(),
                                                 [](double v) { return std::isnan(v); });
                            }),
             rows.end());
  return rows;
}

std::string text_table(const std::vector<RunReport>& reports) {
  Table table;
  std::vector<std::string> head = {""}, verdict = {"verdict"};
  for (const RunReport& r : reports) {
    head.push_back((r.mesh ? file_name(r.mesh->path) : r.input.path) + " ");
    verdict.push_back(std::string(to_text(overall(r.verdicts))) + " ");
  }
  table.row(head);
  table.row(verdict);
  for (const ComparisonRow& row : compare(reports)) {
    std::vector<std::string> cells = {row.name};
    for (std::size_t i = 0; i < row.texts.size(); ++i)
      cells.push_back(row.texts[i] + (std::find(row.best.begin(), row.best.end(), i) != row.best.end() ? "*" : " "));
    table.row(cells);
  }
  return table.text(1) + "* best of its row; of several labels the worst is shown, of volumes the sum\n";
}

std::string text_summary(const RunReport& r) {
  std::string text;
  if (r.mesh) {
    text += "mesh     " + r.mesh->path + ": " + std::to_string(r.mesh->triangles) + " triangles";
    if (r.mesh->tets > 0)
      text += ", " + std::to_string(r.mesh->tets) + " tetrahedra" + (r.mesh->order == 2 ? " of 10 nodes" : "");
    text += "; " + r.mesh->labels + "\n";
    text += r.input.path.empty() ? "against  nothing: fidelity is not judged\n" : "against  " + r.input.path + "\n";
    text += "frame    " + r.mesh->space + ": " + r.mesh->space_reason + "\n";
  }
  Table verdicts;
  for (const Verdict& v : r.verdicts) verdicts.row({to_text(v.status), v.title, v.figure, v.limit});
  text += "verdict  " + std::string(to_text(overall(r.verdicts))) + "\n\n" + verdicts.text(4) + "\n";
  const bool tets = r.volume && r.volume->tets > 0;
  Table labels;
  std::vector<std::string> head = {"label", "voxels mm3", "surface mm3"};
  if (tets) head.push_back("tets mm3");
  for (const char* name : {"parts", "of", "Euler", "genus", "Dice", "wrong %", "band mm", "max mm", "bend", "to faces",
                           "95 %", "max mm", "back mean", "95 %", "max mm", "angle"})
    head.push_back(name);
  if (tets) head.push_back("dihedral");
  head.push_back("thin %"), head.push_back("name");
  labels.row(head);
  const auto number = [](const char* format, const auto& value) {
    return value ? printed(format, static_cast<double>(*value)) : std::string("-");
  };
  for (const LabelReport& l : r.labels) {
    std::vector<std::string> cells = {std::to_string(l.label), number("%.1f", l.input_volume_mm3),
                                      printed("%.1f", l.surface_volume_mm3)};
    if (tets) cells.push_back(number("%.1f", l.tet_volume_mm3));
    cells.push_back(std::to_string(l.components)), cells.push_back(number("%.0f", l.input_components));
    cells.push_back(std::to_string(l.euler)), cells.push_back(number("%.0f", l.genus)),
        cells.push_back(number("%.4f", l.dice));
    cells.push_back(l.wrong_centres_share ? printed("%.2f", 100 * *l.wrong_centres_share) : "-");
    for (const auto part : {&BandDistance::mean, &BandDistance::max})
      cells.push_back(l.band_distance_mm ? printed("%.3f", (*l.band_distance_mm).*part) : "-");
    cells.push_back(number("%.1f", l.mean_bend_deg));
    for (const auto& d : {l.distance_mm, l.reverse_distance_mm})
      for (const auto part : {&Distance::mean, &Distance::p95, &Distance::max})
        cells.push_back(d ? printed("%.3f", (*d).*part) : "-");
    cells.push_back(printed("%.1f", l.angle_min_deg));
    if (tets) cells.push_back(number("%.1f", l.dihedral_min_deg));
    cells.push_back(l.thin_share ? printed("%.1f", 100 * *l.thin_share) : "-");
    cells.push_back(l.name);
    labels.row(cells);
  }
  text += labels.text(0, true);
  std::size_t shown = 0, places = 0;
  std::string lines;
  for (const Defect& d : r.defects) {
    ++places;
    if (shown == 20) continue;
    ++shown;
    lines += d.kind + std::string(d.kind.size() < 20 ? 20 - d.kind.size() : 1, ' ') + d.text +
             (d.section ? ", section " + std::to_string(*d.section) : "") + "\n";
  }
  if (places > 0) text += "\nwhere (sections count from 0)\n" + lines;
  if (places > shown) text += "and " + std::to_string(places - shown) + " more places, in the report\n";
  return text;
}

}  // namespace stackmesh
