#include "volume/raise_order.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/parallel.h"
#include "model/wedge_shape.h"
#include "volume/layer_levels.h"
#include "volume/surface_curves.h"

namespace stackmesh {
namespace {

struct Determinant {
  double least_rel;  // a lower bound everywhere, over the straight element's
  double volume;     // the element's
};

/// From the Bernstein coefficients of an element's Jacobian determinant: their smallest bounds it, their mean is its
/// mean.
Determinant determinant_of(const std::array<Vec3, 4>& corner, const std::array<Vec3, 6>& mid) {
  static constexpr int kMid[4][4] = {{-1, 0, 2, 3}, {0, -1, 1, 4}, {2, 1, -1, 5}, {3, 4, 5, -1}};
  // Gradients at the corners: they are linear in between.
  Vec3 g[3][4];
  for (int c = 0; c < 4; ++c) {
    const auto by = [&](int i) {  // derivative by the i-th barycentric coordinate at corner c, halved
      return i == c ? 1.5 * corner[c] : 2.0 * mid[kMid[i][c]] - 0.5 * corner[i];
    };
    const Vec3 first = by(0);
    for (int k = 0; k < 3; ++k) g[k][c] = 2.0 * (by(k + 1) - first);
  }
  const double straight = dot(corner[1] - corner[0], cross(corner[2] - corner[0], corner[3] - corner[0]));
  Vec3 product[4][4];
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) product[i][j] = cross(g[1][i], g[2][j]);
  const auto term = [&](int i, int j, int k) { return dot(g[0][i], product[j][k]); };
  double smallest = std::numeric_limits<double>::infinity(), sum = 0;
  for (int i = 0; i < 4; ++i)
    for (int j = i; j < 4; ++j)
      for (int k = j; k < 4; ++k) {
        const double coefficient =
            (term(i, j, k) + term(i, k, j) + term(j, i, k) + term(j, k, i) + term(k, i, j) + term(k, j, i)) / 6;
        smallest = std::min(smallest, coefficient);
        sum += coefficient;
      }
  return {smallest / straight, sum / 20 / 6};
}

/// Of a wedge: the smallest determinant at its nodes and integration points over the straight one's there, and its
/// volume.
Determinant determinant_of_wedge(const WedgeNodes& nodes, bool pyramid) {
  static const std::vector<WedgePlace> places[2] = {wedge_check_places(false), wedge_check_places(true)};
  WedgeNodes straight = nodes;
  straight.quadratic = false;
  double least = std::numeric_limits<double>::infinity();
  for (const WedgePlace& p : places[pyramid]) {
    const double before = wedge_point(straight, p).determinant, now = wedge_point(nodes, p).determinant;
    least = std::min(least, before > 0 ? now / before : -1);
  }
  return {least, wedge_volume(nodes)};
}

class Raiser {
 public:
  Raiser(TetMesh mesh, const OrderOptions& options)
      : o_(options), edges_(mesh), levels_(mesh), mesh_(std::move(mesh)) {}

  OrderResult run() {
    OrderResult result;
    std::vector<std::pair<std::int64_t, Vec3>> ways;
    std::map<Label, double> volumes;
    if (o_.volumes_restored)
      for (std::size_t t = 0; t < mesh_.tets.size(); ++t) {
        const auto& v = mesh_.tets[t];
        const Vec3 a = mesh_.points[v[0]];
        volumes[mesh_.labels[t]] +=
            dot(mesh_.points[v[1]] - a, cross(mesh_.points[v[2]] - a, mesh_.points[v[3]] - a)) / 6;
      }
    for (std::size_t w = 0; w < mesh_.wedges.size() && o_.volumes_restored; ++w)
      volumes[mesh_.labels[mesh_.tets.size() + w]] += wedge_volume(wedge_nodes(mesh_, w));
    if (o_.follow_surface) {
      const volume::SurfaceCurves curves(mesh_, edges_, o_.ridge_deg);
      curves.each_offset([&](std::int64_t edge, Vec3 offset) { ways.emplace_back(edge, offset); });
      bend_layers(ways);
      if (o_.volumes_restored) result.moved_corners = draw_in(curves.stand_off());
    }
    place_straight();
    if (o_.follow_surface) {
      bend(ways);
      hold_back();
      if (o_.volumes_restored)
        for (int round = 0; round < 3; ++round) give_back_volumes(volumes);
      for (const double s : share_) {
        result.curved_nodes += s > 0;
        result.limited_nodes += s < 1;
      }
      result.jacobian_min_rel = std::min(1.0, bound_);
    }
    result.mesh = std::move(mesh_);
    return result;
  }

