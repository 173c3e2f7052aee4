#include "cohort/child.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <ctime>
#include <utility>

#include "base/error.h"

namespace stackmesh {
namespace {

constexpr int kStopSignals[] = {SIGINT, SIGTERM, SIGHUP};

/// In the new process: it ends with its parent, and takes signals as a fresh program does.
void settle(pid_t parent) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(70);  // it ended before
  ::setpgid(0, 0);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGQUIT, SIGXCPU, SIGCHLD}) ::signal(signal, SIG_DFL);
  sigset_t none;
  ::sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
}

[[noreturn]] void fail_to_start(int code) {
  throw Error(ErrorKind::no_result, std::string("the system gives no process: ") + std::strerror(code), "this machine",
              "allow more processes (ulimit -u) or give fewer --jobs");
}

double seconds(const timeval& t) {
  return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
}

}  // namespace

Child::Child(Child&& other) noexcept {
  *this = std::move(other);
}

Child& Child::operator=(Child&& other) noexcept {
  std::swap(pid_, other.pid_);
  std::swap(pipe_, other.pipe_);
  std::swap(asked_, other.asked_);
  std::swap(begun_, other.begun_);
  return *this;
}

Child::~Child() {
  kill_now();
  if (pipe_ >= 0) ::close(pipe_);
}

void Child::kill_now() {
  if (pid_ <= 0) return;
  ::kill(-pid_, SIGKILL);
  ::kill(pid_, SIGKILL);
  while (::waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
  }
  pid_ = -1;
}

Child Child::start(const std::vector<std::string>& words, const std::string& log) {
  std::vector<char*> argv;
  for (const std::string& word : words) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  Child child;
  child.begun_ = std::chrono::steady_clock::now();
  const pid_t parent = ::getpid();
  child.pid_ = ::fork();
  if (child.pid_ < 0) fail_to_start(errno);
  if (child.pid_ == 0) {
    settle(parent);
    const int null = ::open("/dev/null", O_RDONLY), out = ::open(log.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0666);
    if (null < 0 || out < 0 || ::dup2(null, 0) < 0 || ::dup2(out, 1) < 0 || ::dup2(out, 2) < 0) ::_exit(70);
    if (null > 2) ::close(null);
    if (out > 2) ::close(out);
    ::execv(argv[0], argv.data());
    ::_exit(127);
  }
  ::setpgid(child.pid_, child.pid_);  // whichever of the two is first
  return child;
}

Child Child::fork_for(const std::function<std::string()>& work) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) fail_to_start(errno);
  Child child;
  child.begun_ = std::chrono::steady_clock::now();
  const pid_t parent = ::getpid();
  child.pid_ = ::fork();
  if (child.pid_ < 0) {
    ::close(ends[0]);
    ::close(ends[1]);
    fail_to_start(errno);
  }
  if (child.pid_ == 0) {
    settle(parent);
    int code = 0;
    try {
      const std::string text = work();  // below the 64 KB that a pipe holds
      if (::write(ends[1], text.data(), text.size()) != static_cast<ssize_t>(text.size())) code = 70;
    } catch (...) {
      code = 70;
    }
    ::_exit(code);
  }
  ::setpgid(child.pid_, child.pid_);
  ::close(ends[1]);
  child.pipe_ = ends[0];
  return child;
}

bool Child::has_ended(ChildEnd& end) {
  if (pid_ <= 0) return false;
  int status = 0;
  rusage used{};
  if (::wait4(pid_, &status, WNOHANG, &used) != pid_) return false;
  ::kill(-pid_, SIGKILL);  // whatever it left behind in its group
  pid_ = -1;
  end.code = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  end.wall_s = age_s();
  end.cpu_s = seconds(used.ru_utime) + seconds(used.ru_stime);
  end.peak_mb = static_cast<double>(used.ru_maxrss) / 1024;
  return true;
}

void Child::stop() {
  if (pid_ <= 0) return;
  ::kill(-pid_, asked_ ? SIGKILL : SIGTERM);
  asked_ = true;
}

std::string Child::text() {
  std::string text;
  char buffer[4096];
  for (ssize_t n; pipe_ >= 0 && ((n = ::read(pipe_, buffer, sizeof buffer)) > 0 || (n < 0 && errno == EINTR));)
    if (n > 0) text.append(buffer, static_cast<std::size_t>(n));
  return text;
}

double Child::age_s() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begun_).count();
}

CommandOutput output_of(const std::vector<std::string>& words) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) fail_to_start(errno);
  std::vector<char*> argv;
  for (const std::string& word : words) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  const pid_t pid = ::fork();
  if (pid == 0) {
    if (::dup2(ends[1], 1) < 0 || ::dup2(ends[1], 2) < 0) ::_exit(127);
    ::execvp(argv[0], argv.data());
    ::_exit(127);
  }
  ::close(ends[1]);
  CommandOutput output;
  char buffer[4096];
  for (ssize_t n; pid > 0 && ((n = ::read(ends[0], buffer, sizeof buffer)) > 0 || (n < 0 && errno == EINTR));)
    if (n > 0) output.text.append(buffer, static_cast<std::size_t>(n));
  ::close(ends[0]);
  int status = 0;
  while (pid > 0 && ::waitpid(pid, &status, 0) < 0 && errno == EINTR) {
  }
  if (pid > 0) output.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return output;
}

namespace {

sigset_t watched() {
  sigset_t set;
  ::sigemptyset(&set);
  ::sigaddset(&set, SIGCHLD);
  for (const int signal : kStopSignals) {
    struct sigaction now {};
    if (::sigaction(signal, nullptr, &now) == 0 && now.sa_handler == SIG_IGN) continue;  // nohup
    ::sigaddset(&set, signal);
  }
  return set;
}

}  // namespace

ChildSignals::ChildSignals() {
  const sigset_t set = watched();
  ::sigprocmask(SIG_BLOCK, &set, nullptr);
}

ChildSignals::~ChildSignals() {
  const sigset_t set = watched();
  ::sigprocmask(SIG_UNBLOCK, &set, nullptr);
}

int ChildSignals::wait(double seconds) {
  const sigset_t set = watched();
  seconds = std::max(0.0, seconds);
  timespec time{static_cast<time_t>(seconds), static_cast<long>(1e9 * (seconds - std::floor(seconds)))};
  const int signal = ::sigtimedwait(&set, nullptr, &time);
  return signal > 0 && signal != SIGCHLD ? signal : 0;
}

}  // namespace stackmesh
