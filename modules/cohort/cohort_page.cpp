// The cohort as a page: tables in plain HTML, distributions by Chart.js.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>

#include "base/text.h"
#include "cohort/collect.h"
#include "cohort/page_files.h"
#include "report/html_text.h"
#include "report/page_files.h"

namespace stackmesh {
namespace {

using Json = nlohmann::ordered_json;
constexpr std::size_t kMostPoints = 300;  // of one distribution that are drawn, beside all outliers; the box is of all

std::string as_utf8(const std::string& text) {
  return Json::parse(Json(text).dump(-1, ' ', false, Json::error_handler_t::replace)).get<std::string>();
}

std::string html(const std::string& text) {
  return escaped(as_utf8(printable(text)));
}

/// A path as the address of a link.
std::string address(const std::string& path) {
  std::string out;
  for (const unsigned char c : path) {
    const bool plain = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '/' ||
                       c == '-' || c == '_' || c == '.';
    char hex[4];
    std::snprintf(hex, sizeof hex, "%%%02X", c);
    out += plain ? std::string(1, static_cast<char>(c)) : std::string(hex);
  }
  return out;
}

std::string figure(double value, int digits = 4) {
  if (!std::isfinite(value)) return "";
  char text[32];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

double worst_of(const CohortRow& row, const std::string& id, bool largest) {
  const std::vector<Metric>& metrics = cohort_metrics();
  double worst = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t m = 0; m < metrics.size(); ++m) {
    if (metrics[m].id != id) continue;
    if (!metrics[m].per_label && m < row.figures.size()) worst = row.figures[m];
    for (const auto& [label, figures] : row.labels)
      if (metrics[m].per_label && std::isfinite(figures[m]) &&
          (!std::isfinite(worst) || (largest ? figures[m] > worst : figures[m] < worst)))
        worst = figures[m];
  }
  return worst;
}

std::string badge(const std::string& kind, const std::string& word) {
  return "<span class=\"badge " + kind + "\">" + word + "</span>";
}

std::string state_badge(const CohortRow& row) {
  if (row.state != CohortRow::State::done)
    return badge(row.state == CohortRow::State::failed ? "fail" : "none", to_text(row.state));
  if (row.is_outside()) return badge("fail", "outside limits");
  if (row.is_outlier()) return badge("warn", "outlier");
  return row.verdict == "warn" ? badge("warn", "warnings") : badge("pass", "pass");
}

std::string list_of(const std::vector<std::string>& texts, std::size_t most) {
  std::string out;
  for (std::size_t i = 0; i < std::min(most, texts.size()); ++i) out += (i > 0 ? "<br>" : "") + html(texts[i]);
  if (texts.size() > most) out += "<br>and " + std::to_string(texts.size() - most) + " more";
  return out;
}

std::string banner_html(const Cohort& c) {
  const std::size_t done = c.count(CohortRow::State::done), without = c.rows.size() - done;
  const std::string kind = without > 0 || c.outside() > 0 ? "fail" : c.outliers() > 0 ? "warn" : "pass";
  const std::string word = without > 0       ? std::to_string(without) + " without a result"
                           : c.outside() > 0 ? std::to_string(c.outside()) + " outside limits"
                                             : "ALL DONE";
  const auto counted = [](std::size_t n, const std::string& what) { return grouped(n) + " " + what; };
  std::string text = counted(c.rows.size(), c.rows.size() == 1 ? "case" : "cases") + ": " +
                     counted(done, "done and verified") + ", " + counted(c.count(CohortRow::State::failed), "failed") +
                     ", " + counted(c.count(CohortRow::State::missing), "not run") + ", " +
                     counted(c.count(CohortRow::State::changed), "made with other options") + ". Of those done, " +
                     counted(c.outside(), "outside their limits and ") +
                     counted(c.outliers(), "outliers among the others.");
  return "<div class=\"banner " + kind + "\"><span class=\"word\">" + word + "</span><p class=\"why\">" + text +
         "</p></div>\n";
}

std::string failures_html(const Cohort& c) {
  std::string rows;
  for (const CohortRow& row : c.rows) {
    if (row.state == CohortRow::State::done) continue;
    const bool failed = row.state == CohortRow::State::failed && !row.record.is_done;
    rows += "<tr><th scope=\"row\" class=\"text\">" + html(row.id) + "</th><td class=\"text\">" + state_badge(row) +
            "</td><td class=\"text\">" + html(row.reason) + "</td><td>" +
            (failed ? std::to_string(row.record.exit_code) : "") + "</td><td>" +
            (failed ? std::to_string(row.record.tries) : "") + "</td><td class=\"text\">" +
            (failed ? "<a href=\"" + address(row.id + kFailedEnding + "/log.txt") + "\">log</a>" : "") + "</td></tr>\n";
  }
  if (rows.empty()) return "<p>Every case has a result.</p>\n";
  return "<div class=\"table tall prose\"><table id=\"failed\"><thead><tr><th scope=\"col\" "
         "class=\"text\">case</th><th scope=\"col\" class=\"text\">state</th><th scope=\"col\" "
         "class=\"text\">why</th><th scope=\"col\">exit code</th><th scope=\"col\">tries</th><th scope=\"col\" "
         "class=\"text\"></th></tr></thead><tbody>\n" +
         rows + "</tbody></table></div>\n";
}

std::string case_html(const CohortRow& row, std::size_t place) {
  const std::string link = address(row.id + "/report.html");
  std::string why = list_of(row.outside, 3);
  if (!row.remarkable.empty()) why += (why.empty() ? "" : "<br>") + list_of(row.remarkable, 3);
  if (why.empty() && !row.warned.empty()) why = list_of(row.warned, 2);
  const std::string picture =
      row.picture.empty() ? "<span class=\"dim\">no picture</span>"
                          : "<a href=\"" + link + "\"><img loading=\"lazy\" width=\"96\" height=\"72\" alt=\"Mesh of " +
                                html(row.id) + "\" src=\"" + address(row.picture) + "\"></a>";
  std::string out = "<tr id=\"case-" + std::to_string(place) + "\" data-state=\"" +
                    (row.is_outside()   ? "outside"
                     : row.is_outlier() ? "outlier"
                                        : "other") +
                    "\"><td class=\"picture\">" + picture + "</td><th scope=\"row\" class=\"text\"><a href=\"" + link +
                    "\">" + html(row.id) + "</a></th><td class=\"text\">" + state_badge(row) +
                    "</td><td class=\"text why\">" + why + "</td>";
  for (const double value :
       {row.score, worst_of(row, "tets", true), worst_of(row, "dihedral_min_deg", false), worst_of(row, "dice", false),
        worst_of(row, "volume_error_rel", true), worst_of(row, "wall_s", true), worst_of(row, "peak_rss_mb", true)})
    out += "<td>" + figure(value, value >= 1000 ? 6 : 3) + "</td>";
  return out + "</tr>\n";
}

std::string cases_html(const Cohort& c) {
  std::string out;
  for (std::size_t i = 0; i < c.rows.size(); ++i)
    if (c.rows[i].state == CohortRow::State::done) out += case_html(c.rows[i], i);
  return out;
}

Json rounded(double value) {
  return std::isfinite(value) ? Json::parse(figure(value, 5)) : Json(nullptr);
}

/// Points of a distribution: every outlier, and of the others evenly as many as can be told apart.
Json points_json(const Distribution& d) {
  Json points = Json::array();
  const std::size_t step = (d.values.size() + kMostPoints - 1) / kMostPoints;
  for (std::size_t i = 0; i < d.values.size(); ++i) {
    const bool outlier = d.scores[i] > kOutlierScore;
    if (outlier || i % std::max<std::size_t>(1, step) == 0)
      points.push_back({d.cases[i], rounded(d.values[i]), outlier ? 1 : 0});
  }
  return points;
}

std::string data_json(const Cohort& c) {
  Json metrics = Json::array(), labels = Json::array(), ids = Json::array(), distributions = Json::array();
  for (const Metric& m : cohort_metrics())
    metrics.push_back({{"id", m.id},
                       {"title", m.title},
                       {"unit", m.unit},
                       {"per_label", m.per_label},
                       {"logarithmic", m.logarithmic}});
  for (const auto& [label, known] : c.labels)
    labels.push_back({{"label", label}, {"name", printable(known.name)}, {"colour", known.colour}});
  for (const CohortRow& row : c.rows) ids.push_back(row.id);
  for (const Distribution& d : c.distributions)
    distributions.push_back(
        {{"metric", d.metric},
         {"label", d.label},
         {"n", d.values.size()},
         {"box", {rounded(d.low), rounded(d.q1), rounded(d.median), rounded(d.q3), rounded(d.high)}},
         {"points", points_json(d)}});
  return Json{{"metrics", metrics}, {"labels", labels}, {"ids", ids}, {"distributions", distributions}}.dump(
      -1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

std::string cohort_html(const Cohort& c) {
  const std::size_t slash = c.source.find_last_of('/');
  const std::string name = slash == std::string::npos ? c.source : c.source.substr(slash + 1);
  return filled(page::cohort_html,
                {{"title", html("stackmesh cohort: " + name)},
                 {"heading", html("Cohort of " + name)},
                 {"subtitle", html(grouped(c.rows.size()) + (c.rows.size() == 1 ? " case, " : " cases, ") +
                                   std::to_string(c.labels.size()) + (c.labels.size() == 1 ? " label" : " labels") +
                                   "; stackmesh " + c.command + " " + c.version)},
                 {"css", std::string(page::css) + page::cohort_css},
                 {"banner", banner_html(c)},
                 {"failures", failures_html(c)},
                 {"cases", cases_html(c)},
                 {"data", for_script(data_json(c))},
                 {"chart", page::chart_js},
                 {"script", page::cohort_js}});
}

}  // namespace stackmesh
