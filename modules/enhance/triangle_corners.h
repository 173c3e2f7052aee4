#pragma once
// Private to the module: corners of a triangle, and short lists of numbers.
#include <algorithm>
#include <array>
#include <cstdint>

#include "enhance/complex_mesh.h"

namespace stackmesh {

inline bool holds(const std::array<std::int32_t, 3>& v, std::int32_t x) {
  return v[0] == x || v[1] == x || v[2] == x;
}

inline std::int32_t third(const std::array<std::int32_t, 3>& v, std::int32_t a, std::int32_t b) {
  for (std::int32_t x : v)
    if (x != a && x != b) return x;
  return -1;
}

/// True when the triangle runs from a to b.
inline bool runs(const std::array<std::int32_t, 3>& v, std::int32_t a, std::int32_t b) {
  return (v[0] == a && v[1] == b) || (v[1] == a && v[2] == b) || (v[2] == a && v[0] == b);
}

inline void drop(ShortList& list, std::int32_t x) {
  const auto it = std::find(list.begin(), list.end(), x);
  if (it != list.end()) list.erase(it);
}

inline bool has(const ShortList& list, std::int32_t x) {
  return std::find(list.begin(), list.end(), x) != list.end();
}

}  // namespace stackmesh
