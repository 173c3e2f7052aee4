#include "report/decimate.h"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Core/System/omstream.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModNormalFlippingT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>
#include <algorithm>
#include <map>
#include <utility>

#include "base/cancel.h"

namespace stackmesh {
namespace {

struct Traits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
  VertexAttributes(OpenMesh::Attributes::Status);
  EdgeAttributes(OpenMesh::Attributes::Status);
  FaceAttributes(OpenMesh::Attributes::Status | OpenMesh::Attributes::Normal);
};
using Halfedges = OpenMesh::TriMesh_ArrayKernelT<Traits>;

/// Hands what a collapse takes away to what stays.
template <class MeshT>
class KeepWorstT : public OpenMesh::Decimater::ModBaseT<MeshT> {
 public:
  DECIMATING_MODULE(KeepWorstT, MeshT, KeepWorst);
  explicit KeepWorstT(Mesh& mesh) : Base(mesh, true) {}

  /// @param triangles of the faces @param distances_mm of the vertices; empty: none
  void keep(std::vector<DrawnTriangle>* triangles, std::vector<float>* distances_mm) {
    triangles_ = triangles;
    distances_mm_ = distances_mm;
  }

  void preprocess_collapse(const CollapseInfo& c) override {
    stop_if_cancelled();
    hand_on(c.v0v1);
    hand_on(c.v1v0);
    if (distances_mm_->empty()) return;
    float& kept = (*distances_mm_)[c.v1.idx()];
    kept = std::max(kept, (*distances_mm_)[c.v0.idx()]);
  }

 private:
  /// The smallest angle of the face beside h, to a face that stays.
  void hand_on(typename Mesh::HalfedgeHandle h) {
    Mesh& m = Base::mesh();
    if (m.is_boundary(h)) return;
    for (const auto side : {m.next_halfedge_handle(h), m.prev_halfedge_handle(h)}) {
      const auto beside = m.face_handle(m.opposite_halfedge_handle(side));
      if (!beside.is_valid()) continue;
      std::uint8_t& kept = (*triangles_)[beside.idx()].angle;
      kept = std::min(kept, (*triangles_)[m.face_handle(h).idx()].angle);
      return;
    }
  }

  std::vector<DrawnTriangle>* triangles_ = nullptr;
  std::vector<float>* distances_mm_ = nullptr;
};

/// OpenMesh tells of each face that it refuses; nobody is to read that.
class QuietOpenMesh {
 public:
  QuietOpenMesh() : was_enabled_(omerr().is_enabled()) { omerr().disable(); }
  ~QuietOpenMesh() {
    if (was_enabled_) omerr().enable();
  }

 private:
  const bool was_enabled_;
};

/// The patches of a surface as one halfedge mesh, a vertex where patches meet being one of each of them.
class Patches {
 public:
  Patches(const DrawnSurface& fine, const std::vector<Vec3>& points_mm) : fine_(fine), points_mm_(points_mm) {
    find_patches();
    add_faces();
    for (const auto v : mesh_.vertices())
      if (locked_[v.idx()] || mesh_.is_boundary(v)) mesh_.status(v).set_locked(true);
  }

  DrawnSurface decimate(std::size_t most) {
    mesh_.update_face_normals();
    OpenMesh::Decimater::DecimaterT<Halfedges> decimater(mesh_);
    OpenMesh::Decimater::ModQuadricT<Halfedges>::Handle quadric;
    decimater.add(quadric);
    decimater.module(quadric).unset_max_err();
    OpenMesh::Decimater::ModNormalFlippingT<Halfedges>::Handle flipping;
    decimater.add(flipping);
    KeepWorstT<Halfedges>::Handle worst;
    decimater.add(worst);
    decimater.module(worst).keep(&faces_, &distances_mm_);
    decimater.initialize();
    decimater.decimate_to_faces(0, most > refused_.size() ? most - refused_.size() : 1);
    return drawn();
  }

 private:
  /// Below, above (the smaller label first), and the solver model's set.
  using Patch = std::array<std::int32_t, 3>;

