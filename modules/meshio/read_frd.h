#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "model/geometry.h"

namespace stackmesh {

/// Results of CalculiX at its nodes.
struct FrdResult {
  std::vector<std::int64_t> numbers;  ///< of the nodes, as in the deck
  std::vector<Vec3> points;           ///< of the nodes before the load, beside `numbers`, in the deck's unit (mm)
  /// Fields of the last step, rows as the nodes' (0 where a node has none): "DISP" 3 components, "STRESS" 6 (xx, yy,
  /// zz, xy, yz, zx).
  std::map<std::string, std::vector<std::array<double, 6>>> fields;
};

/// A result file of CalculiX (`.frd`, text). @throws Error(input) for a file that is none, is cut off, or is binary
FrdResult read_frd(const std::string& path);

}  // namespace stackmesh
