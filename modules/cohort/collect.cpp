#include "cohort/collect.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/parallel.h"
#include "base/text.h"
#include "cohort/thumbnail.h"
#include "meshio/read_mesh.h"
#include "report/label_colours.h"

namespace stackmesh {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

double number(const Json& j, const char* name) {
  const auto at = j.find(name);
  return at != j.end() && at->is_number() ? at->get<double>() : kNone;
}

double number(const Json& j, const char* group, const char* name) {
  const auto at = j.find(group);
  return at != j.end() && at->is_object() ? number(*at, name) : kNone;
}

/// Reads what a case's report says, into its row and the cohort's labels.
class ReportReader {
 public:
  ReportReader(const Json& report, CohortRow& row, std::map<int, CohortLabel>& labels)
      : r_(report), row_(row), labels_(labels) {}

  void read() {
    const std::vector<Metric>& metrics = cohort_metrics();
    row_.verdict = "pass";
    for (const Json& v : r_.at("verdicts")) {
      const std::string status = v.at("status"),
                        text = v.at("title").get<std::string>() + ": " + v.at("figure").get<std::string>();
      if (status == "fail") row_.outside.push_back(text);
      if (status == "warn") row_.warned.push_back(text);
    }
    if (!row_.warned.empty()) row_.verdict = "warn";
    if (!row_.outside.empty()) row_.verdict = "fail";
    row_.figures.assign(metrics.size(), kNone);
    for (std::size_t m = 0; m < metrics.size(); ++m)
      if (!metrics[m].per_label) row_.figures[m] = figure_of_case(metrics[m].id);
    for (const Json& l : r_.at("labels")) {
      const int label = l.at("label");
      std::vector<double>& figures = row_.labels[label];
      figures.assign(metrics.size(), kNone);
      for (std::size_t m = 0; m < metrics.size(); ++m)
        if (metrics[m].per_label) figures[m] = figure_of_label(l, metrics[m].id);
      CohortLabel& known = labels_[label];
      if (known.name.empty()) known.name = l.at("name");
      if (!known.own_colour && l.at("colour").is_array())
        known.own_colour = l.at("colour").get<std::array<std::uint8_t, 3>>();
    }
  }

 private:
  double figure_of_case(const std::string& id) const {
    if (id == "wall_s") return row_.record.wall_s;
    if (id == "peak_rss_mb") return row_.record.peak_mb;
    return number(r_, "volume", id.c_str());
  }

  static double figure_of_label(const Json& l, const std::string& id) {
    double volume = number(l, "tet_volume_mm3");
    if (std::isnan(volume)) volume = number(l, "surface_volume_mm3");
    if (id == "volume_mm3") return volume;
    if (id == "volume_error_rel") return std::abs(volume / number(l, "input_volume_mm3") - 1);
    if (id == "band_mean_mm") return number(l, "band_distance_mm", "mean");
    return number(l, id.c_str());
  }

