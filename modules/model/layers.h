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
  Vec3 at_mm;  ///< a point of the surface near its middle
  double area_mm2 = 0;
  double thickness_mm = 0;  ///< the smallest there; 0: none
  LayerLimit why = LayerLimit::none;
};

/// What a layer came to. Shares are of the area of the label's outer faces.
struct LayerFigures {
  Label label = 0;
  LayerSize asked;
  std::size_t wedges = 0, pyramids = 0, tets = 0;  ///< elements of the layer
  /// full: 95 % of the thickness and more, all over a face
  double area_mm2 = 0, full_rel = 0, thinned_rel = 0, missing_rel = 0;
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
