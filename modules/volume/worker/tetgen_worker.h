#pragma once

namespace stackmesh {

/// The worker's side of fill_volume(): reads one request from stdin, answers on stdout, and never lets TetGen print.
/// @return the exit code of the process
int tetgen_worker_main();

}  // namespace stackmesh
