#include "cohort/slurm.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/text.h"
#include "cohort/child.h"

namespace stackmesh {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

std::string first_line(const std::string& text) {
  return printable(text.substr(0, text.find('\n')));
}

/// For a script of the shell.
std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

std::uint64_t memory_class_mb(double foretold_mb) {
  constexpr double kMargin = 1.5;
  std::uint64_t mb = 512;
  while (static_cast<double>(mb) < kMargin * foretold_mb) mb *= 2;
  return mb;
}

int time_class_minutes(double foretold_s) {
  constexpr double kMargin = 4;  // nodes differ, and share their disks
  int minutes = 5;
  while (60.0 * minutes < kMargin * foretold_s) minutes *= 4;
  return minutes;
}

void write_text(const std::string& path, const std::string& text) {
  AtomicFiles files;
  files.write(path, [&](std::FILE* f) { std::fwrite(text.data(), 1, text.size(), f); });
  files.commit();
}

std::string jobs_json(const std::vector<SlurmArray>& arrays) {
  Json jobs = Json::array();
  for (const SlurmArray& a : arrays)
    jobs.push_back({{"name", a.name},
                    {"job_id", a.job_id},
                    {"memory_mb", a.memory_mb},
                    {"minutes", a.minutes},
                    {"tasks", a.tasks},
                    {"cases_per_task", a.cases_per_task},
                    {"ids", a.ids}});
  return Json{{"schema", 1}, {"arrays", jobs}}.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::size_t cases_of_a_task(const SlurmArray& a) {
  return static_cast<std::size_t>(std::max(1, a.cases_per_task));
}

}  // namespace

void check_slurm() {
  for (const char* tool : {"sbatch", "squeue", "scontrol"})
    if (output_of({tool, "--version"}).code == 127)
      fail_usage(std::string("Slurm is not here: there is no ") + tool, "--slurm",
                 "run it on a login node of the cluster, or leave --slurm out to use this machine");
  const CommandOutput ping = output_of({"scontrol", "ping"});
  if (ping.code != 0 || ping.text.find("UP") == std::string::npos)
    fail_usage("Slurm's controller does not answer: " + first_line(ping.text), "--slurm",
               "try again when 'scontrol ping' says UP, or leave --slurm out to use this machine");
}

std::vector<SlurmArray> size_classes(const std::vector<CohortCase>& cases, const std::vector<CaseLook>& looks,
                                     const SlurmOptions& options, std::size_t most_tasks) {
  const std::size_t per_task = static_cast<std::size_t>(std::max(1, options.cases_per_task));
  std::map<std::pair<std::uint64_t, int>, std::vector<std::string>> classes;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const double case_s = options.timeout_s ? *options.timeout_s * (1 + options.retries) + 60 : 0;
    const int minutes = options.timeout_s ? static_cast<int>(std::ceil(case_s * static_cast<double>(per_task) / 60))
                                          : time_class_minutes(looks[i].time_s * static_cast<double>(per_task));
    const std::uint64_t mb =
        options.case_memory_bytes > 0 ? options.case_memory_bytes >> 20 : memory_class_mb(looks[i].memory_mb);
    classes[{mb, minutes}].push_back(cases[i].id);
  }
  std::vector<SlurmArray> arrays;
  for (const auto& [size, ids] : classes)
    for (std::size_t first = 0; first < ids.size(); first += most_tasks * per_task) {
      SlurmArray a;
      a.memory_mb = size.first;
      a.minutes = size.second;
      a.ids.assign(ids.begin() + static_cast<std::ptrdiff_t>(first),
                   ids.begin() + static_cast<std::ptrdiff_t>(std::min(ids.size(), first + most_tasks * per_task)));
      a.cases_per_task = static_cast<int>(per_task);
      a.tasks = static_cast<int>((a.ids.size() + per_task - 1) / per_task);
      arrays.push_back(std::move(a));
    }
  return arrays;
}

std::size_t most_array_tasks() {
  const std::string text = output_of({"scontrol", "show", "config"}).text, key = "MaxArraySize";
  const std::size_t at = text.find(key);
  const std::size_t equal = at == std::string::npos ? at : text.find('=', at);
  const long most = equal == std::string::npos ? 0 : std::atol(text.c_str() + equal + 1);
  return most > 1 ? static_cast<std::size_t>(most - 1) : 1000;  // indices stay below it
}

std::string slurm_script(const SlurmArray& a, const CohortFolder& folder, const SlurmOptions& o) {
  const std::string base = fs::absolute(folder.own("slurm/" + a.name)).string();
  std::ostringstream s;
  s << "#!/bin/bash\n"
    << "# Written by stackmesh batch: a task for each case" << (o.cases_per_task > 1 ? " of some" : "") << ".\n"
    << "#SBATCH --job-name=stackmesh\n"
    << "#SBATCH --array=0-" << a.tasks - 1 << "\n"
    << "#SBATCH --ntasks=1\n"
    << "#SBATCH --cpus-per-task=1\n"
    << "#SBATCH --mem=" << a.memory_mb << "M\n"
    << "#SBATCH --time=" << a.minutes << "\n"
    << "#SBATCH --requeue\n"
    << "#SBATCH --open-mode=append\n"
    << "exec " << quoted(o.program) << " batch --task " << quoted(base + ".plan.json") << " --cases-per-task "
    << std::max(1, o.cases_per_task) << " -o " << quoted(fs::absolute(folder.path()).string());
  if (o.timeout_s) s << " --timeout " << *o.timeout_s;
  if (o.retries > 0) s << " --retry " << o.retries;
  if (o.failed_again) s << " --only failed";
  s << " --case-memory " << a.memory_mb << "M\n";
  return s.str();
}

