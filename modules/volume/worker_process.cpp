#include "volume/worker_process.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <optional>
#include <thread>

#include "base/cancel.h"
#include "base/error.h"
#include "volume/find_worker.h"
#include "volume/worker_protocol.h"

extern char** environ;

namespace stackmesh::worker {
namespace {

static_assert(sizeof(Vec3) == 3 * sizeof(double), "points go over the wire as they are");

class File {
 public:
  explicit File(int fd = -1) : fd_(fd) {}
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  ~File() { close_now(); }
  int get() const { return fd_; }
  void close_now() {
    if (fd_ >= 0) close(fd_);
    fd_ = -1;
  }

 private:
  int fd_;
};

// Above the standard three, so that handing it to the child cannot overwrite another of ours.
int lifted(int fd) {
  if (fd > 2) return fd;
  const int up = fcntl(fd, F_DUPFD_CLOEXEC, 3);
  close(fd);
  return up;
}

/// A child in its own process group; ended and reaped when this goes.
class Child {
 public:
  Child() = default;
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() { end(); }

  // 0, or the errno of the failure.
  int start(const Program& program, int channel) {
    const std::string path = program.path.empty() ? find_worker() : program.path;
    if (path.empty()) return ENOENT;
    std::vector<char*> argv{const_cast<char*>(path.c_str())};
    for (const std::string& arg : program.args) argv.push_back(const_cast<char*>(arg.c_str()));
    argv.push_back(nullptr);
    const std::string guard = std::string(kGuardVariable) + "=" + std::to_string(getpid());
    // TetGen asks for memory in many small blocks and gives none back: large pages, grown in large steps, save it a
    // fifth of its time. What the user has set comes last and counts.
    static constexpr char kTunables[] = "GLIBC_TUNABLES=";
    std::string tunables =
        std::string(kTunables) +
        "glibc.malloc.hugetlb=1:glibc.malloc.mmap_threshold=4294967296:glibc.malloc.top_pad=67108864";
    std::vector<char*> env;
    for (char** e = environ; *e; ++e) {
      if (std::strncmp(*e, kTunables, sizeof kTunables - 1) == 0) {
        tunables += std::string(":") + (*e + sizeof kTunables - 1);
      } else {
        env.push_back(*e);
      }
    }
    env.push_back(const_cast<char*>(guard.c_str()));
    env.push_back(const_cast<char*>(tunables.c_str()));
    env.push_back(nullptr);

    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, channel, STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, channel, STDOUT_FILENO);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    sigset_t none, reset;
    sigemptyset(&none);
    sigfillset(&reset);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setsigdefault(&attributes, &reset);
    posix_spawnattr_setpgroup(&attributes, 0);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
    pid_t pid = -1;
    const int error = posix_spawn(&pid, path.c_str(), &actions, &attributes, argv.data(), env.data());
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    if (error == 0) pid_ = pid;
    return error;
  }

  /// The wait status, once the child has ended by itself before the deadline.
  std::optional<int> wait_until(Clock::time_point deadline) {
    auto nap = std::chrono::microseconds(100);
    while (pid_ > 0) {
      int status = 0;
      const pid_t got = waitpid(pid_, &status, WNOHANG);
      if (got == pid_) {
        kill(-pid_, SIGKILL);  // whatever it left behind in its group
        pid_ = -1;
        return status;
      }
      if (got < 0 && errno != EINTR) {  // someone else reaps our children
        pid_ = -1;
        break;
      }
      if (Clock::now() >= deadline) break;
      std::this_thread::sleep_for(nap);
      nap = std::min<std::chrono::microseconds>(2 * nap, std::chrono::milliseconds(20));
    }
    return std::nullopt;
  }

  void end() {
    if (pid_ <= 0) return;
    kill(-pid_, SIGKILL);
    kill(pid_, SIGKILL);
    while (waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
    }
    pid_ = -1;
  }

 private:
  pid_t pid_ = -1;
};

struct Piece {
  char* at = nullptr;
  std::size_t left = 0;
};

Piece piece(const void* at, std::size_t bytes) {
  return {static_cast<char*>(const_cast<void*>(at)), bytes};
}

/// Sends the request and takes the answer at the same time, whichever the worker is ready for.
class Exchange {
 public:
  Exchange(int channel, const Request& request, Reply& reply) : channel_(channel), reply_(reply) {
    header_out_.switches_bytes = request.switches.size();
    header_out_.points = request.points->size();
    header_out_.sizes = request.sizes ? request.sizes->size() : 0;
    header_out_.triangles = request.corners->size() / 3;
    out_ = {piece(&header_out_, sizeof header_out_), piece(request.switches.data(), request.switches.size()),
            piece(request.points->data(), request.points->size() * sizeof(Vec3)),
            piece(request.sizes ? request.sizes->data() : nullptr, header_out_.sizes * sizeof(double)),
            piece(request.corners->data(), request.corners->size() * sizeof(std::int32_t))};
    in_ = {piece(&hello_, sizeof hello_), piece(&header_, sizeof header_)};
  }

  enum class End { answered, closed, nonsense, timed_out };

  End run(Clock::time_point deadline, const std::atomic<bool>* given_up) {
    for (;;) {
      const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
      stop_if_cancelled();  // the worker is ended on the way out
      if (left <= 0 || (given_up && *given_up)) return End::timed_out;
      pollfd p{channel_, static_cast<short>(sending() ? POLLIN | POLLOUT : POLLIN), 0};
      const int ready = poll(
          &p, 1, static_cast<int>(std::min<long long>(left, given_up || cancelling_monitor() != nullptr ? 50 : 1000)));
      if (ready < 0 && errno != EINTR) return End::closed;
      if (ready <= 0) continue;
      if ((p.revents & POLLOUT) && sending()) send_some();
      if (p.revents & (POLLIN | POLLHUP | POLLERR)) {
        const auto end = receive_some();
        if (end) return *end;
      }
    }
  }

