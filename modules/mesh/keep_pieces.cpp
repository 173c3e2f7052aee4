#include "mesh/keep_pieces.h"

#include <algorithm>
#include <cstdio>
#include <map>

#include "base/disjoint_sets.h"
#include "base/error.h"
#include "base/warning.h"
#include "validate/boundaries.h"

namespace stackmesh {
namespace {

struct Piece {
  std::int32_t id = 0;
  double volume_mm3 = 0;
};

/// Sorts a label's pieces and says which go.
std::vector<std::int32_t> left_out(Label label, std::vector<Piece> pieces, const PieceOptions& o,
                                   std::vector<Warning>& warnings) {
  std::stable_sort(pieces.begin(), pieces.end(),
                   [](const Piece& a, const Piece& b) { return a.volume_mm3 > b.volume_mm3; });
  std::vector<std::int32_t> out;
  double volume = 0;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const bool kept = (!o.keep_largest || i < static_cast<std::size_t>(*o.keep_largest)) &&
                      (!o.min_piece_mm3 || pieces[i].volume_mm3 >= *o.min_piece_mm3);
    if (kept) continue;
    out.push_back(pieces[i].id);
    volume += pieces[i].volume_mm3;
  }
  if (!out.empty()) {
    char text[32];
    std::snprintf(text, sizeof text, "%.4g", volume);
    warnings.push_back(warning_at(WarningCode::pieces_left_out, "label " + std::to_string(label),
                                  std::to_string(out.size()) + " of its " + std::to_string(pieces.size()) +
                                      " pieces, " + text +
                                      " mm3 together, are left out, as --keep-largest or --min-piece asks"));
  }
  return out;
}

/// Does the closed surface of the triangle sides of `piece` go round p? By a ray that is parallel to no axis.
bool goes_round(const InterfaceComplex& c, const Boundaries& b, std::int32_t piece, const Vec3& p) {
  const Vec3 along = {0.0171, 0.0313, 1};
  bool inside = false;
  for (std::size_t t = 0; t < c.triangles.size(); ++t) {
    if (b.piece[t][0] != piece && b.piece[t][1] != piece) continue;
    const auto& v = c.triangles[t].v;
    const Vec3 u = c.points[v[0]] - p, e = c.points[v[1]] - c.points[v[0]], f = c.points[v[2]] - c.points[v[0]];
    const Vec3 h = cross(along, f);
    const double det = dot(e, h);
    if (det == 0) continue;
    const double s = -dot(u, h) / det;
    const Vec3 q = cross((-1.0) * u, e);
    const double r = dot(along, q) / det, way = dot(f, q) / det;
    if (s >= 0 && r >= 0 && s + r <= 1 && way > 0) inside = !inside;
  }
  return inside;
}

[[noreturn]] void fail_empty(const PieceOptions& o) {
  char text[48];
  std::snprintf(text, sizeof text, "--min-piece %.6g", *o.min_piece_mm3);
  fail_usage("no piece of any label is as large", text, "ask for a smaller one");
}

}  // namespace

void keep_pieces(LabelVolume& volume, const PieceOptions& options, std::vector<Warning>& warnings) {
  if (!options.any()) return;
  const std::array<int, 3> n = volume.size;
  std::vector<std::uint16_t>& voxels = volume.voxels;
  DisjointSets sets(voxels.size());
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j)
      for (int i = 0; i < n[0]; ++i) {
        const std::size_t p = volume.index(i, j, k);
        if (voxels[p] == 0) continue;
        const auto meet = [&](std::size_t q) {
          if (voxels[q] == voxels[p]) sets.join(static_cast<std::int32_t>(q), static_cast<std::int32_t>(p));
        };
        if (i > 0) meet(volume.index(i - 1, j, k));
        if (j > 0) meet(volume.index(i, j - 1, k));
        if (k > 0) meet(volume.index(i, j, k - 1));
      }
  std::map<std::int32_t, std::size_t> count;  // of a piece, named by its first voxel
  for (std::size_t p = 0; p < voxels.size(); ++p)
    if (voxels[p] != 0) ++count[sets.find(static_cast<std::int32_t>(p))];
  std::vector<std::vector<Piece>> of_label(volume.labels.size());
  for (const auto& [root, voxels_of] : count)
    of_label[voxels[root]].push_back({root, static_cast<double>(voxels_of) * volume.voxel_volume_mm3()});
  std::vector<std::int32_t> gone;
  for (std::size_t l = 1; l < of_label.size(); ++l)
    for (std::int32_t root : left_out(volume.labels[l].number, of_label[l], options, warnings)) gone.push_back(root);
  std::sort(gone.begin(), gone.end());
  if (gone.empty()) return;
  if (gone.size() == count.size()) fail_empty(options);
  for (std::size_t p = 0; p < voxels.size(); ++p)
    if (voxels[p] != 0 && std::binary_search(gone.begin(), gone.end(), sets.find(static_cast<std::int32_t>(p))))
      voxels[p] = 0;
}

