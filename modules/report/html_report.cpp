#include "report/html_report.h"

#include <map>
#include <nlohmann/json.hpp>

#include "report/page_files.h"
#include "report/page_text.h"

namespace stackmesh {
namespace {

using Json = nlohmann::ordered_json;

/// JSON that may stand in a script element: nothing in it can end the element.
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

/// Replaces each {{name}} of the page once; what is put in is not looked at again.
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

std::string base_name(const std::string& path) {
  const std::size_t end = path.find_last_not_of('/');
  if (end == std::string::npos) return path;
  const std::size_t slash = path.rfind('/', end);
  return path.substr(slash == std::string::npos ? 0 : slash + 1, end - (slash == std::string::npos ? 0 : slash + 1) + 1);
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
    meshes.push_back({{"name", subjects[m].name}, {"pictures", pictures != nullptr ? Json::parse(pictures->json) : Json::object()}});
    if (pictures == nullptr) continue;
    for (const auto& [name, bytes] : pictures->blobs)
      blobs += "<script type=\"text/plain\" id=\"blob-" + std::to_string(m) + "-" + name + "\">" + bytes + "</script>\n";
  }
  std::vector<std::string> colours;
  for (const LabelReport& l : first.labels) {
    colours.push_back("#999999");
    for (const Json& j : meshes[0]["pictures"].value("labels", Json::array()))
      if (j["label"] == l.label) colours.back() = j["colour"].get<std::string>();
  }
  const std::string name = base_name(first.input.path);
  const std::size_t tets = first.volume ? first.volume->tets : 0, triangles = first.surface ? first.surface->triangles : 0;
  std::string subtitle = std::to_string(first.labels.size()) + (first.labels.size() == 1 ? " label, " : " labels, ") + std::to_string(first.input.sections) +
                         " sections; " + std::to_string(triangles) + " triangles";
  subtitle += tets > 0 ? ", " + std::to_string(tets) + " tetrahedra" : "";
  return filled(as_utf8(page::html),
                {{"title", escaped(as_utf8("stackmesh report: " + name))},
                 {"heading", escaped(as_utf8(subjects.size() > 1 ? std::to_string(subjects.size()) + " meshes against " + name : "Mesh of " + name))},
                 {"subtitle", escaped(as_utf8(subtitle))},
                 {"css", page::css},
                 {"verdict", as_utf8(verdict_html(first))},
                 {"compare_link", subjects.size() > 1 ? " <a href=\"#compare\">Comparison</a>" : ""},
                 {"compare", as_utf8(comparison_html(subjects))},
                 {"labels", as_utf8(labels_html(first, colours))},
                 {"defects", ""},
                 {"provenance", as_utf8(provenance_html(first))},
                 {"data", for_script(Json({{"meshes", meshes}}).dump(-1, ' ', false, Json::error_handler_t::replace))},
                 {"blobs", blobs},
                 {"three", page::three_js},
                 {"orbit", page::orbit_js},
                 {"chart", page::chart_js},
                 {"script", std::string("(() => {\n") + page::data_js + page::tables_js + page::sections_js + page::solid_js + page::main_js + "})();"}});
}

}  // namespace stackmesh
