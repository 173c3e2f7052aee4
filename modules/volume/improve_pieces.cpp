#include "volume/improve_pieces.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include "base/disjoint_sets.h"
#include "base/parallel.h"

namespace stackmesh::volume {
namespace {

constexpr std::int32_t kUnseen = -2, kShared = -3;

struct Piece {
  TetMesh mesh;
  std::vector<std::int32_t> fixed;  // ids of its first points in the whole
};

/// `owner`: of each point, the piece whose tets alone have it.
Piece take_out(const TetMesh& mesh, std::size_t kept, const std::vector<std::int32_t>& owner,
               const std::vector<std::int32_t>& tets) {
  Piece out;
  std::vector<std::int32_t> number(mesh.points.size(), -1), movable;
  for (const std::int32_t t : tets)
    for (const std::int32_t v : mesh.tets[t]) {
      if (number[v] >= 0) continue;
      number[v] = 0;
      (static_cast<std::size_t>(v) < kept || owner[v] == kShared ? out.fixed : movable).push_back(v);
    }
  std::int32_t next = 0;
  for (const auto* ids : {&out.fixed, &movable})
    for (const std::int32_t v : *ids) {
      number[v] = next++;
      out.mesh.points.push_back(mesh.points[v]);
    }
  for (const std::int32_t t : tets) {
    std::array<std::int32_t, 4> v = mesh.tets[t];
    for (std::int32_t& x : v) x = number[x];
    out.mesh.tets.push_back(v);
    out.mesh.labels.push_back(mesh.labels[t]);
  }
  for (InterfaceTriangle f : mesh.faces) {
    for (std::int32_t& v : f.v) v = number[v];
    if (f.v[0] >= 0 && f.v[1] >= 0 && f.v[2] >= 0) out.mesh.faces.push_back(f);
  }
  return out;
}

}  // namespace

std::vector<std::int32_t> cut_into_pieces(const TetMesh& mesh, int count) {
  std::vector<Vec3> centres(mesh.tets.size());
  for (std::size_t t = 0; t < centres.size(); ++t)
    for (const std::int32_t v : mesh.tets[t]) centres[t] = centres[t] + mesh.points[v];
  std::vector<std::int32_t> order(mesh.tets.size()), piece(mesh.tets.size(), 0);
  std::iota(order.begin(), order.end(), 0);
  const std::function<void(std::size_t, std::size_t, std::int32_t, int)> cut = [&](std::size_t from, std::size_t to,
                                                                                   std::int32_t first, int pieces) {
    if (pieces == 1) {
      for (std::size_t i = from; i < to; ++i) piece[order[i]] = first;
      return;
    }
    double low[3] = {1e300, 1e300, 1e300}, high[3] = {-1e300, -1e300, -1e300};
    const auto at = [&](std::int32_t t, int k) { return k == 0 ? centres[t].x : k == 1 ? centres[t].y : centres[t].z; };
    for (std::size_t i = from; i < to; ++i)
      for (int k = 0; k < 3; ++k)
        low[k] = std::min(low[k], at(order[i], k)), high[k] = std::max(high[k], at(order[i], k));
    int axis = 0;
    for (int k = 1; k < 3; ++k)
      if (high[k] - low[k] > high[axis] - low[axis]) axis = k;
    const std::size_t middle = from + (to - from) / 2;
    std::nth_element(order.begin() + static_cast<std::ptrdiff_t>(from),
                     order.begin() + static_cast<std::ptrdiff_t>(middle),
                     order.begin() + static_cast<std::ptrdiff_t>(to), [&](std::int32_t a, std::int32_t b) {
                       const double x = at(a, axis), y = at(b, axis);
                       return x != y ? x < y : a < b;
                     });
    cut(from, middle, first, pieces / 2);
    cut(middle, to, first + pieces / 2, pieces / 2);
  };
  cut(0, order.size(), 0, count);
  return piece;
}

std::vector<std::int32_t> grow(const TetMesh& mesh, std::vector<char> marked, int rings, std::size_t* count) {
  std::vector<std::int32_t> piece(mesh.tets.size(), -1);
  for (int ring = 0; ring < rings; ++ring) {
    for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
      const auto& v = mesh.tets[t];
      if (marked[v[0]] || marked[v[1]] || marked[v[2]] || marked[v[3]]) piece[t] = 0;
    }
    for (std::size_t t = 0; t < mesh.tets.size(); ++t)
      if (piece[t] == 0)
        for (const std::int32_t v : mesh.tets[t]) marked[v] = 1;
  }
  DisjointSets sets(mesh.points.size());
  std::vector<std::int32_t> number(mesh.points.size(), -1);
  for (std::size_t t = 0; t < mesh.tets.size(); ++t)
    if (piece[t] == 0)
      for (int i = 1; i < 4; ++i) sets.join(mesh.tets[t][i], mesh.tets[t][0]);
  *count = 0;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    if (piece[t] < 0) continue;
    std::int32_t& n = number[sets.find(mesh.tets[t][0])];
    if (n < 0) n = static_cast<std::int32_t>((*count)++);
    piece[t] = n;
  }
  return piece;
}

