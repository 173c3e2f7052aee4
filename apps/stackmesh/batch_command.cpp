#include <signal.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "base/error.h"
#include "base/memory.h"
#include "base/sha256.h"
#include "base/text.h"
#include "case_options.h"
#include "cohort/collect.h"
#include "cohort/manifest.h"
#include "cohort/run_cases.h"
#include "cohort/slurm.h"
#include "commands.h"
#include "meshio/write_mesh.h"
#include "options.h"

namespace stackmesh::app {
namespace {

namespace fs = std::filesystem;

struct BatchArguments {
  std::string manifest, inputs, folder, formats, only, memory, case_memory, slurm, task;
  int jobs = 0, retries = 0, cases_per_task = 1;
  double timeout_s = 0;
  // the text may be empty
  bool dry_run = false, json = false, status = false, no_page = false, quiet = false, uses_slurm = false;
  std::vector<std::string> case_words;
};

void add_options(CLI::App& command, BatchArguments& a) {
  command.add_option("MANIFEST", a.manifest,
                     "CSV or TSV with the columns id, input and any long option by its name; or a folder in the layout "
                     "of BIDS derivatives");
  command.add_option("-o,--output", a.folder, "folder of the cohort: a folder for each case, and cohort.html")
      ->required();
  command.add_option("--inputs", a.inputs,
                     "quoted glob of inputs in place of a manifest: 'sub-*/anat/*_dseg.nii.gz'; relative to the folder "
                     "MANIFEST, if one is given");
  command.add_option("--format", a.formats,
                     "endings of the meshes of each case: vtu,stl (default: vtu; of surface stl; of fem inp)");
  command.add_option("--jobs", a.jobs, "cases at once (default: one for each core)")->check(CLI::Range(1, 4096));
  command.add_option("--only", a.only,
                     "failed (those that failed before run again), or ids and globs of ids: failed,sub-01,'sub-1*'");
  command.add_flag("--dry-run", a.dry_run,
                   "only what would run, with foretold memory and time, from a look at each input");
  command.add_flag("--json", a.json, "with --dry-run: as JSON");
  command.add_option("--retry", a.retries, "more tries of a case that fails, unless its input or call is wrong")
      ->check(CLI::Range(0, 100))
      ->capture_default_str();
  command.add_option("--timeout", a.timeout_s, "of each case, s (default: none)")
      ->check(number_in(1e-3, 1e9, "a number above 0"));
  command.add_option("--max-memory", a.memory, "what all cases at once may take: 12GB (default: what is free)");
  command.add_option("--case-memory", a.case_memory, "what each case may take: 4GB (default: what all may)");
  command.add_option("--slurm", a.slurm,
                     "submit to Slurm instead of running here; options of sbatch in one text: \"--partition=long "
                     "--account=x\" (\"\" for none)");
  command.add_option("--cases-per-task", a.cases_per_task, "with --slurm: cases in a row in each task of the array")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  command.add_flag("--status", a.status, "only how far the cohort is, here and in Slurm's queue");
  command.add_flag("--no-page", a.no_page, "leave out cohort.html and the other files of collect at the end");
  command.add_flag("--quiet", a.quiet, "no line for each case");
  command.add_option("--task", a.task)->group("");  // of a Slurm array: a plan
  command.footer("Options of each case stand behind --: stackmesh batch cases.csv -o cohort -- mesh --edge-length 2");
}

std::vector<std::string> split_formats(const std::string& text, const std::string& command) {
  std::vector<std::string> formats;
  std::string part;
  for (const char c : text + ",") {
    if (c != ',') {
      part += c;
      continue;
    }
    if (!part.empty() && part[0] == '.') part.erase(0, 1);
    const std::string path = "mesh." + part;
    const bool known = is_surface_format(path) ? command != "fem" : is_volume_format(path) && command != "surface";
    if (!part.empty() && !known)
      fail_usage(command + " does not write '" + part + "'", "--format",
                 "choose of " + (command == "surface" ? std::string() : volume_endings() + " ") +
                     (command == "fem" ? "" : surface_endings()));
    if (!part.empty() && std::find(formats.begin(), formats.end(), part) == formats.end()) formats.push_back(part);
    part.clear();
  }
  if (formats.empty()) formats.push_back(command == "surface" ? "stl" : command == "fem" ? "inp" : "vtu");
  return formats;
}

/// What the call asks for, once everything about it was found to be right.
struct Batch {
  CohortPlan plan;
  CaseCommand command;
  std::vector<CohortCase> chosen;
  bool failed_again = false, some_only = false;
};

std::string program_path() {
  std::error_code error;
  const fs::path path = fs::read_symlink("/proc/self/exe", error);
  return error ? "/proc/self/exe" : path.string();
}

void read_source(const BatchArguments& a, const std::vector<OptionValue>& options, const CaseCommand& command,
                 CohortPlan& plan) {
  std::error_code ignored;
  const bool is_folder = fs::is_directory(a.manifest, ignored);
  if (!a.manifest.empty() && !fs::exists(a.manifest, ignored))
    fail_input("the manifest is not there", a.manifest, "check the name");
  plan.source = a.manifest.empty() ? "" : fs::canonical(a.manifest, ignored).string();
  if (!a.inputs.empty()) {
    if (!a.manifest.empty() && !is_folder)
      fail_usage("a manifest and --inputs both name the cases", "command line",
                 "give one of them; --inputs may be relative to a folder");
    plan.cases = read_glob(a.inputs, a.manifest, command, options);
    plan.source = (plan.source.empty() ? fs::current_path(ignored).string() : plan.source) + "/" + a.inputs;
  } else if (a.manifest.empty()) {
    fail_usage("there is no manifest", "command line",
               "name a CSV or TSV file, a folder of BIDS derivatives, or files with --inputs 'GLOB'");
  } else if (is_folder) {
    plan.cases = read_bids_tree(a.manifest, command, options);
  } else {
    plan.source_sha256 = sha256_of_file(a.manifest);
    plan.cases = read_manifest(a.manifest, command, options);
  }
}

/// Those that --only names.
void choose_cases(const BatchArguments& a, const CohortFolder& folder, Batch& batch) {
  batch.chosen = batch.plan.cases;
  if (a.only.empty()) return;
  std::set<std::string> ids;
  std::string others, word;
  for (const char c : a.only + ",") {
    if (c != ',') {
      word += c;
      continue;
    }
    if (word == "failed") batch.failed_again = true;
    else if (!word.empty()) others += (others.empty() ? "" : ",") + word;
    word.clear();
  }
  if (batch.failed_again)
    for (const CohortCase& c : batch.plan.cases)
      if (folder.record(c.id, true)) ids.insert(c.id);
  if (!others.empty())
    for (const CohortCase& c : selected_cases(batch.plan.cases, others)) ids.insert(c.id);
  batch.some_only = !batch.failed_again;
  batch.chosen.clear();
  for (const CohortCase& c : batch.plan.cases)
    if (ids.count(c.id) > 0) batch.chosen.push_back(c);
}

Batch read_batch(const BatchArguments& a, const CohortFolder& folder) {
  Batch batch;
  std::vector<std::string> words = a.case_words;
  std::string name = "mesh";
  if (!words.empty() && words[0].rfind('-', 0) != 0) {
    name = words[0];
    words.erase(words.begin());
    if (name != "mesh" && name != "surface" && name != "fem")
      fail_usage("'" + name + "' makes no case", "behind --",
                 "write mesh, surface or fem, or their options alone (for mesh)");
  }
  batch.command = case_command(name, split_formats(a.formats, name));
  const std::vector<OptionValue> options = read_case_options(name, words);
  batch.plan.version = batch.command.version;
  batch.plan.command = name;
  batch.plan.formats = batch.command.formats;
  read_source(a, options, batch.command, batch.plan);
  folder.check_source(batch.plan);
  choose_cases(a, folder, batch);
  return batch;
}

std::uint64_t bytes_of(const std::string& text, const std::string& option) {
  return text.empty() ? 0 : parse_memory(text, option);
}

RunCasesOptions run_options(const BatchArguments& a, bool failed_again) {
  RunCasesOptions o;
  o.program = program_path();
  o.jobs = a.jobs;
  o.memory_bytes = bytes_of(a.memory, "--max-memory");
  o.case_memory_bytes = bytes_of(a.case_memory, "--case-memory");
  if (a.timeout_s > 0) o.timeout_s = a.timeout_s;
  o.retries = a.retries;
  o.failed_again = failed_again;
  return o;
}

void print_event(const CaseEvent& e) {
  using Kind = CaseEvent::Kind;
  const CaseRecord& r = e.record;
  const char* word = e.kind == Kind::done      ? "done"
                     : e.kind == Kind::adopted ? "adopted"
                     : e.kind == Kind::failed  ? "failed"
                                               : "";
  if (*word == '\0') return;
  std::printf("%5zu/%zu  %-7s %-32s %8.1f s %7.0f MB  %s\n", e.ended, e.of, word, printable(r.id).c_str(), r.wall_s,
              r.peak_mb, printable(r.reason).c_str());
  std::fflush(stdout);
}

std::string plural(std::size_t n, const char* what) {
  return std::to_string(n) + " " + what + (n == 1 ? "" : "s");
}

/// Runs the cases here, tells of them, and ends as the program has to.
void run_here(const BatchArguments& a, const Batch& batch, const CohortFolder& folder, bool with_page) {
  std::vector<std::pair<std::string, std::string>> failed_before;
  const RunCasesResult result =
      run_cases(batch.chosen, batch.command, folder, run_options(a, batch.failed_again), [&](const CaseEvent& e) {
        if (e.kind == CaseEvent::Kind::failed_before) failed_before.emplace_back(e.record.id, e.record.reason);
        if (!a.quiet) print_event(e);
      });
  const std::size_t failed = result.failed + result.failed_before;
  for (const auto& [id, reason] : failed_before)
    std::printf("failed before  %s: %s\n", printable(id).c_str(), printable(reason).c_str());
  std::printf("%s: %zu done", plural(batch.chosen.size(), "case").c_str(),
              result.done + result.adopted + result.unchanged);
  if (result.unchanged + result.adopted > 0) std::printf(" (%zu of them before)", result.unchanged + result.adopted);
  std::printf(", %zu failed", failed);
  if (result.failed_before > 0)
    std::printf(" (%zu of them before; --only failed runs them again)", result.failed_before);
  if (result.not_run > 0) std::printf(", %zu not run", result.not_run);
  std::printf("\n");
  if (result.stopped_by != 0) {
    std::printf("stopped by a signal; what was finished stays, and the same command goes on\n");
    std::fflush(stdout);
    ::signal(result.stopped_by, SIG_DFL);
    ::raise(result.stopped_by);
  }
  if (with_page) {
    const Cohort cohort = collect(folder, {});
    std::printf("page  %s: %zu outside their limits, %s among the others\n",
                printable(folder.path() + "/cohort.html").c_str(), cohort.outside(),
                plural(cohort.outliers(), "outlier").c_str());
  }
  std::fflush(stdout);
  if (failed > 0)
    throw Error(ErrorKind::no_result, plural(failed, "case") + " of " + std::to_string(batch.chosen.size()) + " failed",
                folder.path(),
                "read why above or in " + std::string(a.no_page ? "each ID.failed/log.txt" : "cohort.html") +
                    ", mend it and run the same command again, or --only failed");
}

const char* action_of(const CohortFolder& folder, const CohortCase& c, const std::string& key, bool failed_again) {
  const auto done = folder.record(c.id), failed = folder.record(c.id, true);
  if (done && done->key == key) return "done before";
  if (failed && failed->key == key && !failed_again) return "failed before";
  return done || failed ? "run again" : "run";
}

void print_dry_run(const BatchArguments& a, const Batch& batch, const CohortFolder& folder) {
  const std::vector<CaseLook> looks =
      look_at_cases(batch.chosen, batch.command, folder, a.jobs, RunCasesOptions().look_timeout_s);
  nlohmann::ordered_json cases = nlohmann::ordered_json::array();
  double seconds = 0, most_mb = 0;
  std::size_t runs = 0;
  if (!a.json)
    std::printf("%-32s %-14s %10s %9s %11s %7s  %s\n", "case", "action", "memory, MB", "time, s", "voxels", "labels",
                "input");
  for (std::size_t i = 0; i < looks.size(); ++i) {
    const CaseLook& l = looks[i];
    const std::string action = action_of(folder, batch.chosen[i], l.key, batch.failed_again);
    if (action.rfind("run", 0) == 0) {
      ++runs;
      seconds += l.time_s;
      most_mb = std::max(most_mb, l.memory_mb);
    }
    std::string input;
    for (const std::string& part : batch.chosen[i].inputs) input += (input.empty() ? "" : " ") + part;
    if (a.json)
      cases.push_back({{"id", batch.chosen[i].id},
                       {"inputs", batch.chosen[i].inputs},
                       {"action", action},
                       {"memory_mb", l.memory_mb},
                       {"time_s", l.time_s},
                       {"voxels", l.voxels},
                       {"labels", l.labels},
                       {"key", l.key},
                       {"fault", l.fault}});
    else if (action == "done before" || action == "failed before")
      std::printf("%-32s %s\n", printable(batch.chosen[i].id).c_str(), action.c_str());
    else if (!l.fault.empty())
      std::printf("%-32s %-14s %s\n", printable(batch.chosen[i].id).c_str(), action.c_str(),
                  printable("would fail: " + l.fault).c_str());
    else
      std::printf("%-32s %-14s %10.0f %9.1f %11zu %7zu  %s\n", printable(batch.chosen[i].id).c_str(), action.c_str(),
                  l.memory_mb, l.time_s, l.voxels, l.labels, printable(input).c_str());
  }
  if (a.json)
    std::printf("%s\n", nlohmann::ordered_json({{"cases", cases}})
                            .dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace)
                            .c_str());
  else
    std::printf("%s to run, about %.0f s on one core in all, at most %.0f MB for one\n", plural(runs, "case").c_str(),
                seconds, most_mb);
}

void submit_to_slurm(const BatchArguments& a, const Batch& batch, const CohortFolder& folder) {
  const std::map<std::string, std::string> queued = queued_cases(folder);
  std::vector<CohortCase> open;
  std::vector<CaseLook> looks;
  const std::vector<CaseLook> all =
      look_at_cases(batch.chosen, batch.command, folder, a.jobs, RunCasesOptions().look_timeout_s);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const CohortCase& c = batch.chosen[i];
    if (queued.count(c.id) > 0 ||
        std::string(action_of(folder, c, all[i].key, batch.failed_again)).rfind("run", 0) != 0)
      continue;
    open.push_back(c);
    looks.push_back(all[i]);
  }
  SlurmOptions o;
  o.program = program_path();
  o.arguments = a.slurm;
  o.cases_per_task = a.cases_per_task;
  o.retries = a.retries;
  o.failed_again = batch.failed_again;
  if (a.timeout_s > 0) o.timeout_s = a.timeout_s;
  o.case_memory_bytes = bytes_of(a.case_memory, "--case-memory");
  std::vector<SlurmArray> arrays = size_classes(open, looks, o, most_array_tasks());
  submit(arrays, batch.plan, folder, o);
  for (const SlurmArray& array : arrays)
    std::printf("submitted  job %s: %s in %s, %llu MB and %d minutes each\n", array.job_id.c_str(),
                plural(array.ids.size(), "case").c_str(), plural(static_cast<std::size_t>(array.tasks), "task").c_str(),
                static_cast<unsigned long long>(array.memory_mb), array.minutes);
  std::printf(
      "%s submitted, %zu in the queue before, %zu with a result; see stackmesh batch --status -o %s, then stackmesh "
      "collect %s\n",
      plural(open.size(), "case").c_str(), queued.size(), batch.chosen.size() - open.size() - queued.size(),
      printable(folder.path()).c_str(), printable(folder.path()).c_str());
}

