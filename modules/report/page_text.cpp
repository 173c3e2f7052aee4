#include "report/page_text.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "model/space.h"
#include "report/comparison.h"

namespace stackmesh {
namespace {

/// About three significant digits; thousands apart; "none" where there is nothing.
std::string number(double value, int digits = 3) {
  if (!std::isfinite(value)) return "none";
  const double size = std::abs(value);
  if (size >= 1000 && size < 1e15)
    return (value < 0 ? "\xe2\x88\x92" : "") + grouped(static_cast<std::uint64_t>(std::llround(size)));
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
  return std::string("<td data-v=\"") + exact(value) + "\"" + (*kind ? std::string(" class=\"") + kind + "\"" : "") +
         ">" + number(value, digits) + "</td>";
}

template <class T>
std::string cell_of(const std::optional<T>& value, int digits = 3, const char* kind = "") {
  return value ? cell(static_cast<double>(*value), digits, kind) : "<td data-v=\"\">none</td>";
}

std::string text_cell(const std::string& text) {
  return "<td class=\"text\">" + escaped(text) + "</td>";
}

std::string distance_cells(const std::optional<Distance>& d, const char* kind) {
  if (!d) return "<td data-v=\"\">none</td><td data-v=\"\">none</td><td data-v=\"\">none</td>";
  return cell(d->mean, 3, kind) + cell(d->p95, 3, kind) + cell(d->max, 3, kind);
}

std::string band_cells(const std::optional<BandDistance>& d, const char* kind) {
  if (!d) return "<td data-v=\"\">none</td><td data-v=\"\">none</td><td data-v=\"\">none</td>";
  return cell(d->mean, 3, kind) + cell(d->max, 3, kind) + cell(100 * d->outside_share, 3);
}

std::string label_name(const LabelReport& l) {
  return l.name.empty() ? std::to_string(l.label) : std::to_string(l.label) + " " + l.name;
}

std::string row(const std::string& name, const std::string& value) {
  return "<tr><th scope=\"row\">" + escaped(name) + "</th><td class=\"text\">" + escaped(value) + "</td></tr>\n";
}

std::string badge(const std::string& status) {
  return "<span class=\"badge " + status + "\">" + status + "</span>";
}

std::string joined(const std::vector<std::string>& words) {
  std::string out;
  for (std::size_t i = 0; i < words.size(); ++i)
    out += (i == 0 ? "" : i + 1 == words.size() ? " and " : ", ") + words[i];
  return out;
}

/// The whole verdict in one word and one sentence.
std::string banner(const RunReport& r) {
  if (r.verdicts.empty())
    return "<div class=\"banner none\"><span class=\"word\">NOT JUDGED</span><p class=\"why\">This run gave no "
           "verdict.</p></div>\n";
  std::vector<std::string> invalid, outside, warnings;
  for (const Verdict& v : r.verdicts) {
    if (v.status == Status::fail) (v.validity ? invalid : outside).push_back(v.title);
    if (v.status == Status::warn) warnings.push_back(v.title);
  }
  std::string word = "PASS", sentence = "The mesh is valid and inside every limit.";
  if (!warnings.empty())
    word = "WARN", sentence = "The mesh is valid. Look before you use it at: " + joined(warnings) + ".";
  if (!outside.empty()) word = "FAIL", sentence = "The mesh is valid, but outside a limit: " + joined(outside) + ".";
  if (!invalid.empty())
    word = "FAIL", sentence = "The mesh is invalid and should not be used. What is wrong: " + joined(invalid) + ".";
  return std::string("<div class=\"banner ") + to_text(overall(r.verdicts)) + "\"><span class=\"word\">" + word +
         "</span><p class=\"why\">" + escaped(sentence) + "</p></div>\n";
}

/// "bad" or "odd" where the verdict fails or warns because of this label.
const char* blame(const RunReport& r, const char* id, Label label) {
  for (const Verdict& v : r.verdicts)
    if (v.id == id && v.status != Status::pass && std::find(v.labels.begin(), v.labels.end(), label) != v.labels.end())
      return v.status == Status::fail ? "bad" : "odd";
  return "";
}

std::string label_table(const RunReport& r, const std::vector<std::string>& colours) {
  struct Group {
    const char* name;
    std::vector<const char*> heads;
  };
  static const std::vector<Group> groups = {
      {"", {"Label"}},
      {"Topology", {"closed", "pieces", "in input", "Euler", "genus", "touching edges"}},
      {"Volume, mm\xc2\xb3", {"input", "surface", "tets", "change, %"}},
      {"", {"tets"}},
      {"Voxel centres", {"Dice", "wrong", "wrong, %"}},
      {"Outside the band, mm", {"mean", "max", "share, %"}},
      {"Bends", {"mean, \xc2\xb0", "above 40\xc2\xb0, %"}},
      {"Labels to mesh, to faces, mm", {"mean", "95 %", "max"}},
      {"Mesh to labels, to faces, mm", {"mean", "95 %", "max"}},
      {"Smallest angle, largest dihedral, \xc2\xb0", {"triangle", "dihedral", "largest"}},
      {"Thickness", {"thin, %", "5 %, mm"}},
      {"Ends", {"low", "high"}}};
  std::string heads, tops;
  std::size_t column = 0;
  for (const Group& g : groups) {
    tops += "<th colspan=\"" + std::to_string(g.heads.size()) + "\"" + (*g.name ? " scope=\"colgroup\"" : "") + ">" +
            g.name + "</th>";
    for (const char* head : g.heads) {
      const std::string name = g.name, text = head;
      heads += "<th scope=\"col\"" +
               std::string(text == "Label" || text == "closed" || name == "Ends" ? " class=\"text\"" : "") +
               " data-sort=\"" + std::to_string(column++) + "\">" + head + "</th>";
    }
  }
  std::string out =
      "<div class=\"table tall wide\" tabindex=\"0\" role=\"region\" aria-label=\"Figures per label\"><table "
      "class=\"sortable\"><caption>A click on a column's head sorts. Coloured figures "
      "are those that a verdict names. Outside the band: how far the surface leaves the cells between voxel centres of "
      "different labels. Bends: angles between "
      "neighbouring triangles, weighted by length. Distances to voxel faces are never 0 for a smooth surface and carry "
      "no verdict. Thin: share of the surface where the label is thinner than two elements.</caption><thead><tr "
      "class=\"groups\">" +
      tops + "</tr><tr>" + heads + "</tr></thead><tbody>\n";
  for (std::size_t k = 0; k < r.labels.size(); ++k) {
    const LabelReport& l = r.labels[k];
    const auto of = [&](const char* id) { return blame(r, id, l.label); };
    std::optional<double> change, thin, wrong, sharp;
    if (l.wrong_centres_share) wrong = 100 * *l.wrong_centres_share;
    if (l.bends_above_40_share) sharp = 100 * *l.bends_above_40_share;
    if (l.input_volume_mm3 && *l.input_volume_mm3 > 0) change = 100 * (l.surface_volume_mm3 / *l.input_volume_mm3 - 1);
    if (l.thin_share) thin = 100 * *l.thin_share;
    out += "<tr><th scope=\"row\" class=\"text\" data-v=\"" + std::to_string(l.label) +
           "\"><span class=\"swatch\" style=\"background:" + escaped(k < colours.size() ? colours[k] : "#999999") +
           "\"></span>" + escaped(label_name(l)) + (l.is_void ? " (void)" : "") + "</th>" +
           (l.closed ? "<td class=\"text\">yes</td>" : "<td class=\"text bad\">no</td>") +
           cell(l.components, 6, of("components")) + cell_of(l.input_components, 6) +
           cell(static_cast<double>(l.euler), 6) + cell_of(l.genus, 6) +
           cell(static_cast<double>(l.nonmanifold_edges), 6) + cell_of(l.input_volume_mm3, 4) +
           cell(l.surface_volume_mm3, 4) + cell_of(l.tet_volume_mm3, 4) + cell_of(change, 3, of("volume")) +
           cell_of(l.tets, 6) + cell_of(l.dice, 4, of("fidelity")) + cell_of(l.wrong_centres, 6) +
           cell_of(wrong, 3, of("fidelity")) + band_cells(l.band_distance_mm, of("fidelity")) +
           cell_of(l.mean_bend_deg) + cell_of(sharp, 3, of("roughness")) + distance_cells(l.distance_mm, "") +
           distance_cells(l.reverse_distance_mm, "") + cell(l.angle_min_deg, 3, of("quality")) +
           cell_of(l.dihedral_min_deg, 3, of("quality")) + cell_of(l.dihedral_max_deg, 4, of("quality")) +
           cell_of(thin, 3, of("thickness")) + cell_of(l.thickness_p5_mm) + text_cell(l.cap_low) +
           text_cell(l.cap_high) + "</tr>\n";
  }
  return out + "</tbody></table></div>\n";
}

/// The head of a table that a click sorts; names that begin with * are of text columns.
std::string table_head(const std::string& caption, const std::vector<std::string>& columns) {
  std::string out = "<div class=\"table tall\" tabindex=\"0\" role=\"region\" aria-label=\"" + escaped(caption) +
                    "\"><table class=\"sortable\"><caption>" + escaped(caption) + "</caption><thead><tr>";
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const bool text = columns[c][0] == '*';
    out += std::string("<th scope=\"col\"") + (text ? " class=\"text\"" : "") + " data-sort=\"" + std::to_string(c) +
           "\">" + escaped(columns[c].substr(text ? 1 : 0)) + "</th>";
  }
  return out + "</tr></thead><tbody>\n";
}

/// Layers of wedges, and the places where they are thin.
std::string layer_tables(const RunReport& r) {
  if (r.layers.empty()) return "";
  const char* const end = "</tbody></table></div>\n";
  const auto head = [](Label label) {
    return "<tr><th scope=\"row\" class=\"text\">" + std::to_string(label) + "</th>";
  };
  std::string out = table_head("Layers of wedges under outer faces",
                               {"*Label", "thickness, mm", "levels", "wedges", "pyramids", "tetrahedra",
                                "outer faces, mm\xc2\xb2", "whole, %", "thinner, %", "missing, %", "thinnest, mm"});
  for (const LayerFigures& f : r.layers)
    out += head(f.label) + cell(f.asked.thickness_mm) + cell(f.asked.count) + cell(static_cast<double>(f.wedges), 8) +
           cell(static_cast<double>(f.pyramids), 8) + cell(static_cast<double>(f.tets), 8) + cell(f.area_mm2, 5) +
           cell(100 * f.full_rel, 4) + cell(100 * f.thinned_rel, 3) + cell(100 * f.missing_rel, 3) +
           cell(f.thickness_min_mm) + "</tr>\n";
  out += end;
  if (std::all_of(r.layers.begin(), r.layers.end(), [](const LayerFigures& f) { return f.places.empty(); })) return out;
  out += table_head("Where a layer is thin (the largest twenty places of each label)",
                    {"*Label", "*at, mm", "area, mm\xc2\xb2", "thinnest, mm", "*why"});
  for (const LayerFigures& f : r.layers)
    for (std::size_t i = 0; i < std::min<std::size_t>(20, f.places.size()); ++i) {
      const LayerPlace& p = f.places[i];
      out += head(f.label) + text_cell(number(p.at_mm.x) + ", " + number(p.at_mm.y) + ", " + number(p.at_mm.z)) +
             cell(p.area_mm2, 4) + cell(p.thickness_mm) + text_cell(layer_limit_name(p.why)) + "</tr>\n";
    }
  return out + end;
}

std::string model_tables(const FemReport& f) {
  const char* const end = "</tbody></table></div>\n";
  const auto head = [](const std::string& name) {
    return "<tr><th scope=\"row\" class=\"text\">" + escaped(name) + "</th>";
  };
  const std::string of_wedges =
      f.wedges > 0 ? " and " + grouped(f.wedges) + " wedges of " + (f.order == 2 ? "15" : "6") : "";
  std::string out = "<p>" + grouped(f.elements - f.wedges) + " tetrahedra of " + (f.order == 2 ? "10" : "4") +
                    of_wedges + " nodes, " + grouped(f.nodes) + " nodes" +
                    (f.shells > 0 ? ", " + grouped(f.shells) + " faces with a skin" : "") +
                    "; units mm, N, MPa, t/mm\xc2\xb3. " +
                    escaped(f.image.empty() ? "No intensities were mapped." : "Intensities: " + f.image + ".") + " " +
                    escaped(f.materials_path.empty() ? "No law was given: materials hold the place (E = 1 MPa)."
                                                     : "Law: " + f.materials_path + ".") +
                    "</p>\n";
  out += table_head("Materials: Young's modulus by label, MPa",
                    {"*Label", "*law", "smallest", "mean", "largest", "Poisson", "density, t/mm\xc2\xb3", "to floor, %",
                     "to ceiling, %", "materials", "elements", "voxels"});
  for (const MaterialRow& m : f.materials)
    out += head(std::to_string(m.label) + " " + m.name) + text_cell(m.law.empty() ? "constant" : m.law) +
           cell(m.young_min_mpa, 4) + cell(m.young_mean_mpa, 4) + cell(m.young_max_mpa, 4) + cell(m.poisson) +
           cell(m.density_mean_t_mm3) + cell(100 * m.clamped_low) + cell(100 * m.clamped_high) +
           cell(static_cast<double>(m.materials), 6) + cell(static_cast<double>(m.elements), 6) +
           cell(static_cast<double>(m.voxels), 6) + "</tr>\n";
  out += end + table_head("Sets of nodes and faces", {"*Set", "*what", "nodes", "faces"});
  for (const FemSet& s : f.sets)
    out += head(s.name) + text_cell(s.note) + cell(static_cast<double>(s.nodes), 6) +
           cell(static_cast<double>(s.faces), 6) + "</tr>\n";
  out += end;
  if (!f.pairs.empty()) {
    out += table_head("Parts that touch",
                      {"*Pair", "*first surface", "*second surface", "*contact", "stiffness, MPa/mm", "friction"});
    for (const SurfacePair& p : f.pairs) {
      const bool contact = p.contact == Contact::contact;
      out += head(p.parts[0] + ", " + p.parts[1]) + text_cell(p.primary) + text_cell(p.secondary) +
             text_cell(contact                     ? "contact"
                       : p.contact == Contact::tie ? "tied"
                                                   : "none") +
             (contact ? cell(p.stiffness_mpa_mm, 4) + cell(p.friction)
                      : "<td data-v=\"\">none</td><td data-v=\"\">none</td>") +
             "</tr>\n";
    }
    out += end;
  }
  if (f.bodies.size() > 1) {
    out += table_head("Bodies: tetrahedra that share faces; a load case must hold each of them",
                      {"*Label", "elements", "volume, mm\xc2\xb3", "*centre, mm"});
    for (std::size_t i = 0; i < f.bodies.size() && i < 100; ++i) {
      const Body& b = f.bodies[i];
      out += head(std::to_string(b.label) + " " + b.name) + cell(static_cast<double>(b.tets), 6) +
             cell(b.volume_mm3, 4) +
             text_cell(number(b.centre.x) + ", " + number(b.centre.y) + ", " + number(b.centre.z)) + "</tr>\n";
    }
    out += end;
  }
  for (const FemStep& s : f.steps)
    out += "<p>" + escaped(f.steps.size() > 1 ? "Step " + s.name : std::string("Load case")) + ": " +
           grouped(s.supports) + " supports, " +
           (s.frequency ? "natural frequencies"
                        : grouped(s.loaded_nodes) + " loaded nodes, force in all (" + number(s.force_n.x) + ", " +
                              number(s.force_n.y) + ", " + number(s.force_n.z) + ") N") +
           (norm(s.gravity_mm_s2) > 0 ? ", gravity" : "") + (s.large_displacements ? ", large displacements" : "") +
           ".</p>\n";
  if (f.accuracy) {
    const Accuracy& e = f.accuracy->estimate;
    std::string meshes;
    for (const std::size_t n : f.accuracy->elements) meshes += (meshes.empty() ? "" : ", ") + grouped(n);
    out += "<p>Accuracy: " + number(100 * e.error_rel) + " % in set " + escaped(e.worst_set) + " (requested " +
           number(100 * f.accuracy->asked_rel) + " %" + (f.accuracy->reached ? "" : ", not reached") +
           "), by CalculiX on meshes of " + meshes + " elements; error in energy by Zienkiewicz and Zhu " +
           number(100 * (e.zz_rel.empty() ? 0 : e.zz_rel.back())) + " %.</p>\n";
    out +=
        table_head("Convergence by set: von Mises stress on its faces (root mean square) and its largest displacement",
                   {"*Set", "last mesh, MPa", "tends to, MPa", "order", "error, %", "displacement, mm", "its error, %",
                    "Zienkiewicz-Zhu, %", "largest stress, MPa", "*counts"});
    for (const SetAccuracy& s : e.sets)
      out += head(s.set) + cell(s.mises_rms_mpa.back(), 4) + cell(s.mises_extrapolated_mpa, 4) + cell(s.order) +
             cell(100 * s.error_rel) + cell(s.displacement_max_mm.back(), 4) + cell(100 * s.displacement_error_rel) +
             cell(100 * s.zz_rel) + cell(s.mises_max_mpa.back(), 4) + text_cell(s.held ? "no, it is held" : "yes") +
             "</tr>\n";
    out += end;
  }
  return out;
}

std::string stages_table(const RunReport& r, const std::string& of) {
  std::string out = "<div class=\"table\"><table><caption>" + escaped("Stages" + of) + "; peak memory " +
                    number(r.peak_rss_mb) +
                    " MB</caption><thead><tr><th scope=\"col\" class=\"text\">stage</th><th scope=\"col\">wall, "
                    "s</th><th scope=\"col\">CPU, s</th></tr></thead><tbody>\n";
  for (const StageTime& s : r.stages)
    out += "<tr><th scope=\"row\" class=\"text\">" + escaped(s.name) + "</th><td>" + number(s.wall_s) + "</td><td>" +
           number(s.cpu_s) + "</td></tr>\n";
  return out + "</tbody></table></div>\n";
}

}  // namespace

