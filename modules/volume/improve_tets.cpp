#include "volume/improve_tets.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "volume/improve_mesh.h"
#include "volume/improve_moves.h"
#include "volume/improve_pieces.h"
#include "volume/tet_quality.h"

namespace stackmesh::volume {
namespace {

constexpr double kRadians = 3.14159265358979323846 / 180;

class Improver {
 public:
  Improver(ImproveMesh& mesh, const ImproveOptions& options, ImproveCounts& counts)
      : m_(mesh), moves_(mesh), goal_(std::sin(options.goal_deg * kRadians)), options_(options), c_(counts) {}

  void run() {
    double sum_before = badness();
    for (int pass = 0; pass < options_.passes; ++pass) {
      const std::vector<std::int32_t> bad = worst_first();
      if (bad.empty()) break;
      ++c_.passes;
      std::size_t done = 0;
      for (std::size_t i = 0; i < bad.size(); ++i) {
        if (i % 64 == 0 && std::chrono::steady_clock::now() >= options_.deadline) return;
        done += mend(bad[i], pass);
      }
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

void improve_tets(TetMesh& mesh, std::size_t kept, const ImproveOptions& options, ImproveCounts& counts) {
  constexpr std::size_t kPiece = 20000;  // tets
  int pieces = 1;
  while (mesh.tets.size() / static_cast<std::size_t>(pieces) > 2 * kPiece) pieces *= 2;
  const auto change = [&](const std::vector<std::int32_t>& piece, std::size_t count) {
    std::vector<ImproveCounts> done(count);
    std::vector<char> shared = change_pieces(mesh, kept, piece, count, options.threads,
                                             [&](std::size_t i, ImproveMesh& work) { Improver(work, options, done[i]).run(); });
    for (const ImproveCounts& d : done) {
      counts.moved += d.moved, counts.edges += d.edges, counts.faces += d.faces;
      counts.collapsed += d.collapsed, counts.inserted += d.inserted;
      counts.passes = std::max(counts.passes, d.passes);
    }
    return shared;
  };
  const std::vector<char> cut = change(cut_into_pieces(mesh, pieces), static_cast<std::size_t>(pieces));
  if (pieces == 1) return;
  const double goal = std::sin(options.goal_deg * kRadians);
  std::vector<char> bad(mesh.points.size(), 0);
  for (const auto& t : mesh.tets)
    if ((cut[t[0]] || cut[t[1]] || cut[t[2]] || cut[t[3]]) && tet_quality(mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]], mesh.points[t[3]]) < goal)
      for (const std::int32_t v : t) bad[v] = 1;
  change(grow(mesh, std::move(bad), 2), 1);
}

}  // namespace stackmesh::volume
