// The page's tables of a solver model.
#include "report/html_text.h"
#include "report/page_text.h"

namespace stackmesh {
namespace {

constexpr const char* kTableEnd = "</tbody></table></div>\n";

std::string row_head(const std::string& name) {
  return "<tr><th scope=\"row\" class=\"text\">" + escaped(name) + "</th>";
}

std::string place(Vec3 p) {
  return number(p.x) + ", " + number(p.y) + ", " + number(p.z);
}

/// How large the model is, and what it was made from.
std::string summary(const FemReport& f) {
  const std::string of_wedges =
      f.wedges > 0 ? " and " + grouped(f.wedges) + " wedges of " + (f.order == 2 ? "15" : "6") : "";
  return "<p>" + grouped(f.elements - f.wedges) + " tetrahedra of " + (f.order == 2 ? "10" : "4") + of_wedges +
         " nodes, " + grouped(f.nodes) + " nodes" +
         (f.shells > 0 ? ", " + grouped(f.shells) + " faces with a skin" : "") + "; units mm, N, MPa, t/mm\xc2\xb3. " +
         escaped(f.image.empty() ? "No intensities were mapped." : "Intensities: " + f.image + ".") + " " +
         escaped(f.materials_path.empty() ? "No law was given: materials hold the place (E = 1 MPa)."
                                          : "Law: " + f.materials_path + ".") +
         "</p>\n";
}

std::string material_and_set_tables(const FemReport& f) {
  std::string out = table_head("Materials: Young's modulus by label, MPa",
                               {"*Label", "*law", "smallest", "mean", "largest", "Poisson", "density, t/mm\xc2\xb3",
                                "to floor, %", "to ceiling, %", "materials", "elements", "voxels"});
  for (const MaterialRow& m : f.materials)
    out += row_head(std::to_string(m.label) + " " + m.name) + text_cell(m.law.empty() ? "constant" : m.law) +
           cell(m.young_min_mpa, 4) + cell(m.young_mean_mpa, 4) + cell(m.young_max_mpa, 4) + cell(m.poisson) +
           cell(m.density_mean_t_mm3) + cell(100 * m.clamped_low) + cell(100 * m.clamped_high) +
           cell(static_cast<double>(m.materials), 6) + cell(static_cast<double>(m.elements), 6) +
           cell(static_cast<double>(m.voxels), 6) + "</tr>\n";
  out += kTableEnd + table_head("Sets of nodes and faces", {"*Set", "*what", "nodes", "faces"});
  for (const FemSet& s : f.sets)
    out += row_head(s.name) + text_cell(s.note) + cell(static_cast<double>(s.nodes), 6) +
           cell(static_cast<double>(s.faces), 6) + "</tr>\n";
  return out + kTableEnd;
}

/// Empty where no parts touch.
std::string pair_table(const FemReport& f) {
  if (f.pairs.empty()) return "";
  std::string out = table_head(
      "Parts that touch", {"*Pair", "*first surface", "*second surface", "*contact", "stiffness, MPa/mm", "friction"});
  for (const SurfacePair& p : f.pairs) {
    const bool contact = p.contact == Contact::contact;
    out += row_head(p.parts[0] + ", " + p.parts[1]) + text_cell(p.primary) + text_cell(p.secondary) +
           text_cell(contact                     ? "contact"
                     : p.contact == Contact::tie ? "tied"
                                                 : "none") +
           (contact ? cell(p.stiffness_mpa_mm, 4) + cell(p.friction)
                    : "<td data-v=\"\">none</td><td data-v=\"\">none</td>") +
           "</tr>\n";
  }
  return out + kTableEnd;
}

/// Empty where there is one body.
std::string body_table(const FemReport& f) {
  if (f.bodies.size() < 2) return "";
  std::string out = table_head("Bodies: tetrahedra that share faces; a load case must hold each of them",
                               {"*Label", "elements", "volume, mm\xc2\xb3", "*centre, mm"});
  for (std::size_t i = 0; i < f.bodies.size() && i < 100; ++i) {
    const Body& b = f.bodies[i];
    out += row_head(std::to_string(b.label) + " " + b.name) + cell(static_cast<double>(b.tets), 6) +
           cell(b.volume_mm3, 4) + text_cell(place(b.centre)) + "</tr>\n";
  }
  return out + kTableEnd;
}

std::string step_texts(const FemReport& f) {
  std::string out;
  for (const FemStep& s : f.steps)
    out += "<p>" + escaped(f.steps.size() > 1 ? "Step " + s.name : std::string("Load case")) + ": " +
           grouped(s.supports) + " supports, " +
           (s.frequency ? "natural frequencies"
                        : grouped(s.loaded_nodes) + " loaded nodes, force in all (" + place(s.force_n) + ") N") +
           (norm(s.gravity_mm_s2) > 0 ? ", gravity" : "") + (s.large_displacements ? ", large displacements" : "") +
           ".</p>\n";
  return out;
}

std::string accuracy_table(const FemAccuracy& a) {
  const Accuracy& e = a.estimate;
  std::string meshes;
  for (const std::size_t n : a.elements) meshes += (meshes.empty() ? "" : ", ") + grouped(n);
  std::string out = "<p>Accuracy: " + number(100 * e.error_rel) + " % in set " + escaped(e.worst_set) + " (requested " +
                    number(100 * a.asked_rel) + " %" + (a.reached ? "" : ", not reached") +
                    "), by CalculiX on meshes of " + meshes + " elements; error in energy by Zienkiewicz and Zhu " +
                    number(100 * (e.zz_rel.empty() ? 0 : e.zz_rel.back())) + " %.</p>\n";
  out += table_head("Convergence by set: von Mises stress on its faces (root mean square) and its largest displacement",
                    {"*Set", "last mesh, MPa", "tends to, MPa", "order", "error, %", "displacement, mm", "its error, %",
                     "Zienkiewicz-Zhu, %", "largest stress, MPa", "*counts"});
  for (const SetAccuracy& s : e.sets)
    out += row_head(s.set) + cell(s.mises_rms_mpa.back(), 4) + cell(s.mises_extrapolated_mpa, 4) + cell(s.order) +
           cell(100 * s.error_rel) + cell(s.displacement_max_mm.back(), 4) + cell(100 * s.displacement_error_rel) +
           cell(100 * s.zz_rel) + cell(s.mises_max_mpa.back(), 4) + text_cell(s.held ? "no, it is held" : "yes") +
           "</tr>\n";
  return out + kTableEnd;
}

std::string model_tables(const FemReport& f) {
  return summary(f) + material_and_set_tables(f) + pair_table(f) + body_table(f) + step_texts(f) +
         (f.accuracy ? accuracy_table(*f.accuracy) : "");
}

}  // namespace

std::string model_html(const std::vector<HtmlSubject>& subjects) {
  std::string out;
  for (const HtmlSubject& s : subjects)
    if (s.report->fem) out += model_tables(*s.report->fem);
  return out.empty()
             ? ""
             : "<section id=\"model\" aria-labelledby=\"model-title\"><h2 id=\"model-title\">Solver model</h2>\n" +
                   out + "</section>\n";
}

}  // namespace stackmesh