 private:
  void place_straight() {
    first_ = static_cast<std::int32_t>(mesh_.points.size());
    mesh_.points.resize(mesh_.points.size() + edges_.larger.size());
    for (std::int32_t p = 0; p < first_; ++p)
      for (std::int64_t e = edges_.begin[p]; e < edges_.begin[p + 1]; ++e)
        mesh_.points[first_ + e] = middle(p, edges_.larger[e]);
    mesh_.mid.resize(mesh_.tets.size());
    for (const auto& w : mesh_.wedges) {
      auto& mid = mesh_.wedge_mid.emplace_back();
      for (int k = 0; k < 9; ++k) {
        const std::int32_t a = w[kWedgeEdges[k][0]], b = w[kWedgeEdges[k][1]];
        mid[k] = a == b ? a : first_ + static_cast<std::int32_t>(edges_.find(a, b));
      }
    }
    parallel_for((mesh_.tets.size() + kChunk - 1) / kChunk, o_.threads, [&](std::size_t chunk) {
      for (std::size_t t = chunk * kChunk; t < std::min(mesh_.tets.size(), (chunk + 1) * kChunk); ++t)
        for (int k = 0; k < 6; ++k)
          mesh_.mid[t][k] = first_ + static_cast<std::int32_t>(
                                         edges_.find(mesh_.tets[t][kTetEdges[k][0]], mesh_.tets[t][kTetEdges[k][1]]));
    });
  }

  /// Edges of a layer bend with those of the surface over them, by their share.
  void bend_layers(std::vector<std::pair<std::int64_t, Vec3>>& ways) const {
    if (!levels_.any) return;
    std::map<std::int64_t, Vec3> of_surface(ways.begin(), ways.end());
    for (std::int32_t p = 0; p < static_cast<std::int32_t>(mesh_.points.size()); ++p)
      for (std::int64_t e = edges_.begin[p]; e < edges_.begin[p + 1]; ++e) {
        const std::int32_t q = edges_.larger[e], a = levels_.top[p], b = levels_.top[q];
        const double share = std::min(levels_.share[p], levels_.share[q]);
        if (a == b || (a == p && b == q) || share == 0) continue;
        const auto over = of_surface.find(edges_.find(a, b));
        if (over != of_surface.end()) ways.emplace_back(e, share * over->second);
      }
  }

  Vec3 middle(std::int32_t p, std::int32_t q) const { return 0.5 * (mesh_.points[p] + mesh_.points[q]); }

  /// Moves the corners by -off; where a tet would lose more than three tenths of its volume its corners move half as
  /// far, and so on.
  std::size_t draw_in(std::vector<Vec3> off) {
    const std::vector<Vec3> from = mesh_.points;
    std::vector<double> share(from.size(), 1);  // of points of columns: that of their top counts
    std::vector<std::int32_t> suspects;
    for (std::size_t v = 0; v < off.size(); ++v)
      if (const std::int32_t top = levels_.top[v]; levels_.hangs(static_cast<std::int32_t>(v)))
        off[v] = levels_.share[v] * off[top];
    const auto moves = [&](std::int32_t v) { return share[levels_.top[v]] > 0 && dot(off[v], off[v]) > 0; };
    const auto any_of = [&](std::int32_t t, auto test) {
      bool any = false;
      each_corner(mesh_, static_cast<std::size_t>(t), [&](std::int32_t v) { any = any || test(v); });
      return any;
    };
    for (std::size_t t = 0; t < mesh_.elements(); ++t)
      if (any_of(static_cast<std::int32_t>(t), moves)) suspects.push_back(static_cast<std::int32_t>(t));
    const std::vector<std::int32_t> all = suspects;
    for (std::size_t v = 0; v < from.size(); ++v) mesh_.points[v] = from[v] - off[v];
    while (!suspects.empty()) {
      std::vector<char> less(from.size(), 0);
      bool any = false;
      for (const std::int32_t t : suspects)
        if (any_of(t, moves) && !keeps_volume(from, t)) {
          any = true;
          each_corner(mesh_, static_cast<std::size_t>(t),
                      [&](std::int32_t v) { less[levels_.top[v]] = less[levels_.top[v]] || moves(v); });
        }
      if (!any) break;
      for (std::size_t v = 0; v < from.size(); ++v)
        if (less[v]) share[v] = share[v] > 1.0 / 16 ? share[v] / 2 : 0;
      for (std::size_t v = 0; v < from.size(); ++v)
        if (less[levels_.top[v]]) mesh_.points[v] = from[v] - share[levels_.top[v]] * off[v];
      suspects.clear();
      for (const std::int32_t t : all)
        if (any_of(t, [&](std::int32_t v) { return less[levels_.top[v]] != 0; })) suspects.push_back(t);
    }
    std::size_t count = 0;
    for (std::size_t v = 0; v < from.size(); ++v) count += moves(static_cast<std::int32_t>(v));
    return count;
  }

