#include "volume/grow_layers.h"

#include <algorithm>

#include "base/disjoint_sets.h"
#include "volume/compact.h"
#include "volume/layer_columns.h"

namespace stackmesh {
namespace {

using volume::Columns;
using volume::LayerFace;

constexpr double kFull = 0.95;  // of the thickness: what counts as whole

/// The label of an outer face; 0 for other faces.
Label outer_label(const InterfaceTriangle& f) {
  return f.below == f.above ? 0 : f.below == 0 ? f.above : f.above == 0 ? f.below : 0;
}

double area_of(const std::vector<Vec3>& points, const InterfaceTriangle& f) {
  return 0.5 * norm(cross(points[f.v[1]] - points[f.v[0]], points[f.v[2]] - points[f.v[0]]));
}

/// Shares of the surface, and the places where the layer is thin.
class Surveyor {
 public:
  Surveyor(const std::vector<Vec3>& points, const std::vector<InterfaceTriangle>& faces, const Columns& columns,
           Label label, const LayerSize& size)
      : points_(points), faces_(faces), columns_(columns) {
    out_.label = label;
    out_.asked = size;
  }

  LayerFigures run() {
    out_.thickness_min_mm = out_.asked.thickness_mm;
    for (std::size_t i = 0; i < faces_.size(); ++i)
      if (outer_label(faces_[i]) == out_.label) count(i);
    if (out_.area_mm2 > 0)
      for (double* share : {&out_.full_rel, &out_.thinned_rel, &out_.missing_rel}) *share /= out_.area_mm2;
    find_places();
    return std::move(out_);
  }

 private:
  void count(std::size_t i) {
    const double area = area_of(points_, faces_[i]);
    out_.area_mm2 += area;
    double least = 1e300, most = 0;
    int columns = 0;
    for (const std::int32_t v : faces_[i].v) {
      const double t = columns_.thickness[v];
      least = std::min(least, t), most = std::max(most, t), columns += t > 0;
      if (t > 0) out_.thickness_min_mm = std::min(out_.thickness_min_mm, t);
    }
    const auto levels = static_cast<std::size_t>(out_.asked.count);
    if (columns == 3) out_.wedges += levels;
    if (columns == 2) out_.pyramids += levels;
    if (columns == 1) out_.tets += levels;
    (least >= kFull * out_.asked.thickness_mm ? out_.full_rel
     : most == 0                              ? out_.missing_rel
                                              : out_.thinned_rel) += area;
    if (least < kFull * out_.asked.thickness_mm) thin_.push_back(static_cast<std::int32_t>(i));
  }

  /// Thin faces that share a point are one place.
  void find_places() {
    DisjointSets sets(thin_.size());
    std::map<std::int32_t, std::int32_t> first;  // of each point: a thin face
    for (std::size_t i = 0; i < thin_.size(); ++i)
      for (const std::int32_t v : faces_[thin_[i]].v) {
        const auto [at, fresh] = first.insert({v, static_cast<std::int32_t>(i)});
        if (!fresh) sets.join(at->second, static_cast<std::int32_t>(i));
      }
    std::map<std::int32_t, std::vector<std::int32_t>> places;
    for (std::size_t i = 0; i < thin_.size(); ++i) places[sets.find(static_cast<std::int32_t>(i))].push_back(thin_[i]);
    for (const auto& [set, faces] : places) out_.places.push_back(place_of(faces));
    std::stable_sort(out_.places.begin(), out_.places.end(),
                     [](const LayerPlace& a, const LayerPlace& b) { return a.area_mm2 > b.area_mm2; });
  }

  LayerPlace place_of(const std::vector<std::int32_t>& faces) const {
    LayerPlace place;
    Vec3 centre;
    place.thickness_mm = 1e300;
    std::map<LayerLimit, double> causes;  // weighed by what is missing
    for (const std::int32_t i : faces) {
      const double area = area_of(points_, faces_[i]);
      place.area_mm2 += area;
      for (const std::int32_t v : faces_[i].v) {
        centre = centre + (area / 3) * points_[v];
        place.thickness_mm = std::min(place.thickness_mm, columns_.thickness[v]);
        if (columns_.why[v] != LayerLimit::beside)
          causes[columns_.why[v]] += out_.asked.thickness_mm - columns_.thickness[v];
      }
    }
    centre = (1 / place.area_mm2) * centre;
    place.why = LayerLimit::beside;
    double most = 0;
    for (const auto& [why, weight] : causes)
      if (weight > most) most = weight, place.why = why;
    double nearest = 1e300;
    for (const std::int32_t i : faces)
      for (const std::int32_t v : faces_[i].v)
        if (const double d = norm(points_[v] - centre); d < nearest) nearest = d, place.at_mm = points_[v];
    return place;
  }

