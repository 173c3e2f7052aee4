#pragma once
#include <array>
#include <cmath>
#include <cstdint>

namespace stackmesh {

/// A tissue label as its input numbers it; 0 is the background.
using Label = std::int32_t;

/// A point or vector in mm.
struct Vec3 {
  double x = 0, y = 0, z = 0;
};

inline Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vec3 operator*(double s, Vec3 a) { return {s * a.x, s * a.y, s * a.z}; }
inline double dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec3 cross(Vec3 a, Vec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double norm(Vec3 a) { return std::sqrt(dot(a, a)); }

/// A rigid (possibly mirroring) map p -> origin + x * axes[0] + y * axes[1] + z * axes[2]; the axes are
/// orthonormal. It takes stack coordinates (in-plane x, y; stacking axis z; mm) to the world frame, LPS
/// unless the user requested RAS.
struct Frame {
  Vec3 origin;
  std::array<Vec3, 3> axes = {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};

  Vec3 to_world(Vec3 p) const { return origin + (p.x * axes[0] + p.y * axes[1] + p.z * axes[2]); }
  Vec3 to_stack(Vec3 p) const {
    const Vec3 d = p - origin;
    return {dot(d, axes[0]), dot(d, axes[1]), dot(d, axes[2])};
  }
  /// True when the map turns a right-handed frame into a left-handed one.
  bool mirrors() const { return dot(cross(axes[0], axes[1]), axes[2]) < 0; }
};

}  // namespace stackmesh