std::string grouped(std::uint64_t value) {
  std::string text = std::to_string(value);
  for (std::ptrdiff_t at = static_cast<std::ptrdiff_t>(text.size()) - 3; at > 0; at -= 3)
    text.insert(static_cast<std::size_t>(at), ",");
  return text;
}

std::string for_script(const std::string& json) {
  std::string out;
  out.reserve(json.size());
  for (const char c : json) {
    if (c == '<') out += "\\u003c";
    else if (c == '>') out += "\\u003e";
    else if (c == '&') out += "\\u0026";
    else out += c;
  }
  return out;
}

std::string filled(const std::string& page, const std::map<std::string, std::string>& parts) {
  std::string out;
  std::size_t at = 0;
  for (std::size_t open; (open = page.find("{{", at)) != std::string::npos;) {
    const std::size_t close = page.find("}}", open);
    out.append(page, at, open - at);
    out += parts.at(page.substr(open + 2, close - open - 2));
    at = close + 2;
  }
  return out.append(page, at, std::string::npos);
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      case '\0':
        out += "\xef\xbf\xbd";
        break;
      default:
        out += c;
    }
  return out;
}

std::string verdict_html(const std::vector<HtmlSubject>& subjects) {
  std::string out;
  for (const HtmlSubject& s : subjects) {
    const RunReport& r = *s.report;
    if (subjects.size() > 1) out += "<h3>" + escaped(s.name) + "</h3>\n";
    out += banner(r);
    out += "<ul class=\"checks-grid\">\n";
    for (const Verdict& v : r.verdicts) {
      const std::string status = to_text(v.status);
      out += "<li class=\"is-" + status + "\"><div class=\"name\"><span>" + escaped(v.title) + "</span>" +
             badge(status) + "</div><p class=\"figure\">" + escaped(v.figure) +
             "</p><p class=\"limit\">Limit: " + escaped(v.limit) + "</p><p class=\"note\">" + escaped(v.explanation) +
             "</p></li>\n";
    }
    out += "</ul>\n";
    if (r.input.dimensions[0] == 0)
      out +=
          "<p class=\"notice\">Not judged, as there are no voxels to compare with: components, volume and "
          "fidelity.</p>\n";
  }
  return out;
}

