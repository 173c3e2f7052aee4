#pragma once
#include <string>
#include <vector>

#include "model/complex.h"
#include "model/tet_mesh.h"

namespace stackmesh {

/// Counts of values in equal bins from low to high; values beyond either end count in the end bin.
struct Histogram {
  std::string name, title, unit;
  double low = 0, high = 1;
  std::vector<std::size_t> counts;
  std::size_t values = 0;
  double smallest = 0, median = 0, largest = 0;  ///< median to a bin's width at most
};

/// Of every triangle angle, dihedral angle, edge length of the surface, and vertex distance, as far as they are there.
std::vector<Histogram> make_histograms(const InterfaceComplex& complex, const TetMesh* mesh,
                                       const std::vector<float>& distances_mm, int threads);

}  // namespace stackmesh