std::vector<char> change_pieces(TetMesh& mesh, std::size_t kept, const std::vector<std::int32_t>& piece,
                                std::size_t count, int threads,
                                const std::function<void(std::size_t, ImproveMesh&)>& change) {
  std::vector<std::int32_t> owner(mesh.points.size(), kUnseen);
  std::vector<std::vector<std::int32_t>> tets(count);
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    if (piece[t] >= 0) tets[piece[t]].push_back(static_cast<std::int32_t>(t));
    for (const std::int32_t v : mesh.tets[t])
      owner[v] = owner[v] == kUnseen || owner[v] == piece[t] ? piece[t] : kShared;
  }
  std::vector<Piece> pieces(count);
  parallel_for(count, threads, [&](std::size_t i) {
    if (tets[i].empty()) return;
    Piece& p = pieces[i] = take_out(mesh, kept, owner, tets[i]);
    ImproveMesh work(p.mesh, p.fixed.size());
    change(i, work);
    work.give_back(p.mesh);
  });

  // The points that stay, then each piece's own.
  TetMesh out;
  out.space = mesh.space;
  std::vector<std::int32_t> number(mesh.points.size(), -1);
  std::vector<char> shared;
  for (std::size_t v = 0; v < mesh.points.size(); ++v) {
    const bool stays = v < kept || owner[v] == kShared || owner[v] == -1;
    if (!stays) continue;
    number[v] = static_cast<std::int32_t>(out.points.size());
    out.points.push_back(mesh.points[v]);
    shared.push_back(owner[v] == kShared);
  }
  out.tets.reserve(mesh.tets.size());
  out.labels.reserve(mesh.tets.size());
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    if (piece[t] >= 0) continue;
    std::array<std::int32_t, 4> v = mesh.tets[t];
    for (std::int32_t& x : v) x = number[x];
    out.tets.push_back(v);
    out.labels.push_back(mesh.labels[t]);
  }
  for (const Piece& p : pieces) {
    const auto fixed = static_cast<std::int32_t>(p.fixed.size());
    const std::int32_t offset = static_cast<std::int32_t>(out.points.size()) - fixed;
    out.points.insert(out.points.end(), p.mesh.points.begin() + fixed, p.mesh.points.end());
    for (std::array<std::int32_t, 4> v : p.mesh.tets) {
      for (std::int32_t& x : v) x = x < fixed ? number[p.fixed[x]] : x + offset;
      out.tets.push_back(v);
    }
    out.labels.insert(out.labels.end(), p.mesh.labels.begin(), p.mesh.labels.end());
  }
  shared.resize(out.points.size(), 0);
  mesh.points = std::move(out.points);
  mesh.tets = std::move(out.tets);
  mesh.labels = std::move(out.labels);
  return shared;
}

}  // namespace stackmesh::volume
