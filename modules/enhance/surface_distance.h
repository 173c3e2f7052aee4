#pragma once
#include <vector>

#include "enhance/complex_mesh.h"

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

/// By how much the samples are further from the mesh, on average, when its vertices stand at `places`, mm.
double distance_gained(ComplexMesh& mesh, const SurfaceSamples& samples, std::vector<Vec3> places, double reach_mm,
                       int threads);

}  // namespace stackmesh
