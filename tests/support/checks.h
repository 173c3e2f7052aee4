#pragma once
#include <gtest/gtest.h>

#include <map>
#include <string>

#include "model/complex.h"
#include "sections/extract.h"
#include "stitch/stitch.h"
#include "validate/check_surface.h"
#include "volume/fill_volume.h"

namespace stackmesh::testing_support {

/// A label volume through contours and stitching.
struct Stitched {
  Stack stack;
  StitchResult result;
  const InterfaceComplex& complex() const { return result.complex; }
};

inline Stitched stitch_volume(const LabelVolume& volume, double simplify_px, const StitchOptions& options = {}) {
  Monitor quiet;
  ContourOptions contours;
  contours.simplify_px = simplify_px;
  contours.threads = options.threads;
  Stitched s;
  s.stack = extract_sections(volume, contours, quiet).stack;
  s.result = stitch_sections(s.stack, options, quiet);
  return s;
}

/// Volume under the sheets, by columns: shares nothing with the divergence theorem in the tests' judge.
inline std::map<Label, double> column_volumes(const InterfaceComplex& c) {
  std::map<Label, long double> sum;
  for (const InterfaceTriangle& t : c.triangles) {
    const Vec3 &p = c.points[t.v[0]], &q = c.points[t.v[1]], &r = c.points[t.v[2]];
    const long double area = 0.5L * ((static_cast<long double>(q.x) - p.x) * (static_cast<long double>(r.y) - p.y) -
                                     (static_cast<long double>(r.x) - p.x) * (static_cast<long double>(q.y) - p.y));
    const long double column = area * (static_cast<long double>(p.z) + q.z + r.z) / 3;
    sum[t.below] += column;
    sum[t.above] -= column;
  }
  std::map<Label, double> out;
  for (const auto& [label, v] : sum)
    if (label != 0) out[label] = static_cast<double>(v);
  return out;
}

/// Why the complex is not a closed, intersection-free set of label surfaces; "" if it is.
inline std::string defects(const InterfaceComplex& c) {
  const SurfaceCheck check = check_surface(c);
  std::string out;
  if (check.open_edges) out += std::to_string(check.open_edges) + " open edges; ";
  if (check.self_intersections) out += std::to_string(check.self_intersections) + " self-intersections; ";
  if (check.degenerate_triangles) out += std::to_string(check.degenerate_triangles) + " degenerate triangles; ";
  const std::map<Label, double> columns = column_volumes(c);
  for (const LabelSurface& l : check.labels) {
    if (!l.closed) out += "label " + std::to_string(l.label) + " is open; ";
    const auto it = columns.find(l.label);
    if (it == columns.end() || !(l.volume_mm3 > 0) || std::abs(it->second - l.volume_mm3) > 1e-9 * l.volume_mm3 + 1e-12)
      out += "label " + std::to_string(l.label) + " has volume " + std::to_string(l.volume_mm3) + "; ";
  }
  return out;
}

inline FillResult fill(const InterfaceComplex& c) {
  FillOptions options;
  options.worker_path = STACKMESH_WORKER;
  options.timeout_s = 120;
  return fill_volume(c, options);
}

inline const LabelSurface& surface_of(const SurfaceCheck& check, Label label) {
  for (const LabelSurface& l : check.labels)
    if (l.label == label) return l;
  ADD_FAILURE() << "no surface for label " << label;
  static const LabelSurface none;
  return none;
}

}  // namespace stackmesh::testing_support