  const std::vector<Vec3>& points_;
  const std::vector<InterfaceTriangle>& faces_;
  const Columns& columns_;
  LayerFigures out_;
  std::vector<std::int32_t> thin_;
};

}  // namespace

LayerPlan plan_layers(const InterfaceComplex& complex, const std::map<Label, LayerSize>& sizes, int threads) {
  LayerPlan plan;
  plan.sizes = sizes;
  plan.faces = volume::compact(complex).welded;
  plan.core.points = complex.points;
  plan.core.space = complex.space;
  plan.core.triangles = plan.faces;
  plan.foot.assign(complex.points.size(), -1);
  plan.thickness_mm.assign(complex.points.size(), 0);
  plan.way.resize(complex.points.size());
  for (const auto& [label, size] : sizes) {
    const Columns columns = volume::find_columns(complex.points, plan.faces, label, size, threads);
    plan.figures.push_back(Surveyor(complex.points, plan.faces, columns, label, size).run());
    for (std::size_t v = 0; v < columns.thickness.size(); ++v) {
      if (columns.thickness[v] == 0) continue;
      plan.foot[v] = static_cast<std::int32_t>(plan.core.points.size());
      plan.thickness_mm[v] = columns.thickness[v];
      plan.way[v] = columns.way[v];
      plan.core.points.push_back(
          volume::level_of_column(complex.points[v], columns.way[v], columns.thickness[v], size.count, size.count));
    }
  }
  for (std::size_t i = 0; i < plan.faces.size(); ++i) {
    bool any = false;
    for (std::int32_t& v : plan.core.triangles[i].v)
      if (plan.foot[v] >= 0) v = plan.foot[v], any = true;
    if (any) plan.layered.push_back(static_cast<std::int32_t>(i));
  }
  return plan;
}

void add_layers(TetMesh& mesh, const LayerPlan& plan) {
  // of a column: the first of its points between surface and foot
  std::vector<std::int32_t> between(plan.foot.size(), -1);
  std::vector<std::array<std::int32_t, 6>> pyramids;
  std::vector<Label> wedge_labels, pyramid_labels;
  for (const std::int32_t i : plan.layered) {
    const InterfaceTriangle& face = plan.faces[i];
    const Label label = outer_label(face);
    const int count = plan.sizes.at(label).count;
    const LayerFace f = volume::layer_face(face, plan.thickness_mm);
    const auto node = [&](int corner, int level) {
      const std::int32_t v = f.v[corner];
      if (level == 0 || plan.foot[v] < 0) return v;
      if (level == count) return plan.foot[v];
      if (between[v] < 0) {
        between[v] = static_cast<std::int32_t>(mesh.points.size());
        for (int k = 1; k < count; ++k)
          mesh.points.push_back(volume::level_of_column(mesh.points[v], plan.way[v], plan.thickness_mm[v], k, count));
      }
      return between[v] + level - 1;
    };
    for (int s = 0; s < count; ++s) {
      if (f.columns == 1) {
        mesh.tets.push_back({node(0, s), node(1, s), node(2, s), node(0, s + 1)});
        mesh.labels.push_back(label);
        continue;
      }
      (f.columns == 3 ? mesh.wedges : pyramids)
          .push_back({node(0, s), node(1, s), node(2, s), node(0, s + 1), node(1, s + 1), node(2, s + 1)});
      (f.columns == 3 ? wedge_labels : pyramid_labels).push_back(label);
    }
  }
  mesh.wedges.insert(mesh.wedges.end(), pyramids.begin(), pyramids.end());
  mesh.labels.insert(mesh.labels.end(), wedge_labels.begin(), wedge_labels.end());
  mesh.labels.insert(mesh.labels.end(), pyramid_labels.begin(), pyramid_labels.end());
  mesh.faces = plan.faces;
}

}  // namespace stackmesh