  /// Has an element seven tenths of its volume yet (a wedge: at each of its corners)?
  bool keeps_volume(const std::vector<Vec3>& from, std::int32_t element) const {
    constexpr double kKept = 0.7;
    const auto keeps = [&](std::int32_t a, std::int32_t b, std::int32_t c, std::int32_t d) {
      const auto determinant = [&](const std::vector<Vec3>& p) {
        return dot(p[b] - p[a], cross(p[c] - p[a], p[d] - p[a]));
      };
      return determinant(mesh_.points) >= kKept * determinant(from);
    };
    if (!mesh_.is_wedge(static_cast<std::size_t>(element))) {
      const auto& v = mesh_.tets[element];
      return keeps(v[0], v[1], v[2], v[3]);
    }
    const auto& w = mesh_.wedges[static_cast<std::size_t>(element) - mesh_.tets.size()];
    for (int k = 0; k < (is_pyramid(w) ? 2 : 3); ++k)
      if (!keeps(w[0], w[1], w[2], w[3 + k]) || !keeps(w[3], w[5], w[4], w[k])) return false;
    return true;
  }

  void bend(const std::vector<std::pair<std::int64_t, Vec3>>& ways) {
    bent_of_.assign(edges_.larger.size(), -1);
    for (const auto& [edge, offset] : ways) {
      bent_of_[edge] = static_cast<std::int32_t>(bent_.size());
      bent_.push_back(static_cast<std::int32_t>(edge));
      straight_.push_back(mesh_.points[first_ + edge]);
      offsets_.push_back(offset);
      mesh_.points[first_ + edge] = straight_.back() + offset;
    }
    share_.assign(bent_.size(), 1);
    for (std::size_t t = 0; t < mesh_.elements(); ++t)
      if (any_mid(static_cast<std::int32_t>(t), [&](std::int32_t b) { return b >= 0; }))
        curved_tets_.push_back(static_cast<std::int32_t>(t));
  }

  /// True when the test holds for a mid-side node of an element, given its place among the bent ones (-1: straight).
  template <class Test>
  bool any_mid(std::int32_t element, Test test) const {
    const auto tet = static_cast<std::size_t>(element);
    if (!mesh_.is_wedge(tet))
      return std::any_of(mesh_.mid[tet].begin(), mesh_.mid[tet].end(),
                         [&](std::int32_t m) { return test(bent_of_[m - first_]); });
    const auto& mid = mesh_.wedge_mid[tet - mesh_.tets.size()];
    return std::any_of(mid.begin(), mid.end(),
                       [&](std::int32_t m) { return m >= first_ && test(bent_of_[m - first_]); });
  }

  Determinant determinant_of_element(std::int32_t tet) const {
    if (mesh_.is_wedge(static_cast<std::size_t>(tet))) {
      const std::size_t w = static_cast<std::size_t>(tet) - mesh_.tets.size();
      return determinant_of_wedge(wedge_nodes(mesh_, w), is_pyramid(mesh_.wedges[w]));
    }
    std::array<Vec3, 4> corner;
    std::array<Vec3, 6> mid;
    for (int i = 0; i < 4; ++i) corner[i] = mesh_.points[mesh_.tets[tet][i]];
    for (int i = 0; i < 6; ++i) mid[i] = mesh_.points[mesh_.mid[tet][i]];
    return determinant_of(corner, mid);
  }

