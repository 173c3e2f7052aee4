#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "model/complex.h"
#include "model/label_volume.h"
#include "model/stack.h"
#include "model/tet_mesh.h"
#include "report/run_report.h"
#include "report/surface_values.h"

namespace stackmesh {

/// What the pictures of an HTML report are made of; the pointers need to live during draw_pictures only.
struct HtmlScene {
  const InterfaceComplex* surface = nullptr;  ///< the final surface, in a world frame
  const TetMesh* mesh = nullptr;              ///< its tetrahedra, in the same space, if there are any
  const LabelVolume* volume = nullptr;        ///< the labels that the mesh stands for ...
  const Stack* sections = nullptr;            ///< ... or its contours, for contour input
  int stack_axis = 2;                         ///< of the volume: 0, 1 or 2
  const SurfaceValues* values = nullptr;      ///< what a solver model says of the surface, if it is one's
};

/// How much the pictures of a page hold.
struct HtmlOptions {
  int threads = 0;                             ///< 0: all of the machine; the page does not depend on it
  std::size_t bytes_limit = 22 * 1000 * 1000;  ///< of the pictures' data, base64; pictures are simplified to keep it
  bool labels = true;                          ///< false: without the labels' own slices or contours
};

/// The pictures of one mesh, packed for the page (modules/report/README.md describes their form).
struct HtmlPictures {
  Space space = Space::lps;                                ///< of the scene's surface
  std::string json;                                        ///< what there is, and where
  std::vector<std::pair<std::string, std::string>> blobs;  ///< name, base64
};

/// Cuts the surface at every section and mid-gap, packs surface and tets for the 3-D view, counts histograms and
/// finds the worst places. @throws Error(usage) for a wrong axis.
HtmlPictures draw_pictures(const HtmlScene& scene, const HtmlOptions& options = {});

/// A mesh of the page, and what is said of it.
struct HtmlSubject {
  std::string name;                        ///< over its column and in its pictures, where there are several
  const RunReport* report = nullptr;       ///< its figures and verdicts; never null
  const HtmlPictures* pictures = nullptr;  ///< from draw_pictures(); null: the page shows none of this mesh
};

/// One HTML page for one mesh, or for several side by side; it needs nothing but a browser. The label pictures
/// of the first one serve all. Precondition: at least one subject.
std::string to_html(const std::vector<HtmlSubject>& subjects);

}  // namespace stackmesh
