#pragma once
#include <cstddef>
#include <map>
#include <vector>

#include "enhance/complex_mesh.h"
#include "enhance/guard.h"

namespace stackmesh {

struct SmoothingOptions {
  int passes = 5;
  double alpha = 0.1,
         beta = 0.6;  ///< of HC-Laplacian smoothing: pull to the original, and share of the own correction
  double taubin_lambda = 0, taubin_mu = 0;  ///< both set: low-pass smoothing instead (\cite taubin1995)
  double limit_xy_mm = 0.5,
         limit_z_mm = 0.5;          ///< half axes of the ellipsoid about its origin that a vertex stays in
  std::vector<float> share;         ///< of the limits for each vertex; empty: all of them
  std::map<Label, double> volumes;  ///< that the labels should have, mm3, as far as `volume_limit_mm` along the normals
  double volume_limit_mm = 0;       ///< gives them; 0: they are not looked at
  MoveLimits keep;
  int threads = 0;
};

struct SmoothingResult {
  std::size_t moved = 0, held_back = 0;  ///< vertices; held back: at less than the full step
  int rounds = 0;
};

/// Places of the vertices when smoothed, within the limits but without any guard.
std::vector<Vec3> smoothed_places(const ComplexMesh& mesh, const SmoothingOptions& options);

/// HC-Laplacian smoothing of a complex (\cite vollmer1999): vertices of curves average along their
/// curve only, fixed points stay, caps stay plane. All moves are tried at once; vertices of triangles that
/// then offend (see guard.h) go half of their way, and so on, so that the result is as valid as the input
/// was.
SmoothingResult smooth(ComplexMesh& mesh, const SmoothingOptions& options);

/// Signed volume of each label but 0, mm3.
std::map<Label, double> label_volumes(const ComplexMesh& mesh);

/// Moves sheets along their normals so that every label gets the volume requested, to first order, each by at
/// most `limit_mm`. Guarded as smoothing is.
SmoothingResult restore_volumes(ComplexMesh& mesh, const std::map<Label, double>& volumes, double limit_mm,
                                const MoveLimits& keep, int threads);

/// Goes from mesh.points to `targets`: each vertex the whole way, a half, a quarter, an eighth or not at all.
SmoothingResult move_guarded(ComplexMesh& mesh, const std::vector<Vec3>& targets, const MoveLimits& keep, int threads);

}  // namespace stackmesh
