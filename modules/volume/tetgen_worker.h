#pragma once

namespace stackmesh {

/// The worker's side of fill_volume(): reads one request from stdin, answers on stdout, and never lets TetGen
/// print. A program that calls fill_volume() with the default options calls this first thing in main() when
/// its first argument is "--tetgen-worker", and returns what this returns.
int tetgen_worker_main();

}  // namespace stackmesh
