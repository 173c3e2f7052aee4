#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "model/complex.h"
#include "model/label_volume.h"
#include "model/stack.h"
#include "validate/check_surface.h"

namespace stackmesh {

/// What the slices say of a label's topology, and what its surface has.
struct LabelTopology {
  Label label = 0;           ///< never the background
  long handles = 0;          ///< tunnels and loops of its surface
  long implied_handles = 0;  ///< at most so many are in the slices, if parts go on where they overlap
  int pieces = 0;            ///< solid pieces of its surface
  int implied_pieces = 0;    ///< pieces of its slices, if parts go on where they overlap
  /// Handles that no slice implies.
  long surplus() const { return handles > implied_handles ? handles - implied_handles : 0; }
};

/// How slices are looked at.
struct TopologyOptions {
  int axis = 2;              ///< along which a volume's slices are stacked
  int threads = 0;           ///< 0: all
  double most_pixels = 6e8;  ///< of all slices and labels; more are not looked at
};

/// For each label whose surface has handles: how many the label's slices imply. In a slice a label is a nest of
/// outlines; what lies inside an outline in one slice is taken to go on in the next one where it overlaps it, solid and
/// hollow alike. A hollow that opens at n places is n - 1 tunnels. So no tunnel counts that no slice has. Empty if
/// there is too much to look at.
std::vector<LabelTopology> check_topology(const SurfaceCheck& surface, const LabelVolume& volume,
                                          const TopologyOptions& options = {});

/// The same for drawn sections (interpolated ones do not count); all labels, since more pieces than drawn count as
/// well.
std::vector<LabelTopology> check_topology(const SurfaceCheck& surface, const Stack& sections,
                                          const TopologyOptions& options = {});

/// A closed way round a handle.
struct HandlePlace {
  Vec3 where;                           ///< mm, the middle of the loop
  double size_mm = 0;                   ///< largest extent of the loop's box
  std::vector<std::int32_t> triangles;  ///< along it
};

/// The `most` narrowest handles of a label's surface.
std::vector<HandlePlace> find_handles(const InterfaceComplex& complex, Label label, std::size_t most);

}  // namespace stackmesh
