#pragma once
#include <map>
#include <optional>
#include <vector>

#include "enhance/complex_mesh.h"

namespace stackmesh {

struct SizingOptions {
  std::optional<double> edge_length_mm;   ///< uniform; unset: by curvature
  std::map<Label, double> label_edge_mm;  ///< per label; where labels meet the smaller counts
  double deviation_mm = 0.5;              ///< by curvature: largest distance of an edge from the surface
  double edge_min_mm = 1, edge_max_mm = 10;
  double thin_min_mm = 1;                ///< walls and what bulges make edges no shorter than this
  std::map<Label, double> label_max_mm;  ///< by curvature: largest length on a label, instead of edge_max_mm
  double gradation = 1.3;                ///< lengths of neighbouring edges differ by at most this factor
  std::vector<double> shell_mm;          ///< what `shell_sizes` says of the vertices
  std::vector<double> wall_mm;           ///< what `wall_thickness` says, up to wall_reach_mm
  double wall_reach_mm = 0;
  /// of each vertex that is on no curve, 1 / mm, where it is known better than by surface_bends; else below 0; may be
  /// empty
  std::vector<double> bend;
  int threads = 0;
};

/// How much the surface bends at every vertex, 1 / mm: one over the smallest radius of curvature, from normals averaged
/// over a few rings, so that what is left of the voxels' steps does not count.
std::vector<double> surface_bends(const ComplexMesh& mesh, int threads);

/// For every vertex the distance across the thinnest label there, by rays into the labels on both sides (gaps of
/// background do not count); no more than reach_mm, infinite where nothing is hit and on curves.
std::vector<double> wall_thickness(const ComplexMesh& mesh, double reach_mm, int threads);

/// The closed shells of a label: outer ones, and those round holes in it, which face inwards.
struct ShellCount {
  std::size_t outer = 0, inward = 0;
  bool operator==(const ShellCount& o) const { return outer == o.outer && inward == o.inward; }
};

/// For every vertex the cube root of the volume of the smallest closed shell of a label that it is on, mm.
std::vector<double> shell_sizes(const ComplexMesh& mesh, std::map<Label, ShellCount>* shells = nullptr);

/// H-correction (\cite borouchaki1998): sizes grow along the surface by at most the gradation.
void grade_sizes(const ComplexMesh& mesh, double gradation, std::vector<double>& size);

/// Edge length requested at every vertex, mm.
std::vector<double> edge_sizes(const ComplexMesh& mesh, const SizingOptions& options);

/// Edges of a thin wall are at most this many times as long as it is thick, and this share of a small closed shell's
/// size.
constexpr double kAcrossWall = 3, kOfShell = 0.5;

/// Area of a triangle as it comes out, over the square of the edge length requested.
constexpr double kTriangleArea = 0.39;

/// How many triangles the sizes mean.
double expected_triangles(const ComplexMesh& mesh, const std::vector<double>& size);

}  // namespace stackmesh