std::string comparison_html(const std::vector<HtmlSubject>& subjects) {
  if (subjects.size() < 2) return "";
  std::vector<RunReport> reports;
  for (const HtmlSubject& s : subjects) reports.push_back(*s.report);
  std::string out =
      "<section id=\"compare\" aria-labelledby=\"compare-title\"><h2 id=\"compare-title\">Comparison</h2>\n<div "
      "class=\"table\"><table><caption>The best figure of a row is "
      "bold and marked \xe2\x98\x85; worst label each.</caption><thead><tr><th scope=\"col\" "
      "class=\"text\">Figure</th>";
  for (const HtmlSubject& s : subjects) out += "<th scope=\"col\">" + escaped(s.name) + "</th>";
  out += "</tr></thead><tbody>\n<tr><th scope=\"row\">verdict</th>";
  for (const HtmlSubject& s : subjects) out += "<td>" + badge(to_text(overall(s.report->verdicts))) + "</td>";
  out += "</tr>\n";
  for (const ComparisonRow& row : compare(reports)) {
    if (row.id == "verdict") continue;
    out += "<tr><th scope=\"row\">" + escaped(row.name) + "</th>";
    for (std::size_t c = 0; c < row.texts.size(); ++c) {
      const bool best = std::find(row.best.begin(), row.best.end(), c) != row.best.end();
      out += (best ? "<td class=\"best\">\xe2\x98\x85 " : "<td>") + escaped(row.texts[c]) + "</td>";
    }
    out += "</tr>\n";
  }
  return out + "</tbody></table></div></section>\n";
}

