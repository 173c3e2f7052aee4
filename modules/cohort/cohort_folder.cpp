#include "cohort/cohort_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <climits>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <exception>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/text.h"

namespace stackmesh {
namespace {

namespace fs = std::filesystem;
constexpr char kWorkMark[] = ".work-";
constexpr char kPrevious[] = "previous";

std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return file ? text.str() : "";
}

[[noreturn]] void fail_at(const std::string& path, int code) {
  fail_output(std::string("cannot write: ") + std::strerror(code), path,
              "check the rights and the free space, or choose another folder");
}

/// What was written is on the disk before a name says that it is whole.
void bring_to_disk(const std::string& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return;
  if (::fsync(file) != 0) errno = 0;  // some file systems cannot say
  ::close(file);
}

void rename_folder(const std::string& from, const std::string& to) {
  if (std::rename(from.c_str(), to.c_str()) != 0) fail_at(to, errno);
}

/// Puts the folder `from` into the place of `to`, in one step where the file system can; what was there is at `from`
/// afterwards.
void exchange_folders(const std::string& from, const std::string& to) {
  constexpr unsigned kExchange = 2;  // RENAME_EXCHANGE
  if (::syscall(SYS_renameat2, AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), kExchange) == 0) return;
  const std::string aside = from + "-old";
  rename_folder(to, aside);
  rename_folder(from, to);
  rename_folder(aside, from);
}

void remove_folder(const std::string& path) {
  std::error_code ignored;
  fs::remove_all(path, ignored);
}

/// Hidden folders of work on the case.
std::vector<std::string> work_folders(const std::string& path, const std::string& id) {
  std::vector<std::string> found;
  std::error_code none;
  const std::string start = "." + id + kWorkMark;
  for (fs::directory_iterator it(path, none), end; !none && it != end; it.increment(none))
    if (it->path().filename().string().compare(0, start.size(), start) == 0) found.push_back(it->path().string());
  return found;
}

std::optional<CaseRecord> record_in(const std::string& file) {
  const std::string text = bytes_of(file);
  if (text.empty()) return std::nullopt;
  try {
    return case_record_of(text);
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

}  // namespace

std::string host_name() {
  char name[HOST_NAME_MAX + 1] = {};
  return ::gethostname(name, sizeof name - 1) == 0 ? name : "unknown";
}

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  char text[32];
  std::tm parts{};
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", ::gmtime_r(&now, &parts));
  return text;
}

void CohortFolder::prepare() const {
  std::error_code error;
  if (fs::exists(path_, error) && !fs::is_directory(path_, error))
    fail_output("the output is a file", path_, "name a folder");
  if (fs::is_directory(path_, error) && !fs::is_directory(own(""), error) && !fs::is_empty(path_, error)) {
    // those that workflow engines make for their outputs are empty
    for (const auto& entry : fs::directory_iterator(path_, error))
      if (!entry.is_directory(error) || !fs::is_empty(entry.path(), error))
        fail_usage("the folder holds other files", path_, "name a new folder for the cohort, or an empty one");
  }
  fs::create_directories(own(""), error);
  if (error) fail_at(path_, error.value());
  if (::access(path_.c_str(), W_OK | X_OK) != 0) fail_at(path_, errno);
}

CohortPlan read_plan(const std::string& path) {
  const std::string text = bytes_of(path);
  try {
    return cohort_plan_of(text);
  } catch (const std::exception&) {
    fail_input("the plan of the cohort is damaged", path,
               "remove that file and run the same batch command again: finished cases stay");
  }
}

std::optional<CohortPlan> CohortFolder::plan() const {
  std::error_code ignored;
  if (!fs::exists(own("plan.json"), ignored)) return std::nullopt;
  return read_plan(own("plan.json"));
}

void CohortFolder::check_source(const CohortPlan& plan) const {
  const std::optional<CohortPlan> before = this->plan();
  if (!before || before->source == plan.source) return;
  if (!plan.source_sha256.empty() && before->source_sha256 == plan.source_sha256) return;
  fail_usage("the folder holds the cases of another manifest, '" + before->source + "'", path_,
             "name another folder; if that manifest was moved and edited, remove " + own("plan.json") +
                 " (finished cases stay)");
}

void CohortFolder::write_plan(const CohortPlan& plan) const {
  const std::string text = to_json(plan);
  if (bytes_of(own("plan.json")) == text) return;
  AtomicFiles files;
  files.write(own("plan.json"), [&](std::FILE* f) { std::fwrite(text.data(), 1, text.size(), f); });
  files.commit();
}

