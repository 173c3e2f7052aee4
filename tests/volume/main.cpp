// This folder's executable is its own worker, so it has its own main (link GTest::gtest, not gtest_main).
#include <gtest/gtest.h>

#include <cstring>

#include "volume/tetgen_worker.h"

int main(int argc, char** argv) {
  if (argc > 1 && std::strcmp(argv[1], "--tetgen-worker") == 0) return stackmesh::tetgen_worker_main();
  ::testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
