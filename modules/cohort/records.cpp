// The records of a cohort as JSON.
#include <nlohmann/json.hpp>

#include "cohort/cohort_folder.h"

namespace stackmesh {
namespace {

using Json = nlohmann::ordered_json;

/// Paths need not be UTF-8: what is not is replaced, in records only.
std::string text_of(const Json& json) {
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace

std::string to_json(const CaseRecord& r) {
  return text_of({{"schema", 1},
                  {"id", r.id},
                  {"key", r.key},
                  {"state", r.is_done ? "done" : "failed"},
                  {"exit_code", r.exit_code},
                  {"reason", r.reason},
                  {"stackmesh", r.version},
                  {"command", r.command},
                  {"inputs", r.inputs},
                  {"options", r.options},
                  {"input_sha256", r.input_sha256},
                  {"wall_s", r.wall_s},
                  {"cpu_s", r.cpu_s},
                  {"peak_rss_mb", r.peak_mb},
                  {"foretold_s", r.foretold_s},
                  {"foretold_mb", r.foretold_mb},
                  {"tries", r.tries},
                  {"host", r.host},
                  {"finished_utc", r.finished_utc}});
}

CaseRecord case_record_of(const std::string& json) {
  const Json j = Json::parse(json);
  CaseRecord r;
  r.id = j.at("id");
  r.key = j.at("key");
  r.is_done = j.at("state") == "done";
  r.exit_code = j.at("exit_code");
  r.reason = j.at("reason");
  r.version = j.at("stackmesh");
  r.command = j.at("command");
  r.inputs = j.at("inputs").get<std::vector<std::string>>();
  r.options = j.at("options").get<std::vector<std::string>>();
  r.input_sha256 = j.at("input_sha256");
  r.wall_s = j.at("wall_s");
  r.cpu_s = j.at("cpu_s");
  r.peak_mb = j.at("peak_rss_mb");
  r.foretold_s = j.at("foretold_s");
  r.foretold_mb = j.at("foretold_mb");
  r.tries = j.at("tries");
  r.host = j.at("host");
  r.finished_utc = j.at("finished_utc");
  return r;
}

std::string to_json(const CohortPlan& plan) {
  Json cases = Json::array();
  for (const CohortCase& c : plan.cases) {
    Json options = Json::array();
    for (const OptionValue& o : c.options) options.push_back({{"name", o.name}, {"values", o.values}});
    cases.push_back({{"id", c.id}, {"inputs", c.inputs}, {"options", options}});
  }
  return text_of({{"schema", 1},
                  {"source", plan.source},
                  {"source_sha256", plan.source_sha256},
                  {"stackmesh", plan.version},
                  {"command", plan.command},
                  {"formats", plan.formats},
                  {"cases", cases}});
}

CohortPlan cohort_plan_of(const std::string& json) {
  const Json j = Json::parse(json);
  CohortPlan plan;
  plan.source = j.at("source");
  plan.source_sha256 = j.at("source_sha256");
  plan.version = j.at("stackmesh");
  plan.command = j.at("command");
  plan.formats = j.at("formats").get<std::vector<std::string>>();
  for (const Json& c : j.at("cases")) {
    CohortCase one;
    one.id = c.at("id");
    one.inputs = c.at("inputs").get<std::vector<std::string>>();
    for (const Json& o : c.at("options"))
      one.options.push_back({o.at("name"), o.at("values").get<std::vector<std::string>>()});
    plan.cases.push_back(one);
  }
  return plan;
}

}  // namespace stackmesh
