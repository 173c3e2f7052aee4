#pragma once
#include <cstdint>

namespace stackmesh::worker {

// One request, one answer, in the machine's own byte order: both ends are the same program.
//   request: RequestHeader, switches, points (3 doubles each), sizes (a double each), triangles (3 int32 each)
//   answer:  hello (uint64, at once), AnswerHeader, text, points that were added (3 doubles each),
//            tets (4 int32 each), neighbours (4 int32 each, opposite the corner, -1 outside), faces (int32
//            each)
constexpr std::uint64_t kHello = 0x324b52574d545331;  // "1STMWRK2"
constexpr char kGuardVariable[] = "STACKMESH_TETGEN_WORKER";

struct RequestHeader {
  std::uint64_t magic = kHello;
  std::uint64_t switches_bytes = 0, points = 0, sizes = 0, triangles = 0;
};

enum Outcome : std::uint32_t {
  kDone = 0,    // filled (or, with -d, searched): the arrays follow
  kGaveUp = 1,  // TetGen ended in its own way; the text is what it said
  kDied = 2     // a signal; the text is what TetGen said last
};

struct AnswerHeader {
  std::uint64_t magic = kHello;
  std::uint32_t outcome = kDone;
  std::int32_t code = 0;  // TetGen's exit code, or the signal
  std::uint64_t text_bytes = 0, added_points = 0, tets = 0, faces = 0;
};

}  // namespace stackmesh::worker