  const Json& r_;
  CohortRow& row_;
  std::map<int, CohortLabel>& labels_;
};

std::string mesh_of(const std::string& folder, const std::vector<std::string>& formats) {
  std::error_code ignored;
  for (const std::string& format : formats)
    if (is_readable_mesh("mesh." + format) && fs::exists(folder + "/mesh." + format, ignored)) return "mesh." + format;
  return "";
}

void read_done(const CohortFolder& folder, const CohortPlan& plan, const CohortCase& c, CohortRow& row,
               std::map<int, CohortLabel>& labels) {
  row.state = CohortRow::State::done;
  if (row.record.options != words_of(c.options) || row.record.version != plan.version ||
      row.record.command != plan.command) {
    row.state = CohortRow::State::changed;
    row.reason = "made with other options or another version than the manifest now says; run the batch again";
    return;
  }
  const std::string path = folder.case_folder(row.id) + "/report.json";
  try {
    std::ifstream file(path, std::ios::binary);
    const Json report = Json::parse(file);
    ReportReader(report, row, labels).read();
  } catch (const std::exception&) {
    row.state = CohortRow::State::failed;
    row.reason = "its report cannot be read, " + path + "; remove the case's folder and run the batch again";
  }
  row.mesh = mesh_of(folder.case_folder(row.id), plan.formats);
}

CohortRow read_row(const CohortFolder& folder, const CohortPlan& plan, const CohortCase& c,
                   std::map<int, CohortLabel>& labels) {
  CohortRow row;
  row.id = c.id;
  if (const auto failed = folder.record(c.id, true)) {
    row.state = CohortRow::State::failed;
    row.record = *failed;
    row.reason = failed->reason;
  } else if (const auto done = folder.record(c.id)) {
    row.record = *done;
    read_done(folder, plan, c, row, labels);
  } else {
    row.reason = "has not run, or not to its end";
  }
  return row;
}

std::string figure_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

std::string label_text(int label, const CohortLabel& known) {
  return "label " + std::to_string(label) + (known.name.empty() ? "" : " (" + known.name + ")");
}

/// Compares the cases that are done with one another.
void compare(Cohort& cohort) {
  std::map<std::pair<std::size_t, int>, Distribution> found;
  const std::vector<Metric>& metrics = cohort_metrics();
  const auto add = [&](std::size_t m, int label, std::size_t row, double value) {
    if (!std::isfinite(value)) return;
    Distribution& d = found[{m, label}];
    d.metric = m;
    d.label = label;
    d.cases.push_back(row);
    d.values.push_back(value);
  };
  for (std::size_t i = 0; i < cohort.rows.size(); ++i) {
    const CohortRow& row = cohort.rows[i];
    for (std::size_t m = 0; m < row.figures.size(); ++m) add(m, 0, i, row.figures[m]);
    for (const auto& [label, figures] : row.labels)
      for (std::size_t m = 0; m < figures.size(); ++m) add(m, label, i, figures[m]);
  }
  std::vector<std::vector<std::pair<double, std::string>>> texts(cohort.rows.size());
  for (auto& [key, d] : found) {
    judge_distribution(d);
    const Metric& metric = metrics[d.metric];
    for (std::size_t i = 0; i < d.values.size(); ++i) {
      if (d.scores[i] <= kOutlierScore) continue;
      std::string text = (metric.per_label ? label_text(d.label, cohort.labels[d.label]) + ": " : std::string()) +
                         lower_case(metric.title.substr(0, 1)) + metric.title.substr(1) + " " +
                         figure_text(d.values[i]) + (metric.unit.empty() ? "" : " " + metric.unit) + ", median " +
                         figure_text(d.median);
      texts[d.cases[i]].emplace_back(d.scores[i], std::move(text));
    }
    cohort.distributions.push_back(std::move(d));
  }
  for (std::size_t i = 0; i < cohort.rows.size(); ++i) {
    std::stable_sort(texts[i].begin(), texts[i].end(), [](const auto& a, const auto& b) { return a.first > b.first; });
    for (auto& [score, text] : texts[i]) {
      cohort.rows[i].score = std::max(cohort.rows[i].score, score);
      cohort.rows[i].remarkable.push_back(std::move(text));
    }
  }
}

/// Labels that nearly all cases have are missed where they are not.
void find_absent_labels(Cohort& cohort) {
  constexpr double kNearlyAll = 0.8, kScore = 10;
  std::map<int, std::size_t> count;
  std::size_t done = 0;
  for (const CohortRow& row : cohort.rows) {
    done += row.labels.empty() ? 0 : 1;
    for (const auto& [label, figures] : row.labels) ++count[label];
  }
  if (done < kFewestValues) return;
  for (CohortRow& row : cohort.rows)
    for (const auto& [label, n] : count)
      if (!row.labels.empty() && row.labels.count(label) == 0 &&
          static_cast<double>(n) >= kNearlyAll * static_cast<double>(done)) {
        row.remarkable.insert(row.remarkable.begin(), label_text(label, cohort.labels[label]) + " is missing, " +
                                                          std::to_string(n) + " of " + std::to_string(done) +
                                                          " cases have it");
        row.score = std::max(row.score, kScore);
      }
}

int rank(const CohortRow& row) {
  if (row.state == CohortRow::State::failed) return 0;
  if (row.state != CohortRow::State::done) return 1;
  return row.is_outside() ? 2 : row.is_outlier() ? 3 : 4;
}

/// Failures and outliers first; the places in distributions follow.
void put_in_order(Cohort& cohort) {
  std::vector<std::size_t> order(cohort.rows.size()), place(cohort.rows.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    const CohortRow &p = cohort.rows[a], &q = cohort.rows[b];
    if (rank(p) != rank(q)) return rank(p) < rank(q);
    return rank(p) == 2 || rank(p) == 3 ? p.score > q.score : false;
  });
  std::vector<CohortRow> rows;
  for (std::size_t i = 0; i < order.size(); ++i) {
    place[order[i]] = i;
    rows.push_back(std::move(cohort.rows[order[i]]));
  }
  cohort.rows = std::move(rows);
  for (Distribution& d : cohort.distributions)
    for (std::size_t& c : d.cases) c = place[c];
}

