#pragma once
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "model/stack.h"

namespace stackmesh {

/// Puts simplified arcs into a section; points of equal place get one number.
class SectionEdges {
 public:
  explicit SectionEdges(Section& section) : section_(section) {}
  /// Edges from each point to the next.
  void add(const std::vector<GridPoint>& points, Label left, Label right);

 private:
  std::int32_t number_of(GridPoint p);

  Section& section_;
  std::unordered_map<std::uint64_t, std::int32_t> numbers_;
};

}  // namespace stackmesh
