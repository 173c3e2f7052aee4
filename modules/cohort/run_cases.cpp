#include "cohort/run_cases.h"

#include <sched.h>
#include <signal.h>
#include <string.h>

#include <algorithm>
#include <deque>
#include <exception>
#include <filesystem>
#include <fstream>
#include <list>
#include <map>
#include <sstream>
#include <utility>

#include "base/error.h"
#include "base/memory.h"
#include "base/text.h"
#include "cohort/child.h"

namespace stackmesh {
namespace {

namespace fs = std::filesystem;
constexpr double kGraceS = 3;  // between being asked to end and being killed

std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// The hidden folder's path in what the program wrote becomes the one that the reader will see.
void name_final_folder(const std::string& file, const std::string& work, const std::string& final_path) {
  std::string text = bytes_of(file);
  bool changed = false;
  for (std::size_t at = 0; (at = text.find(work, at)) != std::string::npos; at += final_path.size()) {
    text.replace(at, work.size(), final_path);
    changed = true;
  }
  if (changed) std::ofstream(file, std::ios::binary) << text;
}

/// The last error that the program told, or how it ended.
std::string reason_of(const std::string& log, const ChildEnd& end) {
  const std::string mark = "stackmesh: error: ", text = bytes_of(log);
  const std::size_t at = text.rfind(mark);
  if (at != std::string::npos) {
    const std::size_t from = at + mark.size();
    return printable(text.substr(from, text.find('\n', from) - from));
  }
  if (end.code < 0) {
    const std::string name = ::strsignal(-end.code);
    return "killed by signal " + std::to_string(-end.code) + " (" + name + ")" +
           (end.code == -SIGKILL ? ", most likely for want of memory" : "");
  }
  return "ended with exit code " + std::to_string(end.code) + " and no word";
}

std::uint64_t number_after(const std::string& path, const std::string& key) {
  std::ifstream file(path);
  std::string word;
  std::uint64_t value = 0;
  while (file >> word)
    if (word == key && file >> value) return value;
  return 0;
}

/// A case on its way through the pool.
struct Job {
  const CohortCase* c = nullptr;
  Child look_process, process;
  bool is_looked = false, alone = false, timed_out = false;
  CaseLook look;
  std::string work;
  double asked_at_s = 0;
  int tries = 0;
};

class Pool {
 public:
  Pool(const std::vector<CohortCase>& cases, const CaseCommand& command, const CohortFolder& folder,
       const RunCasesOptions& options, const std::function<void(const CaseEvent&)>& tell)
      : cases_(cases),
        command_(command),
        folder_(folder),
        o_(options),
        tell_(tell),
        jobs_(options.jobs > 0 ? options.jobs : usable_cores()),
        look_timeout_s_(std::min(options.look_timeout_s, options.timeout_s.value_or(options.look_timeout_s))),
        budget_mb_(static_cast<double>(options.memory_bytes > 0 ? options.memory_bytes : free_memory()) / (1 << 20)) {}

  RunCasesResult run() {
    while (next_ < cases_.size() || !waiting_.empty() || !running_.empty()) {
      begin_looks();
      start_what_fits();
      if (waiting_.empty() && running_.empty()) continue;
      if (const int signal = signals_.wait(seconds_to_wait()); signal != 0) return stop(signal);
      take_looks();
      take_ends();
    }
    return result_;
  }

 private:
  /// A case is looked at while others run, so that it can start at once.
  void begin_looks() {
    while (next_ < cases_.size() && static_cast<int>(waiting_.size()) < kAhead) {
      Job job;
      job.c = &cases_[next_++];
      const std::optional<CaseRecord> known = folder_.record(job.c->id);
      const std::string key = known ? known->key : "";
      job.look_process = Child::fork_for([&] { return to_json(look_at_case(*job.c, command_, key)); });
      waiting_.push_back(std::move(job));
    }
  }

