// This folder's executable is its own worker, so it has its own main (link GTest::gtest, not gtest_main).
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <string>

#include "volume/worker/tetgen_worker.h"
#include "volume/worker_protocol.h"

namespace {

// A worker that dies unless the switches contain `wanted`: it looks at the request without taking it.
int picky_worker(const std::string& wanted) {
  using stackmesh::worker::RequestHeader;
  char buffer[sizeof(RequestHeader) + 64] = {};
  ssize_t got = 0;
  while (got < static_cast<ssize_t>(sizeof buffer)) {
    got = recv(STDIN_FILENO, buffer, sizeof buffer, MSG_PEEK);
    if (got <= 0) return 1;
  }
  RequestHeader header;
  std::memcpy(&header, buffer, sizeof header);
  const std::string switches(buffer + sizeof header, std::min<std::size_t>(header.switches_bytes, 64));
  if (switches.find(wanted) != std::string::npos) return stackmesh::tetgen_worker_main();
  const auto hello = stackmesh::worker::kHello;
  if (write(STDOUT_FILENO, &hello, sizeof hello) != sizeof hello) return 1;
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  raise(SIGABRT);  // a fault of its own: a worker that is killed from outside is started again
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 2 && std::strcmp(argv[1], "--picky-worker") == 0) return picky_worker(argv[2]);
  ::testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
