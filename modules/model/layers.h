#pragma once
#include <cstddef>
#include <vector>

#include "model/geometry.h"

namespace stackmesh {

/// A layer of wedges under the outer faces of a label.
struct LayerSize {
  double thickness_mm = 0;  ///< in all, at right angles to the faces; above 0
  int count = 1;            ///< of wedges over each other; from 1
};

/// Why a layer is thinner than asked for.
enum class LayerLimit {
  none,      ///< it is not
  junction,  ///< another label, or an edge or point of the surface without two sides, begins there
  room,      ///< another face of the label lies opposite
  shape,     ///< the surface turns too sharply: wedges would be flat or cross
  beside     ///< it rises from a place where it is thinner
};

/// A connected part of a label's outer faces where the layer is thinner than asked for, or missing.
struct LayerPlace {
  Vec3 at_mm;                         ///< a point of the surface near its middle
  double area_mm2 = 0;                ///< of the outer faces
  double thickness_mm = 0;            ///< the smallest there; 0: none
  LayerLimit why = LayerLimit::none;  ///< what keeps it from being thicker
};

/// What a layer came to. Shares are of the area of the label's outer faces.
struct LayerFigures {
  Label label = 0;                 ///< whose outer faces it lies under
  LayerSize asked;                 ///< as it was requested
  std::size_t wedges = 0;          ///< of the layer
  std::size_t pyramids = 0;        ///< of the layer, in which it ends
  std::size_t tets = 0;            ///< of the layer, in which it ends
  double area_mm2 = 0;             ///< of the label's outer faces
  double full_rel = 0;             ///< where it has 95 % of the thickness or more, all over a face
  double thinned_rel = 0;          ///< where it is thinner
  double missing_rel = 0;          ///< where there is none
  double thickness_min_mm = 0;     ///< where there is any
  std::vector<LayerPlace> places;  ///< largest first
};

/// Why, in a few words, as warnings and reports say it.
inline const char* layer_limit_name(LayerLimit limit) {
  switch (limit) {
    case LayerLimit::junction:
      return "another label begins";
    case LayerLimit::room:
      return "no room";
    case LayerLimit::shape:
      return "sharp turn";
    case LayerLimit::beside:
      return "beside a thin place";
    default:
      return "none";
  }
}

}  // namespace stackmesh
