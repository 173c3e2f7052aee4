#include "report/page_text.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "model/space.h"
#include "report/comparison.h"
#include "report/html_text.h"

namespace stackmesh {
namespace {

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
