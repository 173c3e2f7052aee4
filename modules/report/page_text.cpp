#include "report/page_text.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace stackmesh {
namespace {

/// About three significant digits; thousands apart; "none" where there is nothing.
std::string grouped(std::uint64_t value) {
  std::string text = std::to_string(value);
  for (std::ptrdiff_t at = static_cast<std::ptrdiff_t>(text.size()) - 3; at > 0; at -= 3) text.insert(static_cast<std::size_t>(at), ",");
  return text;
}

std::string number(double value, int digits = 3) {
  if (!std::isfinite(value)) return "none";
  const double size = std::abs(value);
  if (size >= 1000 && size < 1e15) return (value < 0 ? "\xe2\x88\x92" : "") + grouped(static_cast<std::uint64_t>(std::llround(size)));
  char text[40];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

std::string exact(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.9g", value);
  return text;
}

/// A cell with the value that it is sorted by.
std::string cell(double value, int digits = 3, const char* kind = "") {
  if (!std::isfinite(value)) return "<td data-v=\"\">none</td>";
  return std::string("<td data-v=\"") + exact(value) + "\"" + (*kind ? std::string(" class=\"") + kind + "\"" : "") + ">" + number(value, digits) + "</td>";
}

template <class T>
std::string cell_of(const std::optional<T>& value, int digits = 3, const char* kind = "") {
  return value ? cell(static_cast<double>(*value), digits, kind) : "<td data-v=\"\">none</td>";
}

std::string text_cell(const std::string& text) { return "<td class=\"text\">" + escaped(text) + "</td>"; }

std::string distance_cells(const std::optional<Distance>& d) {
  if (!d) return "<td data-v=\"\">none</td><td data-v=\"\">none</td><td data-v=\"\">none</td>";
  return cell(d->mean) + cell(d->p95) + cell(d->max);
}

std::string label_name(const LabelReport& l) { return l.name.empty() ? std::to_string(l.label) : std::to_string(l.label) + " " + l.name; }

std::string row(const std::string& name, const std::string& value) {
  return "<tr><th scope=\"row\">" + escaped(name) + "</th><td class=\"text\">" + escaped(value) + "</td></tr>\n";
}

}  // namespace

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) switch (c) {
      case '&': out += "&amp;"; break;
      case '<': out += "&lt;"; break;
      case '>': out += "&gt;"; break;
      case '"': out += "&quot;"; break;
      case '\'': out += "&#39;"; break;
      case '\0': out += "\xef\xbf\xbd"; break;
      default: out += c;
    }
  return out;
}

std::string verdict_html(const RunReport& r) {
  struct Check {
    std::string name, figure, limit;
    bool passes;
  };
  std::vector<Check> checks;
  if (r.surface) {
    checks.push_back({"Closed", grouped(r.surface->open_edges) + " open edges", "none allowed", r.surface->open_edges == 0});
    checks.push_back({"Free of intersections", grouped(r.surface->self_intersections) + " crossing pairs", "none allowed", r.surface->self_intersections == 0});
  }
  if (r.volume) {
    checks.push_back({"Tetrahedra upright", grouped(r.volume->inverted) + " inverted", "none allowed", r.volume->inverted == 0});
    checks.push_back({"Tetrahedra fit the surface", grouped(r.volume->nonconforming_faces) + " faces that do not", "none allowed", r.volume->conforms});
  }
  const bool all = std::all_of(checks.begin(), checks.end(), [](const Check& c) { return c.passes; });
  std::string out = std::string("<div class=\"banner ") + (all ? "pass" : "fail") + "\"><span class=\"word\">" + (all ? "PASS" : "FAIL") +
                    "</span><p class=\"why\">" + (all ? "The mesh is valid." : "The mesh is not valid and must not be used.") + "</p></div>\n<ul class=\"checks-grid\">\n";
  for (const Check& c : checks)
    out += std::string("<li class=\"is-") + (c.passes ? "pass" : "fail") + "\"><div class=\"name\"><span>" + c.name + "</span><span class=\"badge " +
           (c.passes ? "pass\">pass" : "fail\">fail") + "</span></div><p class=\"figure\">" + c.figure + "</p><p class=\"limit\">Limit: " + c.limit + "</p></li>\n";
  return out + "</ul>\n";
}

