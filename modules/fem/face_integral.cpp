#include "fem/face_integral.h"

#include <algorithm>

#include "fem/boundary_faces.h"

namespace stackmesh {
namespace {

struct RulePoint {
  double l[3], weight;
};
std::vector<RulePoint> face_rule() {
  constexpr double a = 0.0597158717897698, b = 0.4701420641051151, w = 0.1323941527885062;
  constexpr double c = 0.7974269853530873, d = 0.1012865073234563, v = 0.1259391805448271;
  return {{{1.0 / 3, 1.0 / 3, 1.0 / 3}, 0.225},
          {{a, b, b}, w},
          {{b, a, b}, w},
          {{b, b, a}, w},
          {{c, d, d}, v},
          {{d, c, d}, v},
          {{d, d, c}, v}};
}

}  // namespace

void visit_face_points(const TetMesh& mesh, const std::vector<TetFace>& faces,
                       const std::function<void(const FacePoint&)>& visit) {
  const std::vector<RulePoint> rule = face_rule();
  const int count = mesh.mid.empty() ? 3 : 6;
  for (const TetFace face : faces) {
    FacePoint out;
    out.nodes = outward_nodes(mesh, face);
    for (const RulePoint& p : rule) {
      double du[6], dv[6];  // coordinates u, v are those of corners 1 and 2
      out.shape = {};
      if (count == 3) {
        for (int k = 0; k < 3; ++k) out.shape[k] = p.l[k];
        const double u[3] = {-1, 1, 0}, v[3] = {-1, 0, 1};
        std::copy(u, u + 3, du);
        std::copy(v, v + 3, dv);
      } else {
        const double dl[2][3] = {{-1, 1, 0}, {-1, 0, 1}};
        for (int k = 0; k < 3; ++k) {
          const int m = (k + 1) % 3;
          out.shape[k] = p.l[k] * (2 * p.l[k] - 1);
          du[k] = (4 * p.l[k] - 1) * dl[0][k];
          dv[k] = (4 * p.l[k] - 1) * dl[1][k];
          out.shape[3 + k] = 4 * p.l[k] * p.l[m];
          du[3 + k] = 4 * (dl[0][k] * p.l[m] + p.l[k] * dl[0][m]);
          dv[3 + k] = 4 * (dl[1][k] * p.l[m] + p.l[k] * dl[1][m]);
        }
      }
      Vec3 xu, xv;
      out.position = {};
      for (int k = 0; k < count; ++k) {
        const Vec3 x = mesh.points[out.nodes[k]];
        xu = xu + du[k] * x;
        xv = xv + dv[k] * x;
        out.position = out.position + out.shape[k] * x;
      }
      out.area = (0.5 * p.weight) * cross(xu, xv);
      visit(out);
    }
  }
}

}  // namespace stackmesh