  void take_looks() {
    for (auto job = waiting_.begin(); job != waiting_.end();) {
      ChildEnd end;
      if (!job->is_looked && job->look_process.is_running()) {
        if (job->look_process.has_ended(end)) {
          take_look(*job, job->look_process.text());
        } else if (job->look_process.age_s() > look_timeout_s_) {
          job->look_process = Child();
          take_look(*job, "");
        }
      }
      if (job->is_looked && is_settled(*job)) job = waiting_.erase(job);
      else ++job;
    }
  }

  /// @param text empty where the look came to nothing: then the key alone is made, and the case runs alone
  void take_look(Job& job, const std::string& text) {
    job.is_looked = true;
    try {
      job.look = case_look_of(text);
    } catch (const std::exception&) {
      job.look = identify_case(*job.c, command_);
      job.alone = true;
    }
  }

  /// Whether nothing is left to do for a case: told, and counted.
  bool is_settled(Job& job) {
    const std::optional<CaseRecord> done = folder_.record(job.c->id), failed = folder_.record(job.c->id, true);
    if (done && done->key == job.look.key) return settle(CaseEvent::Kind::unchanged, *done, result_.unchanged);
    if (failed && failed->key == job.look.key && !o_.failed_again && !job.look.key.empty())
      return settle(CaseEvent::Kind::failed_before, *failed, result_.failed_before);
    return false;
  }

  bool settle(CaseEvent::Kind kind, const CaseRecord& record, std::size_t& counter) {
    ++counter;
    ++ended_;
    tell_({kind, record, ended_, cases_.size()});
    return true;
  }

  void start_what_fits() {
    while (!waiting_.empty() && waiting_.front().is_looked && static_cast<int>(running_.size()) < jobs_) {
      Job& job = waiting_.front();
      const bool some_alone = std::any_of(running_.begin(), running_.end(), [](const Job& j) { return j.alone; });
      double used_mb = 0;
      for (const Job& j : running_) used_mb += j.look.memory_mb;
      if (!running_.empty() && (some_alone || job.alone || used_mb + job.look.memory_mb > budget_mb_)) return;
      running_.push_back(std::move(job));
      waiting_.pop_front();
      if (!start(running_.back())) running_.pop_back();
    }
  }

  /// @return false where a former run had all but finished it
  bool start(Job& job) {
    job.work = folder_.begin(job.c->id, job.look.key);
    if (job.work.empty()) {
      if (const auto record = folder_.record(job.c->id)) settle(CaseEvent::Kind::adopted, *record, result_.adopted);
      return false;
    }
    const std::uint64_t bound = o_.case_memory_bytes > 0 ? o_.case_memory_bytes : o_.memory_bytes;
    ++job.tries;
    job.timed_out = false;
    job.asked_at_s = 0;
    folder_.note("started", job.c->id, job.look.key);
    job.process =
        Child::start(words_of_case(*job.c, command_, o_.program, job.work, std::max(1, usable_cores() / jobs_), bound),
                     job.work + "/log.txt");
    CaseRecord record;
    record.id = job.c->id;
    tell_({CaseEvent::Kind::started, record, ended_, cases_.size()});
    return true;
  }

  double seconds_to_wait() const {
    double seconds = 3600;
    for (const Job& job : running_) {
      if (job.timed_out) seconds = std::min(seconds, job.asked_at_s + kGraceS - job.process.age_s());
      else if (o_.timeout_s) seconds = std::min(seconds, *o_.timeout_s - job.process.age_s());
    }
    for (const Job& job : waiting_)
      if (!job.is_looked) seconds = std::min(seconds, look_timeout_s_ + 0.1 - job.look_process.age_s());
    return seconds;
  }

  void take_ends() {
    for (auto job = running_.begin(); job != running_.end();) {
      ChildEnd end;
      if (job->process.has_ended(end)) {
        if (take_end(*job, end)) {
          job = running_.erase(job);
          continue;
        }
      } else if (o_.timeout_s && job->process.age_s() >= *o_.timeout_s &&
                 (!job->timed_out || job->process.age_s() >= job->asked_at_s + kGraceS)) {
        if (!job->timed_out) job->asked_at_s = job->process.age_s();
        job->timed_out = true;
        job->process.stop();
      }
      ++job;
    }
  }

