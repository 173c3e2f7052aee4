#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

namespace stackmesh {

/// Sets of integers 0 .. n-1 that only merge; the smallest member names the set.
class DisjointSets {
 public:
  /// Each of 0 .. n-1 is a set of its own.
  explicit DisjointSets(std::size_t n = 0) {
    while (parent_.size() < n) add();
  }
  /// One more integer, a set of its own.
  std::int32_t add() {
    parent_.push_back(static_cast<std::int32_t>(parent_.size()));
    return parent_.back();
  }
  /// The smallest member of the set that holds i; shortens the way to it.
  std::int32_t find(std::int32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  /// Makes one set of the two that hold i and j.
  void join(std::int32_t i, std::int32_t j) {
    i = find(i), j = find(j);
    if (i < j) parent_[j] = i;
    if (j < i) parent_[i] = j;
  }
  /// How many integers there are, in all sets.
  std::size_t size() const { return parent_.size(); }

 private:
  std::vector<std::int32_t> parent_;
};

}  // namespace stackmesh
