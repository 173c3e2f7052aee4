#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/monitor.h"
#include "base/warning.h"
#include "model/complex.h"

namespace stackmesh {

/// How a stitched complex is smoothed and remeshed.
struct EnhanceOptions {
  /// HC-Laplacian, up to 5; each above is one more of a low-pass on the remeshed surface, which by default has three
  /// where they cost little distance, else a light one; 0: no smoothing at all
  int smooth_passes = 5;
  /// where the interfaces really run (FairedLabels::surface), in the same coordinates: the surface is drawn to it
  /// instead of being smoothed; null: the stitched surface is smoothed
  const InterfaceComplex* faired = nullptr;
  bool inner_caps = true;  ///< flat caps inside of the stack stay flat; else only those at its ends
  double pixel_mm = 1;     ///< in-plane pixel of the sections
  double gap_mm = 1;       ///< between sections; with the pixel it limits how far smoothing moves a vertex
  bool remesh = true;      ///< false: smoothing only
  std::optional<double> edge_length_mm;   ///< uniform edge length; unset: by curvature
  std::map<Label, double> label_edge_mm;  ///< edge length per label; where labels meet the smaller counts
  /// volume that a label should have, as far as small moves give it; else the stitched one's (which lies between
  /// slices as a frustum, not as voxels)
  std::map<Label, double> label_volume_mm3;
  /// by curvature: distance of an edge to the curved surface; default a quarter of a pixel of faired interfaces, else
  /// half a pixel, less for smooth drawn outlines
  std::optional<double> deviation_mm;
  std::optional<double> edge_min_mm;  ///< by curvature: default 1.5 pixels, less for smooth drawn outlines
  std::optional<double> edge_max_mm;  ///< by curvature: default a tenth of the label's box
  /// by curvature: edges get longer, or shorter, until about that many tetrahedra are expected
  std::optional<std::size_t> target_tets;
  /// without a target: edges get longer where more than 150,000 tetrahedra, and 50,000 for each label but one, would be
  /// made (at most a million)
  bool usual_target = false;
  double gradation = 1.3;   ///< largest ratio of neighbouring edge lengths
  double feature_deg = 70;  ///< straight chains of edges that bend by more are ridges, from 8 pixels on
  /// above 0: sections are drawn outlines that far apart, without voxel steps: corners above 35 degrees that three of
  /// them share are ridges, and volumes are kept closer
  double drawn_gap_mm = 0;
  /// of drawn outlines, over their own edges: the default deviation is six times that (at least 0.15 mm), if that is
  /// less than half a pixel; the default smallest edge shrinks as its root, to a pixel at least
  double drawn_bulge_mm = 0;
  double sheet_angle_deg = 20;  ///< angles between sheets are kept above it ("not below, and not worse")
  int threads = 0;              ///< 0: all; the result does not depend on it
};

/// What the enhancement did.
struct EnhanceCounts {
  std::size_t smoothed = 0;           ///< vertices that smoothing, or drawing them to the faired interfaces, moved
  std::size_t held_back = 0;          ///< of them those held back by the guard
  std::size_t splits = 0;             ///< edges that got a vertex between their ends
  std::size_t collapses = 0;          ///< edges that shrank to one vertex
  std::size_t flips = 0;              ///< edges that were turned to the other diagonal of their two triangles
  std::size_t relocations = 0;        ///< moves of a vertex for better triangles
  std::size_t refused_contact = 0;    ///< tests of the guard that failed: triangles would meet
  std::size_t refused_angle = 0;      ///< the same: sheets would turn through each other or meet at a narrow angle
  std::size_t refused_clearance = 0;  ///< the same: triangles without a common corner would come too near
  std::size_t ridge_edges = 0;        ///< edges of the stitched surface that were kept as ridges
};

/// An enhanced complex, and how it came about.
struct EnhanceResult {
  InterfaceComplex complex;                     ///< in the space of what was given
  SurfaceLevel level = SurfaceLevel::stitched;  ///< how far it came
  EnhanceCounts counts;                         ///< over all rounds
  std::size_t expected_triangles = 0;           ///< from the sizes, before remeshing; 0: was not remeshed
  std::size_t expected_tets = 0;                ///< likewise
  double coarsened = 1;                         ///< by what edges were made longer (or shorter) for the target
  std::vector<Warning> warnings;                ///< edges other than requested, volumes that changed, and the like
};

/// Smooths and remeshes a stitched complex for simulation (\cite wang2005, section 4; docs/enhancement.md).
/// Every label stays closed, none of its pieces is lost, its genus stays, and no two triangles meet beyond
/// what they share: each change is tested exactly against the whole complex. Flat caps stay plane.
/// @param stitched free of self-intersections, in stack coordinates (z is the stacking axis), mm
/// @param options sizes in mm, angles in degrees
/// @param progress is told how far it is, and may cancel
/// @throws Error(usage) for an edge length, deviation or gradation that makes no sense, or that asks for more
/// than 50 million triangles (with the estimate).
EnhanceResult enhance_complex(const InterfaceComplex& stitched, const EnhanceOptions& options, Monitor& progress);

}  // namespace stackmesh