std::string labels_html(const std::vector<HtmlSubject>& subjects, const std::vector<std::string>& colours) {
  std::string out;
  for (std::size_t s = 0; s < subjects.size(); ++s) {
    const std::string table = label_table(*subjects[s].report, colours) + layer_tables(*subjects[s].report);
    if (subjects.size() == 1) return table;
    out += std::string("<details") + (s == 0 ? " open" : "") + "><summary>" + escaped(subjects[s].name) +
           "</summary>\n" + table + "</details>\n";
  }
  return out;
}

std::string model_html(const std::vector<HtmlSubject>& subjects) {
  std::string out;
  for (const HtmlSubject& s : subjects)
    if (s.report->fem) out += model_tables(*s.report->fem);
  return out.empty()
             ? ""
             : "<section id=\"model\" aria-labelledby=\"model-title\"><h2 id=\"model-title\">Solver model</h2>\n" +
                   out + "</section>\n";
}

Vec3 place_of(const Defect& defect, const HtmlSubject& subject) {
  return subject.pictures == nullptr ? defect.where : in_space(defect.where, Space::lps, subject.pictures->space);
}

std::string defects_html(const std::vector<HtmlSubject>& subjects) {
  constexpr std::size_t kMost = 200;
  std::string rows;
  std::size_t total = 0, shown = 0;
  for (std::size_t m = 0; m < subjects.size(); ++m) {
    const std::vector<Defect>& defects = subjects[m].report->defects;
    total += defects.size();
    for (std::size_t d = 0; d < defects.size() && shown < kMost; ++d, ++shown) {
      const Defect& defect = defects[d];
      const Vec3 at = place_of(defect, subjects[m]);
      char place[120], data[160];
      std::snprintf(place, sizeof place, "%.1f, %.1f, %.1f mm", at.x, at.y, at.z);
      std::snprintf(data, sizeof data, "[%.6g,%.6g,%.6g]", at.x, at.y, at.z);
      std::string kind = defect.kind;
      std::replace(kind.begin(), kind.end(), '_', ' ');
      rows += "<tr>" + (subjects.size() > 1 ? text_cell(subjects[m].name) : "") + "<td data-v=\"" +
              std::to_string(d + 1) + "\">D" + std::to_string(d + 1) + "</td>" + text_cell(kind) +
              text_cell(defect.text) + cell(defect.label, 9) + "<td style=\"white-space:nowrap\">" + place + "</td>" +
              (defect.section ? cell(*defect.section + 1, 9) : "<td data-v=\"\"></td>") +
              cell(static_cast<double>(defect.count), 9) + cell(defect.size_mm) +
              "<td class=\"jump\"><button type=\"button\" data-mesh=\"" + std::to_string(m) + "\" data-size=\"" +
              exact(defect.size_mm) + "\" data-at=\"" + data + "\" aria-label=\"Show defect " + std::to_string(d + 1) +
              " in the pictures\">Show</button></td></tr>\n";
    }
  }
  if (total == 0) return "<p>No defects were found.</p>\n<h3>Elements with the worst figures</h3>\n";
  std::string out = "<h3>Defects</h3>\n<div class=\"table tall prose\"><table class=\"sortable\"><caption>" +
                    grouped(total) + (total == 1 ? " defect" : " defects");
  if (shown < total) out += "; the first " + grouped(shown) + " are listed, the JSON report has all";
  out += ". The numbers are those of the rings in the section picture.</caption><thead><tr>";
  std::size_t column = 0;
  const auto head = [&](const char* text, bool is_text) {
    out += std::string("<th scope=\"col\"") + (is_text ? " class=\"text\"" : "") + " data-sort=\"" +
           std::to_string(column++) + "\">" + text + "</th>";
  };
  if (subjects.size() > 1) head("Mesh", true);
  head("No.", false), head("What", true), head("In words", true), head("Label", false), head("At", false),
      head("Section", false), head("Count", false), head("Size, mm", false);
  return out + "<th scope=\"col\" class=\"jump text\">Show</th></tr></thead><tbody>\n" + rows +
         "</tbody></table></div>\n<h3>Elements with the worst figures</h3>\n";
}

