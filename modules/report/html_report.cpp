#include "report/html_report.h"

#include <map>
#include <nlohmann/json.hpp>

#include "report/html_text.h"
#include "report/page_files.h"
#include "report/page_text.h"

namespace stackmesh {
namespace {

using Json = nlohmann::ordered_json;

std::string base_name(const std::string& path) {
  const std::size_t end = path.find_last_not_of('/');
  if (end == std::string::npos) return path;
  const std::size_t slash = path.rfind('/', end);
  return path.substr(slash == std::string::npos ? 0 : slash + 1,
                     end - (slash == std::string::npos ? 0 : slash + 1) + 1);
}

/// The file of the input; of several up to three, or the first two and how many more.
std::string input_name(const RunReport& report) {
  const std::vector<std::string>& files = report.input.files;
  if (files.size() < 2) return base_name(report.input.path);
  const std::size_t named = files.size() > 3 ? 2 : files.size();
  std::string text;
  for (std::size_t i = 0; i < named; ++i) {
    const std::size_t equal = files[i].find('=');
    const bool labelled = equal != std::string::npos && equal < files[i].find('/');
    text += (i == 0                  ? ""
             : i + 1 == files.size() ? " and "
                                     : ", ") +
            base_name(labelled ? files[i].substr(equal + 1) : files[i]);
  }
  return named < files.size() ? text + " and " + std::to_string(files.size() - named) + " more files" : text;
}

/// The page is UTF-8; file names need not be.
std::string as_utf8(const std::string& text) {
  const std::string quoted = Json(text).dump(-1, ' ', false, Json::error_handler_t::replace);
  return Json::parse(quoted).get<std::string>();
}

}  // namespace

std::string to_html(const std::vector<HtmlSubject>& subjects) {
  const RunReport& first = *subjects.front().report;
  Json meshes = Json::array();
  std::string blobs;
  for (std::size_t m = 0; m < subjects.size(); ++m) {
    const HtmlPictures* pictures = subjects[m].pictures;
    Json defects = Json::array();
    for (const Defect& d : subjects[m].report->defects) {
      if (defects.size() == 200) break;
      const Vec3 at = place_of(d, subjects[m]);
      defects.push_back({{"at_mm", {at.x, at.y, at.z}}, {"name", "D" + std::to_string(defects.size() + 1)}});
    }
    meshes.push_back({{"name", subjects[m].name},
                      {"defects", defects},
                      {"pictures", pictures != nullptr ? Json::parse(pictures->json) : Json::object()}});
    if (pictures == nullptr) continue;
    for (const auto& [name, bytes] : pictures->blobs)
      blobs +=
          "<script type=\"text/plain\" id=\"blob-" + std::to_string(m) + "-" + name + "\">" + bytes + "</script>\n";
  }
  std::vector<std::string> colours;
  for (const LabelReport& l : first.labels) {
    colours.push_back("#999999");
    for (const Json& j : meshes[0]["pictures"].value("labels", Json::array()))
      if (j["label"] == l.label) colours.back() = j["colour"].get<std::string>();
  }
  const std::string name = input_name(first);
  std::string title = "Mesh of " + name, subtitle;
  if (first.fem) title = "Solver model of " + name;
  if (first.command == "validate")
    title = (subjects.size() > 1 ? std::to_string(subjects.size()) + " meshes" : subjects[0].name) +
            (name.empty() ? "" : " against " + name);
  const auto counted = [](std::size_t n, const char* one, const char* many) {
    return grouped(n) + " " + (n == 1 ? one : many);
  };
  subtitle = counted(first.labels.size(), "label", "labels");
  if (first.input.sections > 0) subtitle += ", " + counted(first.input.sections, "section", "sections");
  if (subjects.size() == 1 && first.surface)
    subtitle += "; " + counted(first.surface->triangles, "triangle", "triangles");
  if (subjects.size() == 1 && first.volume && first.volume->tets > 0)
    subtitle += ", " + counted(first.volume->tets, "tetrahedron", "tetrahedra");
  if (subjects.size() == 1 && first.volume && first.volume->wedges + first.volume->pyramids > 0)
    subtitle += ", " + counted(first.volume->wedges, "wedge", "wedges") + ", " +
                counted(first.volume->pyramids, "pyramid", "pyramids");
  return filled(as_utf8(page::html),
                {{"title", escaped(as_utf8("stackmesh report: " + title))},
                 {"heading", escaped(as_utf8(title))},
                 {"subtitle", escaped(as_utf8(subtitle))},
                 {"css", page::css},
                 {"verdict", as_utf8(verdict_html(subjects))},
                 {"compare_link", subjects.size() > 1 ? " <a href=\"#compare\">Comparison</a>" : ""},
                 {"compare", as_utf8(comparison_html(subjects))},
                 {"labels", as_utf8(labels_html(subjects, colours))},
                 {"model_link", first.fem ? " <a href=\"#model\">Solver model</a>" : ""},
                 {"model", as_utf8(model_html(subjects))},
                 {"defects", as_utf8(defects_html(subjects))},
                 {"provenance", as_utf8(provenance_html(subjects))},
                 {"data", for_script(Json({{"meshes", meshes}}).dump(-1, ' ', false, Json::error_handler_t::replace))},
                 {"blobs", blobs},
                 {"three", page::three_js},
                 {"orbit", page::orbit_js},
                 {"chart", page::chart_js},
                 {"script", std::string("(() => {\n") + page::data_js + page::tables_js + page::sections_js +
                                page::solid_js + page::main_js + "})();"}});
}

}  // namespace stackmesh