  /// Halves the way of all bent nodes of an element that is bent too much, until none is. Elements whose nodes are all
  /// back at their middles are left.
  void hold_back() {
    std::vector<std::int32_t> suspects = curved_tets_;
    std::vector<double> bounds(mesh_.elements(), 1);
    std::vector<char> moved(bent_.size());
    while (!suspects.empty()) {
      parallel_for((suspects.size() + kChunk - 1) / kChunk, o_.threads, [&](std::size_t chunk) {
        for (std::size_t i = chunk * kChunk; i < std::min(suspects.size(), (chunk + 1) * kChunk); ++i)
          bounds[suspects[i]] = determinant_of_element(suspects[i]).least_rel;
      });
      std::fill(moved.begin(), moved.end(), 0);
      bool any = false;
      for (const std::int32_t t : suspects)
        if (!(bounds[t] >= o_.jacobian_rel))
          any_mid(t, [&](std::int32_t b) {
            if (b >= 0 && share_[b] > 0) moved[b] = 1, any = true;
            return false;
          });
      if (!any) break;
      for (std::size_t b = 0; b < bent_.size(); ++b) {
        if (!moved[b]) continue;
        share_[b] = share_[b] > 1.0 / 32 ? share_[b] / 2 : 0;
        mesh_.points[first_ + bent_[b]] = share_[b] > 0 ? straight_[b] + share_[b] * offsets_[b] : straight_[b];
      }
      suspects.clear();
      for (const std::int32_t t : curved_tets_)
        if (any_mid(t, [&](std::int32_t b) { return b >= 0 && moved[b]; })) suspects.push_back(t);
    }
    for (const std::int32_t t : curved_tets_) bound_ = std::min(bound_, bounds[t]);
  }

  /// What each label still holds too much or too little is given to its curved sides, all nodes of a side between two
  /// labels moving by the same along their normals. Nodes stay in planes across an axis.
  void give_back_volumes(const std::map<Label, double>& wanted) {
    std::vector<double> held(mesh_.elements());
    parallel_for((held.size() + kChunk - 1) / kChunk, o_.threads, [&](std::size_t chunk) {
      for (std::size_t t = chunk * kChunk; t < std::min(held.size(), (chunk + 1) * kChunk); ++t)
        held[t] = determinant_of_element(static_cast<std::int32_t>(t)).volume;
    });
    std::map<Label, double> missing = wanted, push;
    for (std::size_t t = 0; t < held.size(); ++t) missing[mesh_.labels[t]] -= held[t];
    // Each side moves by the difference of its labels' pushes.
    std::map<Label, std::map<Label, double>> area;
    std::vector<Vec3> normal(mesh_.faces.size());  // twice the area
    std::vector<char> plane(mesh_.faces.size(), 0);
    for (std::size_t i = 0; i < mesh_.faces.size(); ++i) {
      const InterfaceTriangle& f = mesh_.faces[i];
      const Vec3 &a = mesh_.points[f.v[0]], &b = mesh_.points[f.v[1]], &c = mesh_.points[f.v[2]];
      normal[i] = cross(b - a, c - a);
      plane[i] = a.x == b.x && b.x == c.x ? 1 : a.y == b.y && b.y == c.y ? 2 : a.z == b.z && b.z == c.z ? 3 : 0;
      if (plane[i] != 0 || f.below == f.above) continue;
      area[f.below][f.above] += norm(normal[i]) / 2;
      area[f.above][f.below] += norm(normal[i]) / 2;
    }
    for (int round = 0; round < 200; ++round)
      for (const auto& [label, mm3] : missing) {
        double sum = mm3, all = 0;
        for (const auto& [other, mm2] : area[label]) sum += mm2 * push[other], all += mm2;
        if (all > 0) push[label] = sum / all;
      }
    std::vector<Vec3> shift(static_cast<std::size_t>(first_));
    std::vector<double> weight(shift.size(), 0);
    std::vector<char> planes(shift.size(), 0);  // bits
    for (std::size_t i = 0; i < mesh_.faces.size(); ++i)
      for (const std::int32_t v : mesh_.faces[i].v) {
        if (plane[i] != 0) planes[v] = static_cast<char>(planes[v] | 1 << (plane[i] - 1));
        if (plane[i] != 0) continue;
        shift[v] = shift[v] + (push[mesh_.faces[i].below] - push[mesh_.faces[i].above]) * normal[i];
        weight[v] += norm(normal[i]);
      }
    for (std::size_t v = 0; v < shift.size(); ++v) {
      if (weight[v] > 0) shift[v] = (1 / weight[v]) * shift[v];
      if (planes[v] & 1) shift[v].x = 0;
      if (planes[v] & 2) shift[v].y = 0;
      if (planes[v] & 4) shift[v].z = 0;
    }
    for (std::size_t v = 0; v < shift.size(); ++v)
      if (const std::int32_t top = levels_.top[v]; levels_.hangs(static_cast<std::int32_t>(v)))
        shift[v] = levels_.share[v] * shift[top];
    const std::vector<Vec3> before = mesh_.points;
    for (double share = 1; share > 0.1; share /= 2) {
      for (std::int32_t p = 0; p < first_; ++p) {
        mesh_.points[p] = before[p] + share * shift[p];
        for (std::int64_t e = edges_.begin[p]; e < edges_.begin[p + 1]; ++e)
          mesh_.points[first_ + e] = before[first_ + e] + 0.5 * share * (shift[p] + shift[edges_.larger[e]]);
      }
      std::vector<double> least((mesh_.elements() + kChunk - 1) / kChunk, 1);
      parallel_for(least.size(), o_.threads, [&](std::size_t chunk) {
        for (std::size_t t = chunk * kChunk; t < std::min(held.size(), (chunk + 1) * kChunk); ++t)
          least[chunk] = std::min(least[chunk], determinant_of_element(static_cast<std::int32_t>(t)).least_rel);
      });
      const double now = *std::min_element(least.begin(), least.end());
      if (now < std::min(bound_, o_.jacobian_rel)) continue;
      bound_ = now;
      return;
    }
    mesh_.points = before;
  }

