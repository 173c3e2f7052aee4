#pragma once
#include <cstdint>
#include <map>
#include <vector>

#include "model/complex.h"
#include "model/layers.h"
#include "model/tet_mesh.h"

namespace stackmesh {

/// Where the layers end inside, and how their elements lie; made before the volume is filled.
struct LayerPlan {
  /// what is left to be filled: the complex's points and, behind them, the feet of columns; outer faces of layered
  /// labels stand on those
  InterfaceComplex core;
  /// of the whole: the complex's triangles, points at one place being one
  std::vector<InterfaceTriangle> faces;
  std::vector<std::int32_t> foot;     ///< of each point of the complex: its foot in `core`; -1: no column
  std::vector<double> thickness_mm;   ///< of each column
  std::vector<Vec3> way;              ///< of each column: inwards, per mm of thickness
  std::vector<std::int32_t> layered;  ///< triangles with columns, ascending
  std::map<Label, LayerSize> sizes;   ///< as requested; their counts say how many wedges a column is cut into
  std::vector<LayerFigures> figures;  ///< of each label, ascending
};

/// Plans layers under the outer faces (those towards label 0) of labels. Every corner of them gets a column inwards, as
/// long as there is room: no further than two fifths of the way to a face opposite; not where another label's faces
/// begin; rising from there by no more than three fifths of an edge; and drawn back, or given up, until all tets into
/// which the elements can be divided are positive (exactly) and the inner ends cross nothing (exactly).
///
/// @param complex closed and without intersections, mm
/// @param sizes of labels that have outer faces
/// @param threads 0: all of the machine; the result does not depend on it
LayerPlan plan_layers(const InterfaceComplex& complex, const std::map<Label, LayerSize>& sizes, int threads);

/// Puts the layers of a plan over its filled core: wedges, pyramids where a layer ends along one side, tets where it
/// ends at two.
/// @param mesh of plan.core; becomes one of the whole complex
/// @param plan that the core was made by
void add_layers(TetMesh& mesh, const LayerPlan& plan);

}  // namespace stackmesh
