// The volume mesher's worker alone: it starts faster than the whole program, which random stacks need thousands of times.
#include "volume/tetgen_worker.h"

int main() { return stackmesh::tetgen_worker_main(); }