  static constexpr std::size_t kChunk = 1 << 12;
  const OrderOptions& o_;
  const volume::ElementEdges edges_;
  const volume::LayerLevels levels_;
  TetMesh mesh_;
  std::int32_t first_ = 0;             // mid-side node of edge 0
  std::vector<std::int32_t> bent_of_;  // of an edge, -1: straight
  std::vector<std::int32_t> bent_;     // edges
  std::vector<Vec3> straight_, offsets_;
  std::vector<double> share_;              // of the offset
  std::vector<std::int32_t> curved_tets_;  // elements
  double bound_ = 1;
};

void check_input(const TetMesh& mesh, const OrderOptions& options) {
  if (!mesh.mid.empty())
    fail_input("the elements are of second order already", "tetrahedral mesh", "leave it as it is");
  const auto count = static_cast<std::int64_t>(mesh.points.size());
  const auto fine = [&](std::int32_t v) { return v >= 0 && v < count; };
  for (std::size_t t = 0; t < mesh.tets.size(); ++t)
    if (!std::all_of(mesh.tets[t].begin(), mesh.tets[t].end(), fine))
      fail_input("a tet names a point that does not exist", "tet " + std::to_string(t), "write the mesh again");
  for (std::size_t t = mesh.tets.size(); t < mesh.elements(); ++t)
    each_corner(mesh, t, [&](std::int32_t v) {
      if (!fine(v))
        fail_input("a wedge names a point that does not exist", "element " + std::to_string(t), "write the mesh again");
    });
  for (std::size_t t = 0; t < mesh.faces.size(); ++t)
    if (!std::all_of(mesh.faces[t].v.begin(), mesh.faces[t].v.end(), fine))
      fail_input("a face names a point that does not exist", "face " + std::to_string(t), "write the mesh again");
  if (!(options.jacobian_rel > 0 && options.jacobian_rel < 1))
    fail_internal("jacobian_rel is not between 0 and 1", "raise_order");
}

}  // namespace

OrderResult raise_order(TetMesh mesh, const OrderOptions& options) {
  check_input(mesh, options);
  return Raiser(std::move(mesh), options).run();
}

}  // namespace stackmesh
