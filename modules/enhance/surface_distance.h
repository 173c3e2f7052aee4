#pragma once
#include <vector>

#include "enhance/smoothing.h"

namespace stackmesh {

/// Points of a surface, evenly by area, by which the distance of another is told.
struct SurfaceSamples {
  std::vector<Vec3> points;
  std::vector<std::int32_t> patches;
};

/// At most about `count` points of the mesh's triangles outside flat caps.
SurfaceSamples sample_surface(const ComplexMesh& mesh, std::size_t count);

/// Mean distance of the samples to the sheets of the mesh, mm; what is further than `reach_mm` counts as that.
double mean_distance(const SurfaceSamples& samples, const ComplexMesh& mesh, double reach_mm, int threads);

/// By how much smoothing (without a guard) would take the samples further from the mesh, on average, mm.
double smoothing_cost(ComplexMesh& mesh, const SurfaceSamples& samples, const SmoothingOptions& options);

}  // namespace stackmesh
