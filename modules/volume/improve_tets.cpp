#include "volume/improve_tets.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>
#include <vector>

#include "base/cancel.h"
#include "volume/improve_mesh.h"
#include "volume/improve_moves.h"
#include "volume/improve_pieces.h"
#include "volume/tet_quality.h"

namespace stackmesh::volume {
namespace {

constexpr double kRadians = 3.14159265358979323846 / 180;

/// Tets below it are worked on longer.
constexpr double kWorstDeg = 14;
constexpr int kSearchRounds = 2;
constexpr int kMostTries = 60;                              // of the search, for each place
constexpr std::size_t kAllTries = 2000, kAllTets = 150000;  // of all tries together; a try costs what its tets do
constexpr std::size_t kLargestPlace = 4000;  // tets: where bad ones hang together over more, the surface is to blame

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
      if (m_.tets[t].alive() && m_.quality[t] < goal_ && m_.near_change(static_cast<std::int32_t>(t)))
        bad.push_back(static_cast<std::int32_t>(t));
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
    ++c_.steps;
    stop_if_cancelled();
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

/// The worst tets of a small mesh: all changes that helped are used up, so some are made that do not, at random, and
/// what follows from them. The best of all tries stays.
void search(ImproveMesh& mesh, const ImproveOptions& options, int tries, ImproveCounts& counts) {
  constexpr int kShakes = 3, kPatience = 20;
  const double goal = std::sin(kWorstDeg * kRadians);
  const auto worst_of = [&](const ImproveMesh& m) {  // tets below the goal, worst first
    std::vector<std::pair<double, std::int32_t>> worst;
    for (std::size_t t = 0; t < m.tets.size(); ++t)
      if (m.tets[t].alive() && m.quality[t] < goal) worst.emplace_back(m.quality[t], static_cast<std::int32_t>(t));
    std::sort(worst.begin(), worst.end());
    return worst;
  };
  const auto better = [](const auto& a, const auto& b) {
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
      if (std::abs(a[i].first - b[i].first) > 1e-3) return a[i].first > b[i].first;
    return a.size() < b.size();
  };
  std::uint64_t state = 0x9e3779b97f4a7c15u;
  const auto random = [&](std::size_t n) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    return static_cast<std::size_t>((state >> 33) % n);
  };
  auto worst = worst_of(mesh);
  for (int attempt = 0, in_vain = 0;
       attempt < tries && in_vain < kPatience && !worst.empty() && std::chrono::steady_clock::now() < options.deadline;
       ++attempt) {
    ++in_vain;
    ImproveMesh tried = mesh;
    tried.begin_changes();  // what lies elsewhere was tried in vain
    ImproveMoves moves(tried);
    moves.accept_from(1e-3);
    for (int shake = 0; shake < 1 + static_cast<int>(random(kShakes)); ++shake) {
      std::int32_t t = worst[random(std::min<std::size_t>(worst.size(), 3))].second;
      for (std::size_t step = random(3); step > 0 && tried.tets[t].alive(); --step)  // a tet near it
        if (const std::int32_t next = tried.tets[t].n[random(4)]; next >= 0) t = next;
      if (!tried.tets[t].alive()) continue;
      switch (random(4)) {
        case 0:
          moves.remove_edge(t);
          break;
        case 1:
          moves.remove_face(t);
          break;
        case 2:
          moves.collapse(t);
          break;
        default:
          moves.insert(t, goal, random(2) == 0);
          break;
      }
    }
    ImproveCounts done;
    Improver(tried, options, done).run();
    counts.steps += done.steps;
    auto now = worst_of(tried);
    if (!better(now, worst)) continue;
    mesh = std::move(tried), worst = std::move(now);
    ++counts.searched;
    in_vain = 0;
  }
}

void improve_tets(TetMesh& mesh, std::size_t kept, const ImproveOptions& options, ImproveCounts& counts) {
  constexpr std::size_t kPiece = 20000;  // tets
  std::size_t pieces = 1;
  while (mesh.tets.size() / pieces > 2 * kPiece) pieces *= 2;
  const auto change = [&](const std::vector<std::int32_t>& piece, std::size_t count, const auto& with) {
    std::vector<ImproveCounts> done(count);
    std::vector<char> shared = change_pieces(mesh, kept, piece, count, options.threads,
                                             [&](std::size_t i, ImproveMesh& work) { with(work, done[i]); });
    for (const ImproveCounts& d : done) {
      counts.moved += d.moved, counts.edges += d.edges, counts.faces += d.faces;
      counts.collapsed += d.collapsed, counts.inserted += d.inserted, counts.searched += d.searched,
          counts.steps += d.steps;
      counts.passes = std::max(counts.passes, d.passes);
    }
    return shared;
  };
  const auto improve = [&](ImproveMesh& work, ImproveCounts& done) { Improver(work, options, done).run(); };
  // Points of tets below an angle; `of` says which tets count.
  const auto points_below = [&](double deg, const auto& of) {
    std::vector<char> marks(mesh.points.size(), 0);
    const double goal = std::sin(deg * kRadians);
    for (const auto& t : mesh.tets)
      if (of(t) && tet_quality(mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]], mesh.points[t[3]]) < goal)
        for (const std::int32_t v : t) marks[v] = 1;
    return marks;
  };

  std::size_t count = 0;
  const std::vector<char> cut = change(cut_into_pieces(mesh, static_cast<int>(pieces)), pieces, improve);
  if (pieces > 1) {
    std::vector<std::int32_t> along = grow(
        mesh,
        points_below(options.goal_deg, [&](const auto& t) { return cut[t[0]] || cut[t[1]] || cut[t[2]] || cut[t[3]]; }),
        2, &count);
    for (std::int32_t& p : along)
      if (p >= 0) p %= static_cast<std::int32_t>(pieces);
    change(along, pieces, improve);
  }
  // The fewer are left, the longer each is searched for.
  for (int round = 0; round < kSearchRounds; ++round) {
    const std::vector<std::int32_t> worst =
        grow(mesh, points_below(kWorstDeg, [](const auto&) { return true; }), 3, &count);
    const auto size = static_cast<std::size_t>(
        std::count_if(worst.begin(), worst.end(), [](std::int32_t piece) { return piece >= 0; }));
    const int tries =
        count == 0 ? 0 : std::min({kMostTries, static_cast<int>(kAllTries / count), static_cast<int>(kAllTets / size)});
    if (tries == 0 || size / count > kLargestPlace) break;
    const std::size_t before = counts.searched;
    change(worst, count, [&](ImproveMesh& work, ImproveCounts& done) { search(work, options, tries, done); });
    if (counts.searched == before) break;
  }
}

}  // namespace stackmesh::volume
