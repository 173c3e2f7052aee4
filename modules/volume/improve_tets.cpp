#include "volume/improve_tets.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "volume/improve_mesh.h"
#include "volume/improve_moves.h"

namespace stackmesh::volume {
namespace {

class Improver {
 public:
  Improver(ImproveMesh& mesh, const ImproveOptions& options, ImproveCounts& counts)
      : m_(mesh), moves_(mesh), goal_(std::sin(options.goal_deg * 3.14159265358979323846 / 180)), options_(options), c_(counts) {}

  void run() {
    double sum_before = badness();
    for (int pass = 0; pass < options_.passes; ++pass) {
      const std::vector<std::int32_t> bad = worst_first();
      if (bad.empty()) break;
      ++c_.passes;
      std::size_t done = 0;
      for (const std::int32_t t : bad) done += mend(t, pass);
      const double sum = badness();
      if (done == 0 || sum > 0.995 * sum_before) {
        if (pass >= 3) break;
      }
      sum_before = sum;
    }
  }

 private:
  std::vector<std::int32_t> worst_first() const {
    std::vector<std::int32_t> bad;
    for (std::size_t t = 0; t < m_.tets.size(); ++t)
      if (m_.tets[t].alive() && m_.quality[t] < goal_) bad.push_back(static_cast<std::int32_t>(t));
    std::sort(bad.begin(), bad.end(), [&](std::int32_t a, std::int32_t b) {
      return m_.quality[a] != m_.quality[b] ? m_.quality[a] < m_.quality[b] : a < b;
    });
    return bad;
  }

  double badness() const {
    double sum = 0;
    for (std::size_t t = 0; t < m_.tets.size(); ++t)
      if (m_.tets[t].alive() && m_.quality[t] < goal_) sum += 1 - m_.quality[t] / goal_;
    return sum;
  }

  bool mend(std::int32_t t, int pass) {
    const auto bad = [&] { return m_.tets[t].alive() && m_.quality[t] < goal_; };
    if (!bad()) return false;
    if (moves_.remove_edge(t)) return ++c_.edges, true;
    if (moves_.remove_face(t)) return ++c_.faces, true;
    bool any = false;
    const auto v = m_.tets[t].v;
    for (const std::int32_t u : v)
      if (moves_.smooth(u, goal_)) {
        ++c_.moved;
        any = true;
        if (!bad()) return true;
      }
    if (any) return true;
    if (pass < 1) return false;
    if (moves_.collapse(t)) return ++c_.collapsed, true;
    if (moves_.insert(t, goal_, pass >= 2 && m_.quality[t] < 0.75 * goal_)) return ++c_.inserted, true;
    return false;
  }

  ImproveMesh& m_;
  ImproveMoves moves_;
  double goal_;
  const ImproveOptions& options_;
  ImproveCounts& c_;
};

}  // namespace

RawTets improve_tets(TetMesh& mesh, std::size_t kept, const ImproveOptions& options, ImproveCounts& counts) {
  ImproveMesh work(mesh, kept);
  Improver(work, options, counts).run();
  RawTets raw;
  work.give_back(mesh, raw.neighbours);
  raw.corners.reserve(4 * mesh.tets.size());
  for (const auto& t : mesh.tets) raw.corners.insert(raw.corners.end(), t.begin(), t.end());
  return raw;
}

}  // namespace stackmesh::volume
