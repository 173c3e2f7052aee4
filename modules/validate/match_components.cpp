#include "validate/match_components.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace stackmesh {
namespace {

constexpr double kWithin = 0.49;  // voxels from the centre along each axis: clearly inside

/// The line of voxels at these steps along U and V, within the grid.
std::size_t line_at(const LabelRuns& runs, long u, long v) {
  return static_cast<std::size_t>(v) * static_cast<std::size_t>(runs.size[1]) + static_cast<std::size_t>(u);
}

/// Middles and sizes of the components of the input, and pieces of the mesh, that nothing answers to.
void locate_unmatched(const LabelRuns& runs, const InterfaceComplex& complex, const std::vector<Vec3>& points,
                      const Boundaries& boundaries, const std::vector<char>& component_lost,
                      const std::vector<char>& piece_lost, const std::vector<std::int32_t>& row_label,
                      std::vector<LabelFidelity>& rows) {
  struct Extent {
    Vec3 sum, low = {1e300, 1e300, 1e300}, high = {-1e300, -1e300, -1e300};
    double weight = 0;
    void add(const Vec3& p, double w) {
      sum = sum + w * p, weight += w;
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    double size() const { return std::max({high.x - low.x, high.y - low.y, high.z - low.z}); }
  };
  constexpr std::size_t kMost = 100;
  const double voxel = runs.spacing_mm[0] * runs.spacing_mm[1] * runs.spacing_mm[2];
  const auto part_of = [&](const Extent& e) {
    UnmatchedPart part;
    const Vec3 middle = (1 / e.weight) * e.sum;
    part.where = runs.to_world(middle);
    part.section = static_cast<int>(
        std::clamp(std::lround(middle.z / runs.spacing_mm[2]), 0L, static_cast<long>(runs.size[2]) - 1));
    part.size_mm = e.size();
    return part;
  };
  const auto keep = [](std::vector<UnmatchedPart>& parts) {
    std::stable_sort(parts.begin(), parts.end(),
                     [](const UnmatchedPart& a, const UnmatchedPart& b) { return a.volume_mm3 > b.volume_mm3; });
    if (parts.size() > kMost) parts.resize(kMost);
  };
  if (std::count(component_lost.begin(), component_lost.end(), 1) > 0) {
    std::vector<Extent> extents(component_lost.size());
    for (std::size_t line = 0; line + 1 < runs.start.size(); ++line)
      for (std::size_t k = runs.start[line]; k < runs.start[line + 1]; ++k) {
        const LabelRun& r = runs.runs[k];
        if (!component_lost[r.component]) continue;
        const double u = static_cast<double>(line % static_cast<std::size_t>(runs.size[1])),
                     v = static_cast<double>(line / static_cast<std::size_t>(runs.size[1]));
        Extent& e = extents[r.component];
        e.add(runs.place(0.5 * (r.begin + r.end - 1), u, v), r.end - r.begin);
        const double weight = e.weight;
        const Vec3 sum = e.sum;
        e.add(runs.place(r.begin - 0.5, u - 0.5, v - 0.5), 0), e.add(runs.place(r.end - 0.5, u + 0.5, v + 0.5), 0);
        e.weight = weight, e.sum = sum;
      }
    for (std::size_t c = 0; c < extents.size(); ++c) {
      if (!component_lost[c]) continue;
      UnmatchedPart part = part_of(extents[c]);
      part.voxels = static_cast<std::size_t>(extents[c].weight);
      part.volume_mm3 = extents[c].weight * voxel;
      rows[runs.component_label[c] - 1].missing.push_back(part);
    }
  }
  if (std::count(piece_lost.begin(), piece_lost.end(), 1) > 0) {
    std::vector<Extent> extents(piece_lost.size());
    for (std::size_t t = 0; t < boundaries.piece.size(); ++t)
      for (const std::int32_t piece : boundaries.piece[t])
        if (piece >= 0 && piece_lost[piece])
          for (const std::int32_t v : complex.triangles[t].v) extents[piece].add(points[v], 1);
    for (std::size_t p = 0; p < extents.size(); ++p) {
      if (!piece_lost[p] || extents[p].weight == 0) continue;
      UnmatchedPart part = part_of(extents[p]);
      part.volume_mm3 = boundaries.piece_volume_mm3[p];
      rows[row_label[boundaries.piece_row[p]] - 1].unmatched.push_back(part);
    }
  }
  for (LabelFidelity& row : rows) keep(row.missing), keep(row.unmatched);
}

/// Pieces that cover no voxel centre of their label, by the component to one of whose voxels their middle is nearest:
/// (component, piece), each piece and each component once.
std::vector<std::pair<std::int32_t, std::int32_t>> find_shrunk(const LabelRuns& runs, const InterfaceComplex& complex,
                                                               const std::vector<Vec3>& points,
                                                               const Boundaries& boundaries,
                                                               const std::vector<std::int32_t>& row_label,
                                                               const std::vector<char>& component_lost,
                                                               const std::vector<char>& piece_lost) {
  std::vector<std::pair<std::int32_t, std::int32_t>> pairs;
  if (std::count(component_lost.begin(), component_lost.end(), 1) == 0 ||
      std::count(piece_lost.begin(), piece_lost.end(), 1) == 0)
    return pairs;
  std::vector<Vec3> sum(piece_lost.size());
  std::vector<double> corners(piece_lost.size(), 0);
  for (std::size_t t = 0; t < boundaries.piece.size(); ++t)
    for (const std::int32_t piece : boundaries.piece[t])
      if (piece >= 0 && piece_lost[piece])
        for (const std::int32_t v : complex.triangles[t].v) sum[piece] = sum[piece] + points[v], ++corners[piece];
  // The nearest such voxel: of voxels that are thin along one axis, a piece may leave its own by less than half of
  // their longest side.
  std::vector<char> taken(component_lost.size(), 0);
  const auto& s = runs.spacing_mm;
  const double reach = 0.5 * std::max({s[0], s[1], s[2]});
  for (std::size_t p = 0; p < piece_lost.size(); ++p) {
    if (!piece_lost[p] || corners[p] == 0) continue;
    const Vec3 m = (1 / corners[p]) * sum[p];
    const auto beyond = [](double x, double begin, double end, double step) {
      return std::max({(begin - 0.5) * step - x, x - (end - 0.5) * step, 0.0});
    };
    std::pair<double, std::int32_t> nearest = {reach, -1};
    for (long v = std::max(0L, std::lround((m.z - reach) / s[2]));
         v <= std::min<long>(runs.size[2] - 1, std::lround((m.z + reach) / s[2])); ++v)
      for (long u = std::max(0L, std::lround((m.y - reach) / s[1]));
           u <= std::min<long>(runs.size[1] - 1, std::lround((m.y + reach) / s[1])); ++u) {
        const std::size_t line = line_at(runs, u, v);
        for (std::size_t k = runs.start[line]; k < runs.start[line + 1]; ++k) {
          const LabelRun& r = runs.runs[k];
          if (!component_lost[r.component] || taken[r.component] || r.label != row_label[boundaries.piece_row[p]])
            continue;
          const double away = norm({beyond(m.x, r.begin, r.end, s[0]),
                                    beyond(m.y, static_cast<double>(u), static_cast<double>(u + 1), s[1]),
                                    beyond(m.z, static_cast<double>(v), static_cast<double>(v + 1), s[2])});
          if (away <= reach && (nearest.second < 0 || std::pair{away, r.component} < nearest))
            nearest = {away, r.component};
        }
      }
    if (nearest.second < 0) continue;
    taken[nearest.second] = 1;
    pairs.push_back({nearest.second, static_cast<std::int32_t>(p)});
  }
  return pairs;
}

/// Components without a piece of their own whose voxels the surface of another component's piece enters: it joined
/// them, though it leaves their centres out. (component, piece), each component once.
std::vector<std::pair<std::int32_t, std::int32_t>> find_joined(const LabelRuns& runs, const InterfaceComplex& complex,
                                                               const std::vector<Vec3>& points,
                                                               const Boundaries& boundaries,
                                                               const std::vector<std::int32_t>& row_label,
                                                               const std::vector<char>& component_lost) {
  std::vector<std::pair<std::int32_t, std::int32_t>> pairs;
  if (std::count(component_lost.begin(), component_lost.end(), 1) == 0) return pairs;
  std::vector<char> taken(component_lost.size(), 0);
  for (std::size_t t = 0; t < boundaries.piece.size(); ++t)
    for (const std::int32_t piece : boundaries.piece[t]) {
      if (piece < 0) continue;
      const std::int32_t label = row_label[boundaries.piece_row[piece]];
      const auto& c = complex.triangles[t].v;
      const Vec3 &a = points[c[0]], &b = points[c[1]], &d = points[c[2]];
      for (const Vec3& p : {a, b, d, (1.0 / 3) * (a + b + d)}) {
        const double x = p.x / runs.spacing_mm[0], y = p.y / runs.spacing_mm[1], z = p.z / runs.spacing_mm[2];
        const long w = std::lround(x), u = std::lround(y), v = std::lround(z);
        if (std::max({std::abs(x - w), std::abs(y - u), std::abs(z - v)}) > kWithin) continue;
        if (u < 0 || v < 0 || u >= runs.size[1] || v >= runs.size[2]) continue;
        const std::size_t line = line_at(runs, u, v);
        for (std::size_t k = runs.start[line]; k < runs.start[line + 1]; ++k) {
          const LabelRun& r = runs.runs[k];
          if (w < r.begin || w >= r.end || r.label != label || !component_lost[r.component] || taken[r.component])
            continue;
          taken[r.component] = 1;
          pairs.push_back({r.component, piece});
        }
      }
    }
  return pairs;
}

}  // namespace

void match_components(const LabelRuns& runs, const InterfaceComplex& complex, const std::vector<Vec3>& points,
                      const Boundaries& boundaries, const GridWalk& walk, const std::vector<std::int32_t>& row_label,
                      std::vector<LabelFidelity>& rows) {
  std::vector<int> met_by_component(runs.component_label.size(), 0), met_by_solid(boundaries.piece_row.size(), 0);
  for (const auto& [component, solid] : walk.meets) ++met_by_component[component], ++met_by_solid[solid];
  std::vector<char> component_lost(met_by_component.size(), 0), piece_lost(met_by_solid.size(), 0);
  for (std::size_t c = 0; c < met_by_component.size(); ++c) component_lost[c] = met_by_component[c] == 0;
  for (std::size_t p = 0; p < met_by_solid.size(); ++p)
    piece_lost[p] = row_label[boundaries.piece_row[p]] >= 0 && boundaries.piece_volume_mm3[p] > 0 &&
                    met_by_solid[walk.solid[p]] == 0;
  for (const auto& [component, piece] :
       find_shrunk(runs, complex, points, boundaries, row_label, component_lost, piece_lost)) {
    component_lost[component] = piece_lost[piece] = 0;
    ++met_by_component[component], ++met_by_solid[piece];
    ++rows[runs.component_label[component] - 1].shrunk_components;
  }
  for (const auto& [component, piece] : find_joined(runs, complex, points, boundaries, row_label, component_lost)) {
    component_lost[component] = 0;
    ++met_by_component[component], ++met_by_solid[walk.solid[piece]];
  }
  std::vector<char> one_to_one(rows.size() + 1, 1);
  for (std::size_t c = 0; c < met_by_component.size(); ++c) {
    LabelFidelity& row = rows[runs.component_label[c] - 1];
    ++row.input_components;
    row.missing_components += component_lost[c];
    if (met_by_component[c] != 1) one_to_one[runs.component_label[c]] = 0;
  }
  for (std::size_t p = 0; p < met_by_solid.size(); ++p) {
    const std::int32_t label = row_label[boundaries.piece_row[p]];
    if (label < 0) continue;
    if (boundaries.piece_volume_mm3[p] > 0) ++rows[label - 1].components;
    if (met_by_solid[p] > 1) one_to_one[label] = 0;
  }
  for (std::size_t l = 0; l < rows.size(); ++l)
    rows[l].components_match = one_to_one[l + 1] && rows[l].components == rows[l].input_components;
  locate_unmatched(runs, complex, points, boundaries, component_lost, piece_lost, row_label, rows);
}

}  // namespace stackmesh
