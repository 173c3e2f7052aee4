#include "mesh/layers.h"

#include <algorithm>
#include <cstdio>

#include "base/error.h"

namespace stackmesh {

void check_outer_faces(const InterfaceComplex& complex, const std::map<Label, LayerSize>& layers) {
  for (const auto& [label, size] : layers)
    if (std::none_of(complex.triangles.begin(), complex.triangles.end(), [l = label](const InterfaceTriangle& t) {
          return t.below != t.above && (t.below == 0 || t.above == 0) && (t.below == l || t.above == l);
        }))
      fail_usage(
          "label " + std::to_string(label) + " has no outer faces: other labels are all around it", "--layer",
          "name a label that reaches the outside, mesh it alone with --label, or make what it surrounds a --void");
}

std::string layer_warning(const LayerFigures& f) {
  if (f.places.empty()) return "";
  char text[200];
  std::string out = "label " + std::to_string(f.label) + ": the layer of ";
  std::snprintf(text, sizeof text, "%.4g mm is thinner on %.1f %% of the outer faces", f.asked.thickness_mm,
                100 * f.thinned_rel);
  out += text;
  if (f.wedges + f.pyramids + f.tets > 0 && f.thinned_rel > 0) {
    std::snprintf(text, sizeof text, " (down to %.3g mm)", f.thickness_min_mm);
    out += text;
  }
  std::snprintf(text, sizeof text, " and missing on %.1f %%; ", 100 * f.missing_rel);
  out += text;
  out += f.places.size() == 1 ? "at " : "largest of " + std::to_string(f.places.size()) + " places: ";
  for (std::size_t i = 0; i < std::min<std::size_t>(3, f.places.size()); ++i) {
    const LayerPlace& p = f.places[i];
    std::snprintf(text, sizeof text, "%s(%.1f, %.1f, %.1f), %.3g mm2, %s", i > 0 ? "; " : "", p.at_mm.x, p.at_mm.y,
                  p.at_mm.z, p.area_mm2, layer_limit_name(p.why));
    out += text;
  }
  return out;
}

}  // namespace stackmesh