std::string provenance_html(const std::vector<HtmlSubject>& subjects) {
  const RunReport& r = *subjects.front().report;
  std::string out =
      "<div class=\"two prose\"><div>\n<div class=\"table\"><table><caption>Input and program</caption><tbody>\n";
  out += row("input", r.input.path) + row("kind", r.input.kind);
  if (r.provenance && !r.provenance->input_sha256.empty())
    out += row(r.provenance->input_files > 1 ? "SHA-256 of " + std::to_string(r.provenance->input_files) + " files"
                                             : "SHA-256",
               r.provenance->input_sha256);
  if (r.input.dimensions[0] > 0) {
    const auto& d = r.input.dimensions;
    const auto& s = r.input.spacing_mm;
    out += row("dimensions",
               std::to_string(d[0]) + " x " + std::to_string(d[1]) + " x " + std::to_string(d[2]) + " voxels");
    out += row("spacing", exact(s[0]) + " x " + exact(s[1]) + " x " + exact(s[2]) + " mm");
    const auto& e = r.input.effective_spacing_mm;
    if (e != s) out += row("made on voxels of", exact(e[0]) + " x " + exact(e[1]) + " x " + exact(e[2]) + " mm");
  }
  if (r.input.sections > 0) out += row("sections", std::to_string(r.input.sections) + " along " + r.input.axis);
  out += row("world frame", r.input.space) + row("command", r.command) + row("program", "stackmesh " + r.version);
  if (r.provenance) {
    const Provenance& p = *r.provenance;
    out += row("compiler", p.compiler + (p.build_type.empty() ? "" : ", " + p.build_type)) +
           row("SHA-256 of the program", p.program_sha256);
    out += row("processor", p.processor + ", " + std::to_string(p.cores) + (p.cores == 1 ? " core" : " cores")) +
           row("memory", number(p.memory_gib) + " GiB") + row("system", p.system);
    out += row("finished", p.finished_utc);
  }
  out += "</tbody></table></div>\n";
  for (const HtmlSubject& s : subjects)
    if (s.report->mesh) {
      const JudgedMesh& m = *s.report->mesh;
      out += "<div class=\"table\"><table><caption>Mesh " + escaped(s.name) + "</caption><tbody>\n" +
             row("file", m.path) + row("format", m.format) + row("SHA-256", m.sha256) +
             row("in the file", grouped(m.vertices) + " vertices, " + grouped(m.triangles) + " triangles, " +
                                    grouped(m.tets) + " tetrahedra" + (m.order == 2 ? " of 10 nodes" : "") +
                                    (m.wedges > 0 ? ", " + grouped(m.wedges) + " wedges and pyramids" : "")) +
             row("labels", m.labels) + row("frame", m.space + ": " + m.space_reason) + "</tbody></table></div>\n";
    }
  out += "</div>\n<div>\n";
  for (const HtmlSubject& s : subjects) {
    out += "<h3>Warnings" + (subjects.size() > 1 ? " of " + escaped(s.name) : "") + "</h3>\n";
    if (s.report->warnings.empty()) {
      out += "<p>None.</p>\n";
      continue;
    }
    out += "<ul class=\"warnings\">\n";
    for (const Warning& w : s.report->warnings) out += "<li>" + escaped(w.text) + "</li>\n";
    out += "</ul>\n";
  }
  for (const HtmlSubject& s : subjects) out += stages_table(*s.report, subjects.size() > 1 ? " of " + s.name : "");
  out += "<div class=\"table\"><table><caption>Options</caption><tbody>\n";
  for (const auto& [name, value] : r.options) out += row(name, value);
  out +=
      "</tbody></table></div>\n<details><summary>Limits of the verdicts</summary><div class=\"table\"><table><tbody>\n";
  for (const auto& [name, value] : named_limits(r.limits)) out += row(name, std::isnan(value) ? "none" : exact(value));
  return out + "</tbody></table></div></details>\n</div></div>\n";
}

}  // namespace stackmesh