void print_status(const CohortFolder& folder) {
  const std::optional<CohortPlan> plan = folder.plan();
  if (!plan)
    fail_input("the folder holds no cohort: there is no .cohort/plan.json", folder.path(),
               "name the folder that stackmesh batch wrote with -o");
  const std::map<std::string, std::string> queued =
      submitted_arrays(folder).empty() ? std::map<std::string, std::string>() : queued_cases(folder);
  std::size_t done = 0, running = 0, waiting = 0;
  std::vector<std::string> failed, lost;
  for (const CohortCase& c : plan->cases) {
    const auto at = queued.find(c.id);
    if (at != queued.end() && !folder.record(c.id)) ++(at->second.rfind("PENDING", 0) == 0 ? waiting : running);
    else if (const auto record = folder.record(c.id, true)) failed.push_back(c.id + ": " + record->reason);
    else if (folder.record(c.id)) ++done;
    else
      lost.push_back(c.id + ": " +
                     (last_words(folder, c.id).empty() ? "no result, and not in the queue" : last_words(folder, c.id)));
  }
  std::printf("%s: %zu done, %zu failed, %zu running, %zu waiting, %zu open\n",
              plural(plan->cases.size(), "case").c_str(), done, failed.size(), running, waiting, lost.size());
  std::map<std::string, std::size_t> states;
  for (const auto& [id, state] : queued) ++states[state];
  for (const auto& [state, n] : states) std::printf("queue   %zu %s\n", n, printable(state).c_str());
  for (const std::string& text : failed) std::printf("failed  %s\n", printable(text).c_str());
  for (const std::string& text : lost) std::printf("open    %s\n", printable(text).c_str());
}