std::vector<SlurmArray> submitted_arrays(const CohortFolder& folder) {
  std::ifstream file(folder.own("slurm/jobs.json"));
  std::vector<SlurmArray> arrays;
  if (!file) return arrays;
  try {
    const Json j = Json::parse(file);
    for (const Json& a : j.at("arrays"))
      arrays.push_back({a.at("name"), a.at("job_id"), a.at("memory_mb"), a.at("minutes"), a.at("tasks"),
                        a.at("cases_per_task"), a.at("ids").get<std::vector<std::string>>()});
  } catch (const std::exception&) {
    fail_input("the list of Slurm jobs is damaged", folder.own("slurm/jobs.json"),
               "remove it once none of its jobs is in the queue");
  }
  return arrays;
}

void submit(std::vector<SlurmArray>& arrays, const CohortPlan& plan, const CohortFolder& folder,
            const SlurmOptions& options) {
  const std::vector<std::string> words = shell_words(options.arguments);
  std::error_code error;
  fs::create_directories(folder.own("slurm"), error);
  std::map<std::string, const CohortCase*> by_id;
  for (const CohortCase& c : plan.cases) by_id[c.id] = &c;
  std::vector<SlurmArray> all = submitted_arrays(folder);
  for (SlurmArray& a : arrays) {
    a.name = "array-" + std::to_string(all.size() + 1);
    CohortPlan part = plan;
    part.cases.clear();
    for (const std::string& id : a.ids) part.cases.push_back(*by_id.at(id));
    write_text(folder.own("slurm/" + a.name + ".plan.json"), to_json(part));
    const std::string script = folder.own("slurm/" + a.name + ".sh");
    write_text(script, slurm_script(a, folder, options));
    std::vector<std::string> call = {"sbatch", "--parsable",
                                     "--output=" + fs::absolute(folder.own("slurm/" + a.name)).string() + "-%a.txt"};
    call.insert(call.end(), words.begin(), words.end());
    call.push_back(script);
    const CommandOutput answer = output_of(call);
    const std::string id = answer.text.substr(0, answer.text.find_first_of(";\n"));
    if (answer.code != 0 || id.empty() || id.find_first_not_of("0123456789") != std::string::npos)
      fail_usage("sbatch refuses: " + first_line(answer.text), "--slurm '" + options.arguments + "'",
                 all.empty() ? "mend the options of sbatch"
                             : "mend the options of sbatch; what was submitted before runs, see batch --status");
    a.job_id = id;
    all.push_back(a);
    write_text(folder.own("slurm/jobs.json"), jobs_json(all));
    for (const std::string& one : a.ids) folder.note("submitted to Slurm as " + id, one, "");
  }
}

std::map<std::string, std::string> queued_cases(const CohortFolder& folder) {
  const std::vector<SlurmArray> arrays = submitted_arrays(folder);
  std::map<std::string, std::string> states;
  if (arrays.empty()) return states;
  std::map<std::string, const SlurmArray*> by_job;
  for (const SlurmArray& a : arrays) by_job[a.job_id] = &a;
  const CommandOutput queue =
      output_of({"squeue", "--noheader", "--array", "--me", "--states=all", "--format=%F %K %T %r"});
  if (queue.code != 0)
    fail_usage("Slurm's queue cannot be read: " + first_line(queue.text), "squeue",
               "try again when the controller answers");
  std::istringstream lines(queue.text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream parts(line);
    std::string job, state, why;
    std::size_t task = 0;
    if (!(parts >> job >> task >> state) || by_job.count(job) == 0) continue;
    std::getline(parts >> std::ws, why);
    static const std::set<std::string> in_queue = {"PENDING",   "RUNNING",  "CONFIGURING",  "COMPLETING",
                                                   "SUSPENDED", "REQUEUED", "REQUEUE_HOLD", "REQUEUE_FED",
                                                   "RESIZING",  "STOPPED",  "SPECIAL_EXIT"};
    if (in_queue.count(state) == 0) continue;
    const SlurmArray& a = *by_job[job];
    const std::size_t per_task = cases_of_a_task(a);
    for (std::size_t i = task * per_task; i < std::min(a.ids.size(), (task + 1) * per_task); ++i)
      states[a.ids[i]] = state == "PENDING" ? state + ": " + printable(why) : state;
  }
  return states;
}

std::string last_words(const CohortFolder& folder, const std::string& id) {
  std::string words;
  for (const SlurmArray& a : submitted_arrays(folder)) {
    const auto at = std::find(a.ids.begin(), a.ids.end(), id);
    if (at == a.ids.end()) continue;
    const std::size_t task = static_cast<std::size_t>(at - a.ids.begin()) / cases_of_a_task(a);
    std::ifstream file(folder.own("slurm/" + a.name + "-" + std::to_string(task) + ".txt"));
    for (std::string line; std::getline(file, line);)
      if (line.find("slurmstepd:") != std::string::npos || line.rfind("stackmesh: error: ", 0) == 0)
        words = printable(line);
  }
  return words;
}

std::vector<std::string> shell_words(const std::string& text) {
  std::vector<std::string> words;
  std::string word;
  bool inside = false;
  char quote = 0;
  for (const char c : text) {
    if (quote != 0) {
      if (c == quote) quote = 0;
      else word += c;
    } else if (c == '\'' || c == '"') {
      quote = c;
      inside = true;
    } else if (c == ' ' || c == '\t' || c == '\n') {
      if (inside || !word.empty()) words.push_back(word);
      word.clear();
      inside = false;
    } else {
      word += c;
    }
  }
  if (quote != 0) fail_usage("a quote is not closed", "'" + text + "'", "close it");
  if (inside || !word.empty()) words.push_back(word);
  return words;
}

}  // namespace stackmesh
