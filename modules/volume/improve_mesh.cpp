#include "volume/improve_mesh.h"

#include <algorithm>
#include <unordered_map>

#include "volume/label_tets.h"
#include "volume/tet_quality.h"

namespace stackmesh::volume {
namespace {

constexpr int kFace[4][3] = {{1, 2, 3}, {0, 2, 3}, {0, 1, 3}, {0, 1, 2}};

std::array<std::int32_t, 3> sorted(std::array<std::int32_t, 3> t) {
  if (t[0] > t[1]) std::swap(t[0], t[1]);
  if (t[1] > t[2]) std::swap(t[1], t[2]);
  if (t[0] > t[1]) std::swap(t[0], t[1]);
  return t;
}

}  // namespace

ImproveMesh::Face ImproveMesh::face_of(const Corners& v, int slot, std::int32_t tet, bool fresh) {
  return {sorted({v[kFace[slot][0]], v[kFace[slot][1]], v[kFace[slot][2]]}), tet, slot, fresh};
}

ImproveMesh::ImproveMesh(const TetMesh& mesh, std::size_t kept)
    : points(mesh.points),
      tets(mesh.tets.size()),
      quality(mesh.tets.size()),
      movable(mesh.points.size(), 0),
      kept_(kept) {
  tet_of_.assign(points.size(), -1);
  for (std::size_t t = 0; t < tets.size(); ++t) {
    tets[t].v = mesh.tets[t];
    tets[t].label = mesh.labels[t];
    quality[t] = quality_of(tets[t].v);
    for (const std::int32_t v : tets[t].v) tet_of_[v] = static_cast<std::int32_t>(t);
  }
  stamps_.assign(tets.size(), 0);
  for (std::size_t p = kept; p < points.size(); ++p) movable[p] = 1;

  // Neighbours: faces listed by their smallest corner, walls among them.
  struct Entry {
    std::int32_t middle, high, tet;
    int slot;  // -1: a wall
  };
  const auto each = [&](auto visit) {
    for (std::size_t t = 0; t < tets.size(); ++t)
      for (int i = 0; i < 4; ++i) {
        const Face f = face_of(tets[t].v, i, static_cast<std::int32_t>(t), false);
        visit(f.key, f.tet, i);
      }
    for (const InterfaceTriangle& f : mesh.faces) visit(sorted(f.v), -1, -1);
  };
  std::vector<std::int64_t> begin(points.size() + 1, 0);
  each([&](const auto& key, std::int32_t, int) { ++begin[key[0] + 1]; });
  for (std::size_t p = 0; p < points.size(); ++p) begin[p + 1] += begin[p];
  std::vector<Entry> entries(begin.back());
  std::vector<std::int64_t> next(begin.begin(), begin.end() - 1);
  each([&](const auto& key, std::int32_t t, int slot) { entries[next[key[0]]++] = {key[1], key[2], t, slot}; });
  for (std::size_t p = 0; p < points.size(); ++p) {
    const auto from = entries.begin() + begin[p], to = entries.begin() + begin[p + 1];
    std::sort(from, to, [](const Entry& a, const Entry& b) {
      return a.middle != b.middle ? a.middle < b.middle : a.high != b.high ? a.high < b.high : a.tet < b.tet;
    });
    for (auto i = from; i != to;) {
      auto j = i;
      while (j != to && j->middle == i->middle && j->high == i->high) ++j;
      if (j - i == 2 && i->slot >= 0) {  // two tets and no wall
        tets[i->tet].n[i->slot] = i[1].tet;
        tets[i[1].tet].n[i[1].slot] = i->tet;
      }
      i = j;
    }
  }
  for (const InterfaceTriangle& f : mesh.faces)
    for (const std::int32_t v : f.v) movable[v] = 0;
}

double ImproveMesh::quality_of(const Corners& v) const {
  return tet_quality(points[v[0]], points[v[1]], points[v[2]], points[v[3]]);
}

void ImproveMesh::star(std::int32_t vertex, std::vector<std::int32_t>& around) {
  around.clear();
  const std::int32_t first = tet_of_[vertex];
  if (first < 0) return;
  begin_marks();
  mark(first);
  around.push_back(first);
  for (std::size_t at = 0; at < around.size(); ++at) {
    const Tet& t = tets[around[at]];
    const int slot = t.slot(vertex);
    for (int i = 0; i < 4; ++i)
      if (i != slot && t.n[i] >= 0 && !marked(t.n[i])) {
        mark(t.n[i]);
        around.push_back(t.n[i]);
      }
  }
}

bool ImproveMesh::ring(std::int32_t t, std::int32_t a, std::int32_t b, std::size_t limit,
                       std::vector<std::int32_t>& around, std::vector<std::int32_t>& ring) const {
  around.clear();
  ring.clear();
  // The other two corners c, d of t, so that (a, b, c, d) is an even permutation of its corners.
  const int i = tets[t].slot(a), j = tets[t].slot(b);
  static constexpr int kOthers[4][4][2] = {{{0, 0}, {2, 3}, {3, 1}, {1, 2}},
                                           {{3, 2}, {0, 0}, {0, 3}, {2, 0}},
                                           {{1, 3}, {3, 0}, {0, 0}, {0, 1}},
                                           {{2, 1}, {0, 2}, {1, 0}, {0, 0}}};
  std::int32_t c = tets[t].v[kOthers[i][j][0]], d = tets[t].v[kOthers[i][j][1]];
  for (std::int32_t at = t;;) {
    if (around.size() == limit) return false;
    around.push_back(at);
    ring.push_back(c);
    const std::int32_t next = tets[at].n[tets[at].slot(c)];
    if (next < 0) return false;
    if (next == t) return true;
    std::int32_t e = -1;
    for (const std::int32_t v : tets[next].v)
      if (v != a && v != b && v != d) e = v;
    c = d, d = e, at = next;
  }
}

bool ImproveMesh::replace(const std::vector<std::int32_t>& old, const std::vector<Corners>& fresh) {
  for (const Corners& v : fresh)
    if (orientation(points[v[0]], points[v[1]], points[v[2]], points[v[3]]) <= 0) return false;
  begin_marks();
  for (const std::int32_t t : old) mark(t);
  faces_.clear();
  for (const std::int32_t t : old)
    for (int i = 0; i < 4; ++i)
      if (const std::int32_t n = tets[t].n[i]; n < 0 || !marked(n)) faces_.push_back(face_of(tets[t].v, i, n, false));
  for (std::size_t k = 0; k < fresh.size(); ++k)
    for (int i = 0; i < 4; ++i) faces_.push_back(face_of(fresh[k], i, static_cast<std::int32_t>(k), true));
  std::sort(faces_.begin(), faces_.end(), [](const Face& a, const Face& b) {
    return a.key != b.key ? a.key < b.key : a.fresh != b.fresh ? a.fresh : a.tet < b.tet;
  });
  if (faces_.size() % 2 != 0) return false;
  for (std::size_t i = 0; i < faces_.size(); i += 2) {
    if (faces_[i].key != faces_[i + 1].key || !faces_[i].fresh) return false;
    if (i + 2 < faces_.size() && faces_[i + 2].key == faces_[i].key) return false;
  }

  // The neighbours outside, and which of their faces it is, before the old tets go.
  mate_.assign(faces_.size(), -1);
  for (std::size_t i = 1; i < faces_.size(); i += 2)
    if (!faces_[i].fresh && faces_[i].tet >= 0) {
      const Tet& outside = tets[faces_[i].tet];
      for (int s = 0; s < 4; ++s)
        if (outside.n[s] >= 0 && marked(outside.n[s]) && face_of(outside.v, s, 0, false).key == faces_[i].key)
          mate_[i] = s;
    }
  const Label label = tets[old.front()].label;
  for (const std::int32_t t : old)
    for (const std::int32_t v : tets[t].v) tet_of_[v] = -1;
  ids_.clear();
  for (std::size_t k = 0; k < fresh.size(); ++k) {
    std::int32_t id;
    if (k < old.size()) {
      id = old[k];
    } else if (!free_.empty()) {
      id = free_.back();
      free_.pop_back();
    } else {
      id = static_cast<std::int32_t>(tets.size());
      tets.emplace_back();
      quality.push_back(0);
      stamps_.push_back(0);
    }
    ids_.push_back(id);
    tets[id].v = fresh[k];
    tets[id].n = {-1, -1, -1, -1};
    tets[id].label = label;
    quality[id] = quality_of(fresh[k]);
    for (const std::int32_t v : fresh[k]) tet_of_[v] = id;
    note_change(id);
  }
  for (std::size_t k = fresh.size(); k < old.size(); ++k) {
    tets[old[k]] = Tet{};
    quality[old[k]] = 2;
    free_.push_back(old[k]);
  }
  for (std::size_t i = 0; i < faces_.size(); i += 2) {
    const Face &f = faces_[i], &g = faces_[i + 1];
    const std::int32_t mine = ids_[f.tet], other = g.fresh ? ids_[g.tet] : g.tet;
    tets[mine].n[f.slot] = other;
    if (other >= 0) tets[other].n[g.fresh ? g.slot : mate_[i + 1]] = mine;
  }
  return true;
}

std::int32_t ImproveMesh::add_point(const Vec3& p) {
  points.push_back(p);
  movable.push_back(1);
  tet_of_.push_back(-1);
  if (!changed_.empty()) changed_.push_back(1);
  return static_cast<std::int32_t>(points.size()) - 1;
}

void ImproveMesh::drop_last_point() {
  points.pop_back();
  movable.pop_back();
  tet_of_.pop_back();
  if (!changed_.empty()) changed_.pop_back();
}

void ImproveMesh::give_back(TetMesh& mesh) const {
  std::vector<std::int32_t> number(points.size(), -1);
  for (const Tet& t : tets)
    if (t.alive())
      for (const std::int32_t v : t.v) number[v] = 0;
  mesh.points.resize(kept_);
  for (std::size_t p = 0; p < points.size(); ++p) {
    if (p < kept_) {
      number[p] = static_cast<std::int32_t>(p);
    } else if (number[p] == 0) {
      number[p] = static_cast<std::int32_t>(mesh.points.size());
      mesh.points.push_back(points[p]);
    }
  }
  mesh.tets.clear();
  mesh.labels.clear();
  for (const Tet& t : tets) {
    if (!t.alive()) continue;
    mesh.tets.push_back(t.v);
    for (std::int32_t& v : mesh.tets.back()) v = number[v];
    mesh.labels.push_back(t.label);
  }
}

}  // namespace stackmesh::volume
