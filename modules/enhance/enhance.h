#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/monitor.h"
#include "base/warning.h"
#include "model/complex.h"

namespace stackmesh {

struct EnhanceOptions {
  /// HC-Laplacian, up to 5; each above is one more of a low-pass on the remeshed surface, which by default
  int smooth_passes = 5;
  ///< has three where they cost little distance, else a light one; 0: no smoothing at all
  /// where the interfaces really run (FairedLabels::surface), in the same coordinates: the surface is
  const InterfaceComplex* faired = nullptr;
  ///< drawn to it instead of being smoothed; null: the stitched surface is smoothed
  bool inner_caps = true;  ///< flat caps inside of the stack stay flat; else only those at its ends
  double pixel_mm = 1;     ///< in-plane pixel of the sections
  double gap_mm = 1;       ///< between sections; with the pixel it limits how far smoothing moves a vertex
  bool remesh = true;      ///< false: smoothing only
  std::optional<double> edge_length_mm;   ///< uniform edge length; unset: by curvature
  std::map<Label, double> label_edge_mm;  ///< edge length per label; where labels meet the smaller counts
  /// volume that a label should have, as far as small moves give it; else the
  std::map<Label, double> label_volume_mm3;
  ///< stitched one's (which lies between slices as a frustum, not as voxels)
  std::optional<double>
      /// by curvature: distance of an edge to the curved surface; default a quarter of a pixel of faired interfaces,
      /// else half a pixel, less for smooth drawn outlines
      deviation_mm;
  std::optional<double> edge_min_mm;  ///< by curvature: default 1.5 pixels, less for smooth drawn outlines
  std::optional<double> edge_max_mm;  ///< by curvature: default a tenth of the label's box
  std::optional<std::size_t>
      /// by curvature: edges get longer, or shorter, until about that many tetrahedra are expected
      target_tets;
  /// without a target: edges get longer where more than 150,000 tetrahedra, and 50,000 for each label but one, would
  bool usual_target = false;
  ///< be made (at most a million)
  double gradation = 1.3;   ///< largest ratio of neighbouring edge lengths
  double feature_deg = 70;  ///< straight chains of edges that bend by more are ridges, from 8 pixels on
  /// above 0: sections are drawn outlines that far apart, without voxel steps: corners above 35 degrees that
  double drawn_gap_mm = 0;
  ///< three of them share are ridges, and volumes are kept closer
  /// of drawn outlines, over their own edges: the default deviation is six times that (at least 0.15 mm), if that is
  /// less
  double drawn_bulge_mm = 0;
  ///< than half a pixel; the default smallest edge shrinks as its root, to a pixel at least
  double sheet_angle_deg = 20;  ///< angles between sheets are kept above it ("not below, and not worse")
  int threads = 0;              ///< 0: all; the result does not depend on it
};

/// What the enhancement did.
struct EnhanceCounts {
  std::size_t smoothed = 0, held_back = 0;  ///< vertices that moved; of them those held back by the guard
  std::size_t splits = 0, collapses = 0, flips = 0, relocations = 0;
  std::size_t refused_contact = 0, refused_angle = 0,
              refused_clearance = 0;  ///< operations refused by the guard
  std::size_t ridge_edges = 0;
};

struct EnhanceResult {
  InterfaceComplex complex;                     ///< in the space of what was given
  SurfaceLevel level = SurfaceLevel::stitched;  ///< how far it came
  EnhanceCounts counts;
  std::size_t expected_triangles = 0, expected_tets = 0;  ///< from the sizes, before remeshing
  double coarsened = 1;  ///< by what edges were made longer (or shorter) for the target
  std::vector<Warning> warnings;
};

/// Smooths and remeshes a stitched complex for simulation (\cite wang2005, section 4; docs/enhancement.md).
/// Every label stays closed, none of its pieces is lost, its genus stays, and no two triangles meet beyond
/// what they share: each change is tested exactly against the whole complex. Flat caps stay plane.
/// @param stitched free of self-intersections, in stack coordinates (z is the stacking axis), mm.
/// @throws Error(usage) for an edge length, deviation or gradation that makes no sense, or that asks for more
/// than 50 million triangles (with the estimate).
EnhanceResult enhance_complex(const InterfaceComplex& stitched, const EnhanceOptions& options, Monitor& progress);

}  // namespace stackmesh