std::string labels_html(const RunReport& r, const std::vector<std::string>& colours) {
  static const char* const heads[] = {"Label", "closed", "pieces", "in input", "Euler no.", "input", "surface", "tets", "surface to input, %",
                                      "tets", "Dice", "mean", "95 %", "max", "mean", "95 %", "max", "low", "high"};
  std::string out =
      "<div class=\"table tall\" tabindex=\"0\" role=\"region\" aria-label=\"Figures per label\"><table class=\"sortable\"><caption>Volumes in mm\xc2\xb3, distances in mm. "
      "A click on a column's head sorts.</caption><thead><tr class=\"groups\"><th colspan=\"5\">Topology</th><th colspan=\"4\">Volume</th>"
      "<th colspan=\"2\">Elements, overlap</th><th colspan=\"3\">Labels to mesh</th><th colspan=\"3\">Mesh to labels</th><th colspan=\"2\">Ends</th></tr><tr>";
  for (std::size_t k = 0; k < sizeof heads / sizeof *heads; ++k)
    out += "<th scope=\"col\"" + std::string(k == 0 || k >= 17 || k == 1 ? " class=\"text\"" : "") + " data-sort=\"" + std::to_string(k) + "\">" + heads[k] + "</th>";
  out += "</tr></thead><tbody>\n";
  for (std::size_t k = 0; k < r.labels.size(); ++k) {
    const LabelReport& l = r.labels[k];
    const bool fewer = l.input_components && *l.input_components != l.components;
    std::optional<double> change;
    if (l.input_volume_mm3 && *l.input_volume_mm3 > 0) change = 100 * (l.surface_volume_mm3 / *l.input_volume_mm3 - 1);
    out += "<tr><th scope=\"row\" data-v=\"" + std::to_string(l.label) + "\"><span class=\"swatch\" style=\"background:" + escaped(k < colours.size() ? colours[k] : "#999") +
           "\"></span>" + escaped(label_name(l)) + "</th>" + (l.closed ? "<td class=\"text\">yes</td>" : "<td class=\"text bad\">no</td>") +
           cell(l.components, 6, fewer ? "odd" : "") + cell_of(l.input_components, 6) + cell(static_cast<double>(l.euler), 6) + cell_of(l.input_volume_mm3, 4) +
           cell(l.surface_volume_mm3, 4) + cell_of(l.tet_volume_mm3, 4) + cell_of(change, 3) + cell_of(l.tets, 6) + cell_of(l.dice, 4) +
           distance_cells(l.distance_mm) + distance_cells(l.reverse_distance_mm) + text_cell(l.cap_low) + text_cell(l.cap_high) + "</tr>\n";
  }
  return out + "</tbody></table></div>\n";
}

std::string comparison_html(const std::vector<HtmlSubject>& subjects) {
  if (subjects.size() < 2) return "";
  std::string out = "<section id=\"compare\" aria-labelledby=\"compare-title\"><h2 id=\"compare-title\">Comparison</h2>\n<div class=\"table\"><table><thead><tr><th scope=\"col\" class=\"text\">Figure</th>";
  for (const HtmlSubject& s : subjects) out += "<th scope=\"col\">" + escaped(s.name) + "</th>";
  return out + "</tr></thead><tbody></tbody></table></div></section>\n";
}

std::string provenance_html(const RunReport& r) {
  std::string out = "<div class=\"two\"><div>\n<div class=\"table\"><table><caption>Input and program</caption><tbody>\n";
  out += row("program", "stackmesh " + r.version) + row("command", r.command) + row("input", r.input.path) + row("kind", r.input.kind);
  if (r.input.dimensions[0] > 0) {
    const auto& d = r.input.dimensions;
    const auto& s = r.input.spacing_mm;
    out += row("dimensions", std::to_string(d[0]) + " x " + std::to_string(d[1]) + " x " + std::to_string(d[2]) + " voxels");
    out += row("spacing", exact(s[0]) + " x " + exact(s[1]) + " x " + exact(s[2]) + " mm");
  }
  out += row("sections", std::to_string(r.input.sections) + " along " + r.input.axis) + row("world frame", r.input.space);
  out += "</tbody></table></div>\n<h3>Warnings</h3>\n";
  if (r.warnings.empty()) out += "<p>None.</p>\n";
  if (!r.warnings.empty()) out += "<ul class=\"warnings\">\n";
  for (const std::string& w : r.warnings) out += "<li>" + escaped(w) + "</li>\n";
  if (!r.warnings.empty()) out += "</ul>\n";
  out += "</div>\n<div>\n<div class=\"table\"><table><caption>Stages; peak memory " + number(r.peak_rss_mb) + " MB</caption><thead><tr><th scope=\"col\" class=\"text\">stage</th><th scope=\"col\">wall, s</th><th scope=\"col\">CPU, s</th></tr></thead><tbody>\n";
  for (const StageTime& s : r.stages) out += "<tr><th scope=\"row\">" + escaped(s.name) + "</th><td>" + number(s.wall_s) + "</td><td>" + number(s.cpu_s) + "</td></tr>\n";
  out += "</tbody></table></div>\n<details open><summary>Options</summary><div class=\"table\"><table><tbody>\n";
  for (const auto& [name, value] : r.options) out += row(name, value);
  return out + "</tbody></table></div></details>\n</div></div>\n";
}

}  // namespace stackmesh