  bool greeted() const { return stage_ > 0; }
  const AnswerHeader& header() const { return header_; }

 private:
  bool sending() const { return out_at_ < out_.size(); }

  void send_some() {
    while (sending()) {
      Piece& p = out_[out_at_];
      if (p.left == 0) {
        ++out_at_;
        continue;
      }
      const ssize_t n = send(channel_, p.at, p.left, MSG_DONTWAIT | MSG_NOSIGNAL);
      if (n < 0) {
        if (errno == EINTR) continue;
        if (errno != EAGAIN && errno != EWOULDBLOCK) out_at_ = out_.size();  // it is gone: read what it left
        return;
      }
      p.at += n;
      p.left -= static_cast<std::size_t>(n);
    }
  }

  std::optional<End> receive_some() {
    for (;;) {
      while (in_at_ < in_.size() && in_[in_at_].left == 0) {
        ++in_at_;
        if (!next_stage()) return End::nonsense;
      }
      if (in_at_ == in_.size()) return End::answered;
      Piece& p = in_[in_at_];
      const ssize_t n = recv(channel_, p.at, p.left, MSG_DONTWAIT);
      if (n == 0) return End::closed;
      if (n < 0) {
        if (errno == EINTR) continue;
        if (errno == EAGAIN || errno == EWOULDBLOCK) return std::nullopt;
        return End::closed;
      }
      p.at += n;
      p.left -= static_cast<std::size_t>(n);
    }
  }

  // After the hello and after the header: is it ours, and what follows.
  bool next_stage() {
    ++stage_;
    if (stage_ == 1) return hello_ == kHello;
    if (stage_ != 2) return true;
    constexpr std::uint64_t limit = std::uint64_t{1} << 31;
    if (header_.magic != kHello || header_.text_bytes > limit || header_.added_points > limit || header_.tets > limit ||
        header_.faces > limit)
      return false;
    reply_.text.resize(header_.text_bytes);
    reply_.added_points.resize(header_.added_points);
    reply_.tets.resize(4 * header_.tets);
    reply_.neighbours.resize(4 * header_.tets);
    reply_.faces.resize(header_.faces);
    in_.push_back(piece(reply_.text.data(), reply_.text.size()));
    in_.push_back(piece(reply_.added_points.data(), reply_.added_points.size() * sizeof(Vec3)));
    in_.push_back(piece(reply_.tets.data(), reply_.tets.size() * sizeof(std::int32_t)));
    in_.push_back(piece(reply_.neighbours.data(), reply_.neighbours.size() * sizeof(std::int32_t)));
    in_.push_back(piece(reply_.faces.data(), reply_.faces.size() * sizeof(std::int32_t)));
    return true;
  }

  int channel_;
  Reply& reply_;
  RequestHeader header_out_;
  std::vector<Piece> out_, in_;
  std::size_t out_at_ = 0, in_at_ = 0;
  int stage_ = 0;
  std::uint64_t hello_ = 0;
  AnswerHeader header_;
};

/// A signal that someone sends; the others are faults of the process itself.
bool is_from_outside(int signal) {
  const auto faults = {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGSYS, SIGTRAP};
  return std::find(faults.begin(), faults.end(), signal) == faults.end();
}

std::string how_it_ended(std::optional<int> status) {
  if (!status) return "ended its answer too early";
  if (WIFSIGNALED(*status)) {
    const char* name = strsignal(WTERMSIG(*status));
    return "was killed by signal " + std::to_string(WTERMSIG(*status)) + " (" + (name ? name : "?") + ")";
  }
  return "ended with exit code " + std::to_string(WEXITSTATUS(*status)) + " and no answer";
}

}  // namespace

Reply run(const Program& program, const Request& request, Clock::time_point deadline,
          const std::atomic<bool>* given_up) {
  Reply reply;
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    fail_internal("no channel to the volume mesher's worker: " + std::string(std::strerror(errno)), "fill_volume");
  const File ours(lifted(ends[0]));
  File theirs(lifted(ends[1]));

  Child child;
  const std::string name = program.path.empty() ? "stackmesh-tetgen" : program.path;
  if (const int error = child.start(program, theirs.get()); error != 0) {
    reply.kind = Reply::Kind::not_a_worker;
    reply.text = "the worker " + name + " could not be started: " + std::strerror(error);
    return reply;
  }
  theirs.close_now();

  Exchange exchange(ours.get(), request, reply);
  switch (exchange.run(deadline, given_up)) {
    case Exchange::End::answered: {
      const AnswerHeader& header = exchange.header();
      reply.kind = header.outcome == kDone     ? Reply::Kind::done
                   : header.outcome == kGaveUp ? Reply::Kind::gave_up
                                               : Reply::Kind::died;
      break;
    }
    case Exchange::End::timed_out:
      reply.kind = Reply::Kind::timed_out;
      break;
    case Exchange::End::nonsense:
      reply.kind = Reply::Kind::not_a_worker;
      reply.text = name + " does not answer as the volume mesher's worker does";
      break;
    case Exchange::End::closed: {
      const auto grace = std::min(deadline, Clock::now() + std::chrono::seconds(5));
      reply.kind = exchange.greeted() ? Reply::Kind::died : Reply::Kind::not_a_worker;
      const std::optional<int> status = child.wait_until(grace);
      reply.killed = status && WIFSIGNALED(*status) && is_from_outside(WTERMSIG(*status));
      reply.text = "the worker " + name + " " + how_it_ended(status);
      break;
    }
  }
  return reply;
}

}  // namespace stackmesh::worker