  /// @return false where the case is tried again
  bool take_end(Job& job, const ChildEnd& end) {
    CaseRecord r = record_of(job, end);
    const bool by_kernel = end.code == -SIGKILL && !job.timed_out && !job.alone && running_.size() > 1;
    const bool may_differ = !r.is_done && end.code != 2 && end.code != 3;
    if (by_kernel || (may_differ && job.tries <= o_.retries)) {
      folder_.note("tried", job.c->id, job.look.key);
      job.alone = job.alone || by_kernel;
      fs::remove_all(job.work);
      Job again = std::move(job);
      again.look_process = Child();
      waiting_.push_front(std::move(again));
      return true;
    }
    const std::string final_path = r.is_done ? folder_.case_folder(r.id) : folder_.failed_folder(r.id);
    for (const char* file : {"/log.txt", "/report.json", "/report.html"})
      name_final_folder(job.work + file, job.work, final_path);
    folder_.finish(job.work, r);
    folder_.note(r.is_done ? "done" : "failed", r.id, r.key);
    settle(r.is_done ? CaseEvent::Kind::done : CaseEvent::Kind::failed, r, r.is_done ? result_.done : result_.failed);
    return true;
  }

  CaseRecord record_of(const Job& job, const ChildEnd& end) const {
    CaseRecord r;
    r.id = job.c->id;
    r.key = job.look.key;
    r.exit_code = end.code;
    r.version = command_.version;
    r.command = command_.name;
    r.inputs = job.c->inputs;
    r.options = words_of(job.c->options);
    r.input_sha256 = job.look.input_sha256;
    r.wall_s = end.wall_s;
    r.cpu_s = end.cpu_s;
    r.peak_mb = end.peak_mb;
    r.foretold_mb = job.look.memory_mb;
    r.foretold_s = job.look.time_s;
    r.tries = job.tries;
    r.host = host_name();
    r.finished_utc = utc_now();
    r.is_done = end.code == 0;
    if (!r.is_done) r.reason = reason_of(job.work + "/log.txt", end);
    if (job.timed_out)
      r.reason =
          "took longer than the " + seconds_text(*o_.timeout_s) + " s of --timeout; give it more, or mesh it coarser";
    std::error_code ignored;
    for (const std::string& format : command_.formats)
      if (r.is_done && !fs::exists(job.work + "/mesh." + format, ignored)) {
        r.is_done = false;
        r.reason = "the program ended well without mesh." + format;
      }
    if (job.timed_out) r.is_done = false;
    return r;
  }

  static std::string seconds_text(double s) {
    std::ostringstream text;
    text << s;
    return text.str();
  }

  RunCasesResult stop(int signal) {
    for (Job& job : running_) job.process.stop();
    const auto begun = std::chrono::steady_clock::now();
    const auto any_left = [&] {
      return std::any_of(running_.begin(), running_.end(), [](const Job& j) { return j.process.is_running(); });
    };
    ChildEnd end;
    while (any_left() && std::chrono::steady_clock::now() - begun < std::chrono::duration<double>(kGraceS)) {
      for (Job& job : running_) job.process.has_ended(end);
      if (any_left()) signals_.wait(0.1);
    }
    for (Job& job : running_) {
      job.process = Child();  // killed where it has not ended
      folder_.note("stopped", job.c->id, job.look.key);
      std::error_code ignored;
      fs::remove_all(job.work, ignored);
    }
    waiting_.clear();
    running_.clear();
    result_.stopped_by = signal;
    result_.not_run = cases_.size() - ended_;
    return result_;
  }

