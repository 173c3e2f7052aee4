// The cohort as tables for other programs.
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "base/text.h"
#include "cohort/collect.h"
#include "cohort/table.h"

namespace stackmesh {
namespace {

using Json = nlohmann::ordered_json;

std::string number_text(double value) {
  if (!std::isfinite(value)) return "";
  char text[40];
  std::snprintf(text, sizeof text, "%.9g", value);
  return text;
}

std::string joined(const std::vector<std::string>& parts) {
  std::string text;
  for (const std::string& p : parts) text += (text.empty() ? "" : "; ") + p;
  return text;
}

std::string report_of(const CohortRow& row) {
  return row.state == CohortRow::State::failed    ? row.id + kFailedEnding + "/log.txt"
         : row.state == CohortRow::State::missing ? ""
                                                  : row.id + "/report.html";
}

Json figures_json(const std::vector<double>& figures, bool per_label) {
  Json j = Json::object();
  const std::vector<Metric>& metrics = cohort_metrics();
  for (std::size_t m = 0; m < figures.size(); ++m)
    if (metrics[m].per_label == per_label)
      j[metrics[m].id] = std::isfinite(figures[m]) ? Json(figures[m]) : Json(nullptr);
  return j;
}

}  // namespace

std::string cohort_csv(const Cohort& cohort) {
  const std::vector<Metric>& metrics = cohort_metrics();
  std::string text = "id,state,exit_code,reason,verdict,outside,outlier_score,outlier,tries,key,report";
  for (const Metric& m : metrics)
    if (!m.per_label) text += "," + m.id;
  text += ",label,name";
  for (const Metric& m : metrics)
    if (m.per_label) text += "," + m.id;
  text += "\n";
  for (const CohortRow& row : cohort.rows) {
    std::string start;
    for (const std::string& cell :
         {row.id, std::string(to_text(row.state)), std::to_string(row.record.exit_code), row.reason, row.verdict,
          joined(row.outside), number_text(row.score), joined(row.remarkable), std::to_string(row.record.tries),
          row.record.key, report_of(row)})
      start += (start.empty() ? "" : ",") + csv_cell(printable(cell));
    for (std::size_t m = 0; m < metrics.size(); ++m)
      if (!metrics[m].per_label) start += "," + (m < row.figures.size() ? number_text(row.figures[m]) : std::string());
    const auto add = [&](const std::string& label, const std::string& name, const std::vector<double>& figures) {
      text += start + "," + label + "," + csv_cell(printable(name));
      for (std::size_t m = 0; m < metrics.size(); ++m)
        if (metrics[m].per_label) text += "," + (m < figures.size() ? number_text(figures[m]) : std::string());
      text += "\n";
    };
    if (row.labels.empty()) add("", "", {});
    for (const auto& [label, figures] : row.labels) add(std::to_string(label), cohort.labels.at(label).name, figures);
  }
  return text;
}

std::string cohort_json(const Cohort& cohort) {
  Json cases = Json::array(), distributions = Json::array();
  for (const CohortRow& row : cohort.rows) {
    Json labels = Json::array();
    for (const auto& [label, figures] : row.labels) {
      Json one = {{"label", label}, {"name", cohort.labels.at(label).name}};
      one.update(figures_json(figures, true));
      labels.push_back(one);
    }
    cases.push_back({{"id", row.id},
                     {"state", to_text(row.state)},
                     {"exit_code", row.record.exit_code},
                     {"reason", row.reason},
                     {"verdict", row.verdict},
                     {"outside", row.outside},
                     {"warned", row.warned},
                     {"outlier", row.is_outlier()},
                     {"outlier_score", row.score},
                     {"remarkable", row.remarkable},
                     {"key", row.record.key},
                     {"inputs", row.record.inputs},
                     {"options", row.record.options},
                     {"input_sha256", row.record.input_sha256},
                     {"tries", row.record.tries},
                     {"host", row.record.host},
                     {"finished_utc", row.record.finished_utc},
                     {"report", report_of(row)},
                     {"picture", row.picture},
                     {"figures", figures_json(row.figures, false)},
                     {"labels", labels}});
  }
  for (const Distribution& d : cohort.distributions)
    distributions.push_back({{"figure", cohort_metrics()[d.metric].id},
                             {"label", d.label == 0 ? Json(nullptr) : Json(d.label)},
                             {"cases", d.values.size()},
                             {"low", d.low},
                             {"q1", d.q1},
                             {"median", d.median},
                             {"q3", d.q3},
                             {"high", d.high}});
  const Json j = {{"schema", 1},
                  {"stackmesh", cohort.version},
                  {"command", cohort.command},
                  {"source", cohort.source},
                  {"counts",
                   {{"cases", cohort.rows.size()},
                    {"done", cohort.count(CohortRow::State::done)},
                    {"failed", cohort.count(CohortRow::State::failed)},
                    {"changed", cohort.count(CohortRow::State::changed)},
                    {"missing", cohort.count(CohortRow::State::missing)},
                    {"outside_limits", cohort.outside()},
                    {"outliers", cohort.outliers()}}},
                  {"exit_code", cohort.exit_code()},
                  {"cases", cases},
                  {"distributions", distributions}};
  return j.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace stackmesh
