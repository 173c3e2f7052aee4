#pragma once
#include <array>
#include <cmath>
#include <cstdint>

namespace stackmesh {

/// A tissue label as its input numbers it; 0 is the background.
using Label = std::int32_t;

/// A point or vector in mm.
struct Vec3 {
  double x = 0;  ///< along the first axis of its Space
  double y = 0;  ///< along the second one
  double z = 0;  ///< along the third one
};

inline Vec3 operator+(Vec3 a, Vec3 b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Vec3 operator-(Vec3 a, Vec3 b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Vec3 operator*(double s, Vec3 a) {
  return {s * a.x, s * a.y, s * a.z};
}
inline double dot(Vec3 a, Vec3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Vec3 cross(Vec3 a, Vec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double norm(Vec3 a) {
  return std::sqrt(dot(a, a));
}

/// What coordinates count from; all are mm. One world frame turns into another by change_space() (model/space.h).
enum class Space {
  stack,  ///< x, y in the plane, z along the stacking axis
  lps,    ///< the world: to the patient's left, posterior and superior
  ras,    ///< the world: right, anterior, superior
  none    ///< the axes that the input came in: no anatomy is known
};

/// As reports and options write it.
inline const char* to_text(Space space) {
  return space == Space::stack ? "stack" : space == Space::lps ? "lps" : space == Space::ras ? "ras" : "none";
}

/// A rigid (possibly mirroring) map p -> origin + x * axes[0] + y * axes[1] + z * axes[2]; the axes are
/// orthonormal. It takes stack coordinates (in-plane x, y; stacking axis z; mm) to the world.
struct Frame {
  Vec3 origin;                                                               ///< where 0, 0, 0 lies in the world
  std::array<Vec3, 3> axes = {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};  ///< of the stack, in the world
  Space world = Space::lps;  ///< where it leads: LPS, or the input's own axes where no anatomy is known

  /// A point of the stack in the world, mm.
  Vec3 to_world(Vec3 p) const { return origin + (p.x * axes[0] + p.y * axes[1] + p.z * axes[2]); }
  /// The inverse of to_world().
  Vec3 to_stack(Vec3 p) const {
    const Vec3 d = p - origin;
    return {dot(d, axes[0]), dot(d, axes[1]), dot(d, axes[2])};
  }
  /// True when the map turns a right-handed frame into a left-handed one.
  bool mirrors() const { return dot(cross(axes[0], axes[1]), axes[2]) < 0; }
};

}  // namespace stackmesh