void keep_pieces(InterfaceComplex& complex, const PieceOptions& options, std::vector<Warning>& warnings) {
  if (!options.any()) return;
  const Boundaries b = find_boundaries(complex, 1);
  const std::size_t shells = b.piece_volume_mm3.size();
  std::vector<std::int32_t> point(shells, -1), piece_of(shells);
  for (std::size_t t = 0; t < complex.triangles.size(); ++t)
    for (std::int32_t s : b.piece[t])
      if (s >= 0) point[s] = complex.triangles[t].v[0];
  std::vector<double> volume = b.piece_volume_mm3;
  for (std::size_t s = 0; s < shells; ++s) {  // the wall of a hole belongs to the smallest piece round it
    piece_of[s] = static_cast<std::int32_t>(s);
    if (b.piece_volume_mm3[s] > 0) continue;
    for (std::size_t o = 0; o < shells; ++o) {
      if (b.piece_row[o] != b.piece_row[s] || !(b.piece_volume_mm3[o] > -b.piece_volume_mm3[s]) ||
          !goes_round(complex, b, static_cast<std::int32_t>(o), complex.points[point[s]]))
        continue;
      if (piece_of[s] == static_cast<std::int32_t>(s) || b.piece_volume_mm3[o] < b.piece_volume_mm3[piece_of[s]])
        piece_of[s] = static_cast<std::int32_t>(o);
    }
    if (piece_of[s] != static_cast<std::int32_t>(s)) volume[piece_of[s]] += b.piece_volume_mm3[s];
  }
  std::vector<char> gone(shells, 0);
  for (std::size_t row = 0; row < b.labels.size(); ++row) {
    std::vector<Piece> pieces;
    for (std::size_t s = 0; s < shells; ++s)
      if (b.piece_row[s] == static_cast<std::int32_t>(row) && b.piece_volume_mm3[s] > 0)
        pieces.push_back({static_cast<std::int32_t>(s), volume[s]});
    for (std::int32_t s : left_out(b.labels[row].label, pieces, options, warnings)) gone[s] = 1;
  }
  for (std::size_t s = 0; s < shells; ++s) gone[s] = gone[piece_of[s]];
  InterfaceComplex kept;
  kept.space = complex.space;
  std::vector<std::int32_t> number(complex.points.size(), -1);
  for (std::size_t t = 0; t < complex.triangles.size(); ++t) {
    InterfaceTriangle out = complex.triangles[t];
    if (b.piece[t][0] >= 0 && gone[b.piece[t][0]]) out.below = 0;
    if (b.piece[t][1] >= 0 && gone[b.piece[t][1]]) out.above = 0;
    if (out.below == out.above) continue;
    for (std::int32_t& v : out.v) {
      if (number[v] < 0) {
        number[v] = static_cast<std::int32_t>(kept.points.size());
        kept.points.push_back(complex.points[v]);
      }
      v = number[v];
    }
    kept.triangles.push_back(out);
  }
  if (kept.triangles.empty() && !complex.triangles.empty()) fail_empty(options);
  complex = std::move(kept);
}

}  // namespace stackmesh
