#include "cohort/thumbnail.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "cohort/png.h"
#include "meshio/read_mesh.h"

namespace stackmesh {
namespace {

constexpr int kWidth = 192, kHeight = 144, kFiner = 2;  // pixels; drawn finer by that factor
constexpr double kTurnDeg = 30, kRiseDeg = 20;          // of the eye: to the patient's right, above
constexpr double kPi = 3.14159265358979323846;

using Colour = std::array<double, 3>;

Colour colour_of(const std::string& hex) {
  const long rgb = hex.size() == 7 ? std::strtol(hex.c_str() + 1, nullptr, 16) : 0x999999;
  return {(rgb >> 16 & 255) / 255.0, (rgb >> 8 & 255) / 255.0, (rgb & 255) / 255.0};
}

/// Axes of the picture in LPS: to the right, up, towards the eye.
struct View {
  Vec3 right, up, eye;
};

View default_view() {
  const double turn = kTurnDeg * kPi / 180, rise = kRiseDeg * kPi / 180;
  View v;
  // From the front (-y); the patient's right is at -x and on the picture's left.
  v.eye = {-std::sin(turn) * std::cos(rise), -std::cos(turn) * std::cos(rise), std::sin(rise)};
  v.right = {std::cos(turn), -std::sin(turn), 0};
  v.up = cross(v.eye, v.right);
  return v;
}

class Canvas {
 public:
  Canvas()
      : depth_(kWidth * kFiner * kHeight * kFiner, -std::numeric_limits<float>::infinity()),
        colour_(depth_.size(), {1, 1, 1}) {}

  /// Corners in finer pixels, z towards the eye; brightness at each corner.
  void triangle(const std::array<Vec3, 3>& p, const std::array<double, 3>& light, const Colour& colour) {
    const double area = (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[2].x - p[0].x) * (p[1].y - p[0].y);
    if (std::abs(area) < 1e-12) return;
    const auto range = [&](double Vec3::*axis, int most) {
      const double low = std::min({p[0].*axis, p[1].*axis, p[2].*axis}),
                   high = std::max({p[0].*axis, p[1].*axis, p[2].*axis});
      return std::pair<int, int>{std::max(0, static_cast<int>(std::ceil(low - 0.5))),
                                 std::min(most - 1, static_cast<int>(std::floor(high - 0.5)))};
    };
    const auto [x0, x1] = range(&Vec3::x, kWidth * kFiner);
    const auto [y0, y1] = range(&Vec3::y, kHeight * kFiner);
    for (int y = y0; y <= y1; ++y)
      for (int x = x0; x <= x1; ++x) {
        const double cx = x + 0.5, cy = y + 0.5;
        const double b = ((cx - p[0].x) * (p[2].y - p[0].y) - (p[2].x - p[0].x) * (cy - p[0].y)) / area;
        const double c = ((p[1].x - p[0].x) * (cy - p[0].y) - (cx - p[0].x) * (p[1].y - p[0].y)) / area, a = 1 - b - c;
        if (a < 0 || b < 0 || c < 0) continue;
        const std::size_t at = static_cast<std::size_t>(y) * kWidth * kFiner + x;
        const float z = static_cast<float>(a * p[0].z + b * p[1].z + c * p[2].z);
        if (z <= depth_[at]) continue;
        depth_[at] = z;
        const double bright = a * light[0] + b * light[1] + c * light[2];
        for (int k = 0; k < 3; ++k) colour_[at][k] = static_cast<float>(std::clamp(colour[k] * bright, 0.0, 1.0));
      }
  }

  std::string png() const {
    std::vector<std::uint8_t> rgb;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x)
        for (int k = 0; k < 3; ++k) {
          double sum = 0;
          for (int v = 0; v < kFiner; ++v)
            for (int u = 0; u < kFiner; ++u)
              sum += colour_[static_cast<std::size_t>(y * kFiner + v) * kWidth * kFiner + x * kFiner + u][k];
          rgb.push_back(static_cast<std::uint8_t>(std::lround(255 * sum / (kFiner * kFiner))));
        }
    return png_of(rgb, kWidth, kHeight);
  }

 private:
  std::vector<float> depth_;
  std::vector<std::array<float, 3>> colour_;
};

/// The triangles that the background touches, each wound outwards.
std::vector<InterfaceTriangle> outer_triangles(const InterfaceComplex& surface) {
  std::vector<InterfaceTriangle> outer;
  for (InterfaceTriangle t : surface.triangles) {
    if ((t.below == 0) == (t.above == 0)) continue;
    if (t.below == 0) {
      std::swap(t.v[1], t.v[2]);
      std::swap(t.below, t.above);
    }
    outer.push_back(t);
  }
  return outer;
}

}  // namespace

std::string draw_thumbnail(const InterfaceComplex& surface, const std::map<int, CohortLabel>& labels) {
  const View view = default_view();
  const std::vector<InterfaceTriangle> outer = outer_triangles(surface);
  std::vector<Vec3> seen(surface.points.size()), normals(surface.points.size());
  Vec3 low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
  for (const InterfaceTriangle& t : outer) {
    const Vec3 &a = surface.points[t.v[0]], &b = surface.points[t.v[1]], &c = surface.points[t.v[2]];
    const Vec3 normal = cross(b - a, c - a);
    for (const std::int32_t v : t.v) {
      const Vec3& p = surface.points[v];
      seen[v] = {dot(p, view.right), dot(p, view.up), dot(p, view.eye)};
      low = {std::min(low.x, seen[v].x), std::min(low.y, seen[v].y), 0};
      high = {std::max(high.x, seen[v].x), std::max(high.y, seen[v].y), 0};
      normals[v] = normals[v] + normal;
    }
  }
  Canvas canvas;
  if (outer.empty()) return canvas.png();
  constexpr double kMargin = 0.92;
  const double scale =
      kMargin * kFiner * std::min(kWidth / std::max(1e-9, high.x - low.x), kHeight / std::max(1e-9, high.y - low.y));
  const Vec3 middle = 0.5 * (low + high);
  const auto brightness = [&](const Vec3& n) {
    const double length = norm(n);
    return length > 0
               ? 0.35 + 0.75 * std::max(0.0, dot(n, view.eye + 0.4 * view.up - 0.2 * view.right) / (1.1 * length))
               : 0.6;
  };
  std::map<int, Colour> colours;
  for (const auto& [label, known] : labels) colours[label] = colour_of(known.colour);
  for (const InterfaceTriangle& t : outer) {
    std::array<Vec3, 3> p;
    std::array<double, 3> light{};
    for (int k = 0; k < 3; ++k) {
      const Vec3& s = seen[t.v[k]];
      p[k] = {0.5 * kWidth * kFiner + scale * (s.x - middle.x), 0.5 * kHeight * kFiner - scale * (s.y - middle.y), s.z};
      light[k] = brightness(normals[t.v[k]]);
    }
    const auto known = colours.find(t.below);
    canvas.triangle(p, light, known != colours.end() ? known->second : colour_of(""));
  }
  return canvas.png();
}

std::string draw_thumbnail(const std::string& mesh_path, const std::map<int, CohortLabel>& labels) {
  const MeshFile file = read_mesh(mesh_path);
  const TetMesh mesh = tet_mesh_of(file);
  InterfaceComplex surface;
  surface.points = file.points;
  surface.triangles = file.tets.empty() ? file.triangles : mesh.faces;
  return draw_thumbnail(surface, labels);
}

}  // namespace stackmesh