  static constexpr int kAhead = 2;  // cases that are looked at before their turn
  const std::vector<CohortCase>& cases_;
  const CaseCommand& command_;
  const CohortFolder& folder_;
  const RunCasesOptions& o_;
  const std::function<void(const CaseEvent&)>& tell_;
  const int jobs_;
  const double look_timeout_s_, budget_mb_;
  ChildSignals signals_;
  std::size_t next_ = 0, ended_ = 0;
  std::deque<Job> waiting_;
  std::list<Job> running_;
  RunCasesResult result_;
};

}  // namespace

int usable_cores() {
  cpu_set_t set;
  CPU_ZERO(&set);
  if (::sched_getaffinity(0, sizeof set, &set) != 0) return 1;
  return std::max(1, CPU_COUNT(&set));
}

std::uint64_t free_memory() {
  const std::uint64_t free_bytes = 1024 * number_after("/proc/meminfo", "MemAvailable:");
  return free_bytes > 0 ? std::min(free_bytes, memory_limit()) : memory_limit();
}

std::vector<std::string> words_of_case(const CohortCase& c, const CaseCommand& command, const std::string& program,
                                       const std::string& folder, int threads, std::uint64_t memory_bytes) {
  std::vector<std::string> words = {program, command.name};
  words.insert(words.end(), c.inputs.begin(), c.inputs.end());
  for (const std::string& format : command.formats) words.insert(words.end(), {"-o", folder + "/mesh." + format});
  for (const char* report : {"/report.json", "/report.html"}) words.insert(words.end(), {"--report", folder + report});
  const std::vector<std::string> options = words_of(c.options);
  words.insert(words.end(), options.begin(), options.end());
  const auto has = [&](const std::string& name) {
    return std::any_of(c.options.begin(), c.options.end(), [&](const OptionValue& o) { return o.name == name; });
  };
  if (!has("threads")) words.push_back("--threads=" + std::to_string(threads));
  if (!has("max-memory") && memory_bytes > 0) words.push_back("--max-memory=" + std::to_string(memory_bytes));
  if (!has("progress")) words.push_back("--progress=none");
  return words;
}

RunCasesResult run_cases(const std::vector<CohortCase>& cases, const CaseCommand& command, const CohortFolder& folder,
                         const RunCasesOptions& options, const std::function<void(const CaseEvent&)>& tell) {
  return Pool(cases, command, folder, options, tell).run();
}

std::vector<CaseLook> look_at_cases(const std::vector<CohortCase>& cases, const CaseCommand& command,
                                    const CohortFolder& folder, int jobs, double timeout_s) {
  std::vector<CaseLook> looks(cases.size());
  std::map<std::size_t, Child> running;
  const std::size_t most = static_cast<std::size_t>(jobs > 0 ? jobs : usable_cores());
  ChildSignals signals;
  for (std::size_t next = 0; next < cases.size() || !running.empty();) {
    for (; next < cases.size() && running.size() < most; ++next) {
      const std::optional<CaseRecord> known = folder.record(cases[next].id);
      running[next] =
          Child::fork_for([&] { return to_json(look_at_case(cases[next], command, known ? known->key : "")); });
    }
    if (const int signal = signals.wait(1); signal != 0)
      throw Error(ErrorKind::no_result, "stopped by a signal", folder.path(), "run it again");
    for (auto it = running.begin(); it != running.end();) {
      ChildEnd end;
      const bool ended = it->second.has_ended(end), late = !ended && it->second.age_s() > timeout_s;
      if (!ended && !late) {
        ++it;
        continue;
      }
      try {
        looks[it->first] = case_look_of(ended ? it->second.text() : "");
      } catch (const std::exception&) {
        looks[it->first] = identify_case(cases[it->first], command);
        looks[it->first].fault = late
                                     ? "the look took longer than " + std::to_string(static_cast<int>(timeout_s)) + " s"
                                     : "the look at the input came to nothing";
      }
      it = running.erase(it);
    }
  }
  return looks;
}

}  // namespace stackmesh
