#pragma once
#include <cstdint>
#include <vector>

#include "volume/best_place.h"
#include "volume/improve_mesh.h"

namespace stackmesh::volume {

/// The changes that may mend a tet (\cite freitag1997, \cite klingner2007). Each is made only if the worst tet
/// afterwards is better than the worst of those it replaces, so that a mesh never gets worse; unless it is shaken.
class ImproveMoves {
 public:
  explicit ImproveMoves(ImproveMesh& mesh) : m_(mesh) {}

  /// From now on tets of quality `floor` are good enough for any change but smooth(). Unset: 2.
  void accept_from(double floor) { floor_ = floor; }

  /// Moves a point to where the worst tet around it is best; tets better than `enough` do not count. True when it
  /// moved.
  bool smooth(std::int32_t vertex, double enough);
  /// Replaces the tets around an edge of t by ones without it.
  bool remove_edge(std::int32_t t);
  /// Replaces two tets by three around a new edge.
  bool remove_face(std::int32_t t);
  /// Merges a movable corner of t into another point of the tets around it.
  bool collapse(std::int32_t t);
  /// Empties a cavity around t and fills it from a new point. `thorough`: cavities of t and its neighbours, and around
  /// its edges, are tried, too.
  bool insert(std::int32_t t, double enough, bool thorough);

 private:
  // A fan is the tets of one point, their corner 0.
  double worst_of(const std::vector<std::int32_t>& tets) const;
  const std::vector<FanTet>& places_of_fan();
  /// From `cavity_`, which is grown.
  bool try_insert(Vec3 p, double enough);
  Vec3 centre_of_cavity() const;

  ImproveMesh& m_;
  double floor_ = 2;
  std::vector<std::int32_t> around_, ring_, cavity_;
  std::vector<ImproveMesh::Corners> fresh_, fan_;
  std::vector<FanTet> places_;
};

}  // namespace stackmesh::volume
