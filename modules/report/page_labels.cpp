// The page's tables of labels and of layers.
#include <algorithm>

#include "report/html_text.h"
#include "report/page_text.h"

namespace stackmesh {
namespace {

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

}  // namespace

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

}  // namespace stackmesh
