#include "volume/worker/tetgen_worker.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <tetgen.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <vector>

#include "volume/worker_protocol.h"

namespace stackmesh {
namespace {

int answer_fd = -1;
int log_fd = -1;  // what TetGen prints
volatile sig_atomic_t answering = 0;

bool read_all(int fd, void* to, std::size_t bytes) {
  auto* p = static_cast<char*>(to);
  while (bytes > 0) {
    const ssize_t n = read(fd, p, bytes);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    p += n;
    bytes -= static_cast<std::size_t>(n);
  }
  return true;
}

bool write_all(int fd, const void* from, std::size_t bytes) {
  const auto* p = static_cast<const char*>(from);
  while (bytes > 0) {
    const ssize_t n = write(fd, p, bytes);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    p += n;
    bytes -= static_cast<std::size_t>(n);
  }
  return true;
}

/// Sends the end of what TetGen printed and ends the process. Safe in a signal handler: no allocation, no
/// stdio.
[[noreturn]] void answer_failure(worker::Outcome outcome, int code) {
  if (answering) _exit(71);
  answering = 1;
  static char text[8192];
  struct stat log {};
  off_t from = 0;
  if (fstat(log_fd, &log) == 0) from = std::max<off_t>(0, log.st_size - static_cast<off_t>(sizeof text));
  const ssize_t got = pread(log_fd, text, sizeof text, from);
  worker::AnswerHeader header;
  header.outcome = outcome;
  header.code = code;
  header.text_bytes = got > 0 ? static_cast<std::uint64_t>(got) : 0;
  const bool sent = write_all(answer_fd, &header, sizeof header) && write_all(answer_fd, text, header.text_bytes);
  _exit(sent ? 0 : 72);
}

void on_signal(int signal) {
  answer_failure(worker::kDied, signal);
}
[[noreturn]] void on_terminate() {
  answer_failure(worker::kGaveUp, 0);
}

// TetGen frees its mesh, throws, and its destructor frees again: however it dies, the answer gets out.
void die_quietly() {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  const char* const parent = std::getenv(worker::kGuardVariable);
  // it had ended before
  if (parent != nullptr && std::atol(parent) > 1 && std::atol(parent) != static_cast<long>(getppid())) _exit(74);
  signal(SIGXFSZ, SIG_IGN);  // what TetGen prints may pass a bound on files; it is in memory
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  static char stack[1 << 16];
  stack_t alternate{};
  alternate.ss_sp = stack;
  alternate.ss_size = sizeof stack;
  sigaltstack(&alternate, nullptr);
  struct sigaction action {};
  action.sa_handler = on_signal;
  action.sa_flags = SA_ONSTACK | SA_RESETHAND;
  for (const int s : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL}) sigaction(s, &action, nullptr);
  std::set_terminate(on_terminate);
}

// Keeps the answer's channel to ourselves, and TetGen's prints in memory.
bool take_over_output() {
  answer_fd = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 3);
  log_fd = memfd_create("tetgen-log", MFD_CLOEXEC);
  if (answer_fd < 0 || log_fd < 0) return false;
  if (dup2(log_fd, STDOUT_FILENO) < 0 || dup2(log_fd, STDERR_FILENO) < 0) return false;
  return std::setvbuf(stdout, nullptr, _IONBF, 0) == 0;
}

/// The request in TetGen's structures: one block of memory each, never freed (the process ends instead).
bool read_request(std::string& switches, tetgenio& in) {
  worker::RequestHeader header;
  if (!read_all(STDIN_FILENO, &header, sizeof header) || header.magic != worker::kHello) return false;
  switches.resize(header.switches_bytes);
  if (!read_all(STDIN_FILENO, switches.data(), switches.size())) return false;
  in.firstnumber = 0;
  in.numberofpoints = static_cast<int>(header.points);
  in.pointlist = new REAL[3 * header.points];
  if (!read_all(STDIN_FILENO, in.pointlist, 3 * header.points * sizeof(REAL))) return false;
  if (header.sizes > 0) {
    if (header.sizes != header.points) return false;
    in.numberofpointmtrs = 1;
    in.pointmtrlist = new REAL[header.sizes];
    if (!read_all(STDIN_FILENO, in.pointmtrlist, header.sizes * sizeof(REAL))) return false;
  }
  const std::size_t count = header.triangles;
  auto* corners = new int[3 * count];
  if (!read_all(STDIN_FILENO, corners, 3 * count * sizeof(int))) return false;
  auto* polygons = new tetgenio::polygon[count];
  in.numberoffacets = static_cast<int>(count);
  in.facetlist = new tetgenio::facet[count];
  in.facetmarkerlist = new int[count];
  for (std::size_t i = 0; i < count; ++i) {
    polygons[i].vertexlist = corners + 3 * i;
    polygons[i].numberofvertices = 3;
    in.facetlist[i] = {polygons + i, 1, nullptr, 0};
    in.facetmarkerlist[i] = static_cast<int>(i) + 1;
  }
  return true;
}

bool send_answer(const tetgenio& in, const tetgenio& out, bool search_only) {
  worker::AnswerHeader header;
  const auto known = static_cast<std::size_t>(in.numberofpoints);
  std::vector<std::int32_t> faces;
  if (search_only) {
    for (int i = 0; i < out.numberoftrifaces; ++i)
      if (out.trifacemarkerlist) faces.push_back(out.trifacemarkerlist[i] - 1);
    header.faces = faces.size();
  } else {
    header.tets = static_cast<std::uint64_t>(out.numberoftetrahedra);
    if (header.tets > 0) header.added_points = static_cast<std::size_t>(out.numberofpoints) - known;
  }
  answering = 1;
  return write_all(answer_fd, &header, sizeof header) &&
         write_all(answer_fd, out.pointlist + 3 * known, 3 * header.added_points * sizeof(double)) &&
         write_all(answer_fd, out.tetrahedronlist, 4 * header.tets * sizeof(int)) &&
         write_all(answer_fd, out.neighborlist, 4 * header.tets * sizeof(int)) &&
         write_all(answer_fd, faces.data(), faces.size() * sizeof(std::int32_t));
}

}  // namespace

int tetgen_worker_main() {
  static_assert(sizeof(REAL) == sizeof(double) && sizeof(int) == sizeof(std::int32_t));
  if (!take_over_output()) return 70;
  die_quietly();
  if (!write_all(answer_fd, &worker::kHello, sizeof worker::kHello)) return 72;

  std::string switches;
  auto* in = new tetgenio;
  auto* out = new tetgenio;
  if (!read_request(switches, *in)) return 73;
  const bool search_only = switches.find('d') != std::string::npos;
  tetgenbehavior behaviour;
  if (!behaviour.parse_commandline(switches.data())) answer_failure(worker::kGaveUp, 10);
  try {
    tetrahedralize(&behaviour, in, out);
  } catch (int code) {
    answer_failure(worker::kGaveUp, code);
  } catch (const std::exception&) {
    answer_failure(worker::kGaveUp, 1);
  }
  if (out->numberoftetrahedra > 0 && out->numberofpoints < in->numberofpoints) answer_failure(worker::kGaveUp, 2);
  _exit(send_answer(*in, *out, search_only) ? 0 : 72);
}

}  // namespace stackmesh
