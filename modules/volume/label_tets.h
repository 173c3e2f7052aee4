#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "model/complex.h"
#include "model/tet_mesh.h"

namespace stackmesh::volume {

/// What the checks below found; `message` is empty when all is well.
struct Finding {
  std::string message;
  std::vector<std::int32_t> triangles;  // ascending, without repeats
  bool of_input = false;                // the complex itself is at fault: another call of TetGen is no use
};

/// The sign of det(b-a, c-a, d-a), exact.
int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// Is every label's surface closed, and no triangle degenerate or repeated?
Finding check_closed(const InterfaceComplex& complex);

/// Tets as TetGen gives them: any one orientation, neighbours opposite the corners (-1 outside).
struct RawTets {
  std::vector<std::int32_t> corners, neighbours;  // four a tet
};

/// Fills mesh.tets and mesh.labels from `raw`, whose corners index mesh.points. Every tet must be positive
/// (exactly), every face of mesh.faces must be a face of the tets, and the labels flooded from the faces must
/// agree. Tets of the background are dropped.
Finding label_tets(RawTets raw, TetMesh& mesh);

/// Is every tet positive (exactly), and every face of a tet either shared with one tet of its label, or one of
/// mesh.faces with that label on that side? Is every side of mesh.faces that has a label the face of a tet?
Finding check_filled(const TetMesh& mesh, int threads);

struct Volume {
  double mm3 = 0;
  double terms = 0;  // sum of the magnitudes that were added: the scale of its rounding
};

/// The volume that each label's surface encloses (background left out).
std::map<Label, Volume> surface_volumes(const InterfaceComplex& complex);
/// The volume of each label's tets.
std::map<Label, Volume> tet_volumes(const TetMesh& mesh);

}  // namespace stackmesh::volume