/// A task of a Slurm array: the cases of a plan that are its share.
void run_task(const BatchArguments& a, const CohortFolder& folder) {
  const char* const index = std::getenv("SLURM_ARRAY_TASK_ID");
  if (index == nullptr)
    fail_usage("this is no task of a Slurm array", "--task", "leave it to the script that batch --slurm writes");
  Batch batch;
  batch.plan = read_plan(a.task);
  batch.command = case_command(batch.plan.command, batch.plan.formats);
  if (batch.plan.version != batch.command.version)
    fail_usage("the plan is of stackmesh " + batch.plan.version + ", this is " + batch.command.version, a.task,
               "install one version on all nodes");
  const std::size_t per_task = static_cast<std::size_t>(a.cases_per_task),
                    first = static_cast<std::size_t>(std::strtoul(index, nullptr, 10)) * per_task;
  for (std::size_t i = first; i < std::min(batch.plan.cases.size(), first + per_task); ++i)
    batch.chosen.push_back(batch.plan.cases[i]);
  batch.failed_again = a.only == "failed";
  const CohortLock lock(folder, true);
  BatchArguments one = a;
  one.jobs = 1;
  run_here(one, batch, folder, false);
}

void run(const BatchArguments& a) {
  const CohortFolder folder(a.folder);
  if (a.status) return print_status(folder);
  if (!a.task.empty()) return run_task(a, folder);
  const Batch batch = read_batch(a, folder);
  if (a.uses_slurm) check_slurm();
  run_options(a, false);  // its texts are right
  if (a.dry_run) return print_dry_run(a, batch, folder);
  folder.prepare();
  const bool shared = batch.some_only || a.uses_slurm;
  const CohortLock lock(folder, shared);
  folder.check_source(batch.plan);
  folder.write_plan(batch.plan);
  if (a.uses_slurm) return submit_to_slurm(a, batch, folder);
  if (!shared) folder.remove_left_over();
  run_here(a, batch, folder, !a.no_page);
}

}  // namespace

