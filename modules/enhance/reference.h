#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "enhance/complex_mesh.h"

namespace stackmesh {

/// The surface that a remeshed complex stands for: a copy of its triangles and curves, searched by place and
/// patch. Between the vertices it bulges to the planes of their normals (Phong tessellation), which makes it
/// smooth to the eye and nearly G1.
class Reference {
 public:
  /// @param faired where the sheets and the curves between three labels run, if that is known better than by `mesh`;
  /// caps, ridges and interfaces that it lacks are the mesh's own
  Reference(const ComplexMesh& mesh, double cell_mm, int threads, const ComplexMesh* faired = nullptr);
  /// True when its faces are the triangles of the mesh, in their order.
  bool is_the_mesh() const { return is_the_mesh_; }
  bool is_faired(std::int32_t face) const { return static_cast<std::size_t>(face) < faired_faces_; }

  struct Foot {
    Vec3 point, normal;
    std::int32_t face = -1;
    std::int32_t triangle = -1;  ///< of the mesh, as it was numbered at construction
    double distance_mm = 0;      ///< to the plain triangle
  };
  /// Nearest point on triangles of that patch, not further than `reach_mm`. From `hint`, the face of a foot nearby or
  /// -1, the search walks downhill over neighbours; a foot found so within `trust_mm` is taken (on a folded surface
  /// another sheet may be nearer), else all faces near p are searched.
  std::optional<Foot> nearest(const Vec3& p, std::int32_t patch, double reach_mm, std::int32_t hint,
                              double trust_mm) const;
  /// Nearest point on curves between the same patches as the curve of `key`.
  std::optional<Vec3> nearest_on_curve(const Vec3& p, std::uint64_t key, double reach_mm) const;

  /// What tells curves apart: the patches that meet there.
  static std::uint64_t curve_key(const ComplexMesh& mesh, std::int32_t a, std::int32_t b,
                                 const std::vector<std::int32_t>* patch_of = nullptr);

  /// Centres of its triangles, with their patches.
  std::size_t face_count() const { return faces_.size(); }
  Vec3 centre(std::size_t face) const {
    const auto& p = faces_[face].p;
    return (1 / 3.0) * (p[0] + p[1] + p[2]);
  }
  std::int32_t patch(std::size_t face) const { return faces_[face].patch; }

 private:
  struct Cells {
    double inverse = 1;
    std::size_t mask = 0;
    std::vector<std::uint32_t> first;
    std::vector<std::int32_t> items;
    std::int32_t cell(double x) const { return static_cast<std::int32_t>(std::floor(x * inverse)); }
    std::size_t bucket(std::int32_t i, std::int32_t j, std::int32_t k) const;
    template <class Corners>
    void build(std::size_t count, double cell_mm, int threads, Corners corners);
    template <class Visit>
    void around(const Vec3& p, double r, Visit visit) const;
  };
  struct Face {
    std::array<Vec3, 3> p;
    std::array<std::int32_t, 3> next;  ///< face of the same patch beyond the side from corner k to k + 1, or -1
    std::int32_t patch, triangle;
  };
  /// What rules a face out at a glance: its patch and the ball round it.
  struct Ball {
    float x, y, z, r;
    std::int32_t patch;
  };
  struct Segment {
    Vec3 a, b;
    std::uint64_t key;
  };
  /// A candidate for the nearest point.
  struct Candidate {
    double squared = std::numeric_limits<double>::infinity();
    std::int32_t face = -1;
    Vec3 point;
  };
  void walk(const Vec3& p, std::int32_t hint, Candidate& best) const;
  Foot foot_at(const Candidate& c) const;

  /// Adds the triangles of a mesh, with the patches that `patch_of` gives them; -1: left out.
  void add_faces(const ComplexMesh& mesh, const std::vector<std::int32_t>& patch_of, int threads);

  double cell_mm_;
  bool is_the_mesh_ = true;
  std::size_t faired_faces_ = 0;
  std::vector<Face> faces_;
  std::vector<std::array<std::array<float, 3>, 3>> normals_;  ///< of each face's corners
  std::vector<Ball> balls_;
  std::vector<Segment> segments_;
  Cells face_cells_, segment_cells_;
};

}  // namespace stackmesh