void choose_colours(std::map<int, CohortLabel>& labels) {
  std::vector<LabelInfo> list = {{0, ""}};
  for (const auto& [label, known] : labels) list.push_back({label, known.name, known.own_colour});
  const std::vector<std::string> colours = label_colours(list);
  std::size_t k = 0;
  for (auto& [label, known] : labels) known.colour = colours[++k];
}

/// A picture of each mesh that has none yet; those of former results go.
void draw_missing(const CohortFolder& folder, Cohort& cohort, int threads) {
  std::error_code error;
  const std::string pictures = folder.path() + "/" + kThumbnailFolder;
  fs::create_directories(pictures, error);
  if (error) fail_output("cannot write: " + error.message(), pictures, "check the rights and the free space");
  std::set<std::string> wanted;
  for (CohortRow& row : cohort.rows) {
    if (row.mesh.empty()) continue;
    const std::string name = row.id + "." + row.record.key.substr(0, 12) + ".png";
    row.picture = std::string(kThumbnailFolder) + "/" + name;
    wanted.insert(name);
  }
  parallel_for(cohort.rows.size(), threads, [&](std::size_t i) {
    CohortRow& row = cohort.rows[i];
    std::error_code ignored;
    if (row.picture.empty() || fs::exists(folder.path() + "/" + row.picture, ignored)) return;
    try {
      const std::string png = draw_thumbnail(folder.case_folder(row.id) + "/" + row.mesh, cohort.labels);
      AtomicFiles files;
      files.write(folder.path() + "/" + row.picture, [&](std::FILE* f) { std::fwrite(png.data(), 1, png.size(), f); });
      files.commit();
    } catch (const Error& e) {
      if (e.kind() == ErrorKind::output) throw;
      row.picture.clear();  // its mesh cannot be read back: the page says that there is no picture
    }
  });
  for (const auto& entry : fs::directory_iterator(pictures, error))
    if (ends_with(entry.path().string(), ".png") && wanted.count(entry.path().filename().string()) == 0)
      fs::remove(entry.path(), error);
}

}  // namespace

std::size_t Cohort::count(CohortRow::State state) const {
  return static_cast<std::size_t>(
      std::count_if(rows.begin(), rows.end(), [&](const CohortRow& r) { return r.state == state; }));
}

std::size_t Cohort::outside() const {
  return static_cast<std::size_t>(
      std::count_if(rows.begin(), rows.end(), [](const CohortRow& r) { return r.is_outside(); }));
}

std::size_t Cohort::outliers() const {
  return static_cast<std::size_t>(
      std::count_if(rows.begin(), rows.end(), [](const CohortRow& r) { return r.is_outlier(); }));
}

int Cohort::exit_code() const {
  if (count(CohortRow::State::done) < rows.size()) return static_cast<int>(ErrorKind::no_result);
  return outside() > 0 ? static_cast<int>(ErrorKind::outside_limits) : 0;
}

const char* to_text(CohortRow::State state) {
  switch (state) {
    case CohortRow::State::done:
      return "done";
    case CohortRow::State::failed:
      return "failed";
    case CohortRow::State::changed:
      return "changed";
    case CohortRow::State::missing:
      return "missing";
  }
  return "";
}

Cohort read_cohort(const CohortFolder& folder) {
  const std::optional<CohortPlan> plan = folder.plan();
  if (!plan)
    fail_input("the folder holds no cohort: there is no .cohort/plan.json", folder.path(),
               "name the folder that stackmesh batch wrote with -o");
  Cohort cohort;
  cohort.source = plan->source;
  cohort.version = plan->version;
  cohort.command = plan->command;
  for (const CohortCase& c : plan->cases) cohort.rows.push_back(read_row(folder, *plan, c, cohort.labels));
  choose_colours(cohort.labels);
  compare(cohort);
  find_absent_labels(cohort);
  put_in_order(cohort);
  return cohort;
}

Cohort collect(const CohortFolder& folder, const CollectOptions& options) {
  Cohort cohort = read_cohort(folder);
  if (options.pictures) draw_missing(folder, cohort, options.threads);
  AtomicFiles files;
  const std::pair<const char*, std::string> written[] = {{"/cohort.csv", cohort_csv(cohort)},
                                                         {"/cohort.json", cohort_json(cohort)},
                                                         {"/cohort.html", cohort_html(cohort)}};
  for (const auto& [name, text] : written)
    files.write(folder.path() + name, [&bytes = text](std::FILE* f) { std::fwrite(bytes.data(), 1, bytes.size(), f); });
  files.commit();
  return cohort;
}

}  // namespace stackmesh