std::vector<std::string> take_case_words(std::vector<std::string>& arguments) {
  if (arguments.empty() || arguments[0] != "batch") return {};
  // Options of sbatch are one value, though they look like options of ours.
  for (std::size_t i = 1; i + 1 < arguments.size() && arguments[i] != "--"; ++i)
    if (arguments[i] == "--slurm") {
      arguments[i] += "=" + (arguments[i + 1].empty() ? " " : arguments[i + 1]);
      arguments.erase(arguments.begin() + static_cast<std::ptrdiff_t>(i) + 1);
    }
  const auto dashes = std::find(arguments.begin(), arguments.end(), "--");
  if (dashes == arguments.end()) return {};
  std::vector<std::string> words(dashes + 1, arguments.end());
  arguments.erase(dashes, arguments.end());
  return words;
}

void add_batch_command(CLI::App& program, const std::vector<std::string>& case_words) {
  CLI::App* command = program.add_subcommand(
      "batch",
      "Many cases: meshes each into a folder of its own, here or on a Slurm cluster, and goes on where it stopped");
  auto a = std::make_shared<BatchArguments>();
  a->case_words = case_words;
  add_options(*command, *a);
  CLI::Option* const slurm = command->get_option("--slurm");
  command->callback([a, slurm] {
    a->uses_slurm = slurm->count() > 0;
    run(*a);
  });
}

}  // namespace stackmesh::app