std::optional<CaseRecord> CohortFolder::record(const std::string& id, bool failed) const {
  return record_in(failed ? failed_folder(id) + "/failed.json" : case_folder(id) + "/done");
}

std::string CohortFolder::begin(const std::string& id, const std::string& key) const {
  for (const std::string& left : work_folders(path_, id)) {
    const std::optional<CaseRecord> whole = record_in(left + "/done");
    const std::optional<CaseRecord> there = record(id);
    if (whole && !key.empty() && whole->key == key && !(there && there->key == key)) {
      finish(left, *whole);
      note("adopted", id, key);
      for (const std::string& other : work_folders(path_, id)) remove_folder(other);
      return "";
    }
    remove_folder(left);
  }
  const std::string work = path_ + "/." + id + kWorkMark + host_name() + "-" + std::to_string(::getpid());
  if (::mkdir(work.c_str(), 0777) != 0) fail_at(work, errno);
  return work;
}

void CohortFolder::finish(const std::string& work, const CaseRecord& record) const {
  const std::string text = to_json(record),
                    final_path = record.is_done ? case_folder(record.id) : failed_folder(record.id);
  std::error_code ignored;
  if (!record.is_done) {  // what another key made stays, but not as this case's result
    remove_folder(work + "/" + kPrevious);
    if (fs::exists(failed_folder(record.id) + "/" + kPrevious, ignored))
      rename_folder(failed_folder(record.id) + "/" + kPrevious, work + "/" + kPrevious);
    if (this->record(record.id)) {
      remove_folder(work + "/" + kPrevious);
      rename_folder(case_folder(record.id), work + "/" + kPrevious);
    }
  }
  for (const auto& entry : fs::directory_iterator(work, ignored)) bring_to_disk(entry.path().string());
  AtomicFiles files;
  files.write(work + (record.is_done ? "/done" : "/failed.json"),
              [&](std::FILE* f) { std::fwrite(text.data(), 1, text.size(), f); });
  files.commit();
  bring_to_disk(work);
  if (fs::exists(final_path, ignored)) {
    exchange_folders(work, final_path);
    remove_folder(work);
  } else {
    rename_folder(work, final_path);
  }
  if (record.is_done) remove_folder(failed_folder(record.id));
  bring_to_disk(path_);
}

void CohortFolder::remove_left_over() const {
  std::error_code none;
  std::vector<std::string> left;
  for (fs::directory_iterator it(path_, none), end; !none && it != end; it.increment(none)) {
    const std::string name = it->path().filename().string();
    const std::size_t mark = name.find(kWorkMark);
    // A whole one is adopted when its case's turn comes.
    if (name[0] == '.' && mark != std::string::npos && mark > 1 && !fs::exists(it->path() / "done", none))
      left.push_back(it->path().string());
  }
  for (const std::string& path : left) remove_folder(path);
}

void CohortFolder::note(const std::string& event, const std::string& id, const std::string& key) const {
  const std::string line =
      utc_now() + "\t" + host_name() + "\t" + std::to_string(::getpid()) + "\t" + event + "\t" + id + "\t" + key + "\n";
  const int file = ::open(own("journal.tsv").c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0666);
  if (file < 0) return;
  if (::write(file, line.data(), line.size()) < 0) errno = 0;  // the journal tells; nothing depends on it
  ::close(file);
}

CohortLock::CohortLock(const CohortFolder& folder, bool shared) {
  const std::string path = folder.own("lock");
  file_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (file_ < 0) fail_at(path, errno);
  // The processes of a runner that was killed may hold it for a moment longer.
  bool held = false;
  for (int tries = 0; tries < 20 && !held; ++tries) {
    held = ::flock(file_, (shared ? LOCK_SH : LOCK_EX) | LOCK_NB) == 0;
    if (!held) std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  if (!held) {
    const std::string holder = printable(bytes_of(path));
    ::close(file_);
    fail_usage("another run works in this folder" + (holder.empty() ? std::string() : ", " + holder), folder.path(),
               "wait until it has ended, or stop it");
  }
  const std::string text = "process " + std::to_string(::getpid()) + " on " + host_name();
  // for the message only
  if (::ftruncate(file_, 0) != 0 || ::pwrite(file_, text.data(), text.size(), 0) < 0) errno = 0;
}

CohortLock::~CohortLock() {
  if (file_ >= 0) ::close(file_);
}

}  // namespace stackmesh