  void find_patches() {
    std::map<Patch, std::int32_t> number;
    patch_of_.reserve(fine_.triangles.size());
    patch_at_.assign(fine_.points.size(), -1);
    for (const DrawnTriangle& t : fine_.triangles) {
      const Patch key = {std::min(t.below, t.above), std::max(t.below, t.above), t.values.set};
      const std::int32_t patch = number.emplace(key, static_cast<std::int32_t>(number.size())).first->second;
      patch_of_.push_back(patch);
      for (const std::int32_t v : t.v) {
        if (patch_at_[v] == -1) patch_at_[v] = patch;
        else if (patch_at_[v] != patch) patch_at_[v] = kSeveral;
      }
    }
  }

  Halfedges::VertexHandle vertex(std::int32_t v, std::int32_t patch) {
    Halfedges::VertexHandle& handle = patch_at_[v] == kSeveral ? copies_[{patch, v}] : vertex_of_[v];
    if (handle.is_valid()) return handle;
    const Vec3& p = points_mm_[v];
    handle = mesh_.add_vertex({p.x, p.y, p.z});
    original_.push_back(v);
    locked_.push_back(patch_at_[v] == kSeveral);
    if (!fine_.distances_mm.empty()) distances_mm_.push_back(fine_.distances_mm[v]);
    return handle;
  }

  /// All faces of a patch run the same way round. Where a patch touches itself in an edge or a vertex, OpenMesh refuses
  /// faces: they stay as they are, and so do their vertices.
  void add_faces() {
    const QuietOpenMesh quiet;
    vertex_of_.resize(fine_.points.size());
    for (std::size_t i = 0; i < fine_.triangles.size(); ++i) {
      DrawnTriangle t = fine_.triangles[i];
      if (t.below > t.above) {
        std::swap(t.below, t.above);
        std::swap(t.v[1], t.v[2]);
      }
      std::array<Halfedges::VertexHandle, 3> corners;
      for (int k = 0; k < 3; ++k) corners[k] = vertex(t.v[k], patch_of_[i]);
      if (mesh_.add_face(corners[0], corners[1], corners[2]).is_valid()) {
        faces_.push_back(t);
        continue;
      }
      refused_.push_back(t);
      for (const auto v : corners) locked_[v.idx()] = 1;
    }
  }

  DrawnSurface drawn() const {
    DrawnSurface out;
    std::vector<std::int32_t> place(fine_.points.size(), -1);
    const auto add = [&](DrawnTriangle t) {
      for (std::int32_t& v : t.v) {
        if (place[v] < 0) {
          place[v] = static_cast<std::int32_t>(out.points.size());
          out.points.push_back(fine_.points[v]);
          if (!fine_.distances_mm.empty()) out.distances_mm.push_back(fine_.distances_mm[v]);
        }
        v = place[v];
      }
      out.triangles.push_back(t);
    };
    for (const auto f : mesh_.all_faces()) {
      if (mesh_.status(f).deleted()) continue;
      DrawnTriangle t = faces_[f.idx()];
      int k = 0;
      for (const auto v : mesh_.fv_range(f)) t.v[k++] = original_[v.idx()];
      add(t);
    }
    for (const DrawnTriangle& t : refused_) add(t);
    for (std::size_t n = 0; n < distances_mm_.size(); ++n)
      if (const std::int32_t v = place[original_[n]]; v >= 0)
        out.distances_mm[v] = std::max(out.distances_mm[v], distances_mm_[n]);
    return out;
  }

  static constexpr std::int32_t kSeveral = -2;

  const DrawnSurface& fine_;
  const std::vector<Vec3>& points_mm_;
  Halfedges mesh_;
  std::vector<std::int32_t> patch_of_, patch_at_;  // of triangles; at vertices: -1 none yet
  std::vector<Halfedges::VertexHandle> vertex_of_;
  std::map<std::pair<std::int32_t, std::int32_t>, Halfedges::VertexHandle> copies_;  // (patch, vertex)
  std::vector<std::int32_t> original_;                                               // of mesh_'s vertices
  std::vector<char> locked_;
  std::vector<float> distances_mm_;
  std::vector<DrawnTriangle> faces_, refused_;
};

}  // namespace

DrawnSurface decimated(const DrawnSurface& fine, const std::vector<Vec3>& points_mm, std::size_t most) {
  return Patches(fine, points_mm).decimate(most);
}

}  // namespace stackmesh
