#include "sections/keep_components.h"

#include <algorithm>
#include <array>
#include <limits>

namespace stackmesh::interpolate {
namespace {

struct Voxel {
  std::int32_t layer;
  std::uint32_t pixel;
};

class Mender {
 public:
  explicit Mender(GapLayers& gap) : gap_(gap), count_(static_cast<int>(gap.group.size())) {}

  std::size_t run() {
    if (shares_labels()) part_groups();
    drop_fragments();
    refill();
    return dropped_.size();
  }

 private:
  bool shares_labels() const {
    std::vector<std::uint16_t> labels(gap_.label.begin() + 1, gap_.label.end());
    std::sort(labels.begin(), labels.end());
    return std::adjacent_find(labels.begin(), labels.end()) != labels.end();
  }

  bool fixed(Voxel v) const {
    return v.layer == 0 || v.layer + 1 == count_ ||
           (gap_.group.front()[v.pixel] != 0 && gap_.group.front()[v.pixel] == gap_.group.back()[v.pixel]);
  }

  template <class Visit>
  void for_neighbours(Voxel v, Visit visit) const {
    const std::uint32_t x = v.pixel % gap_.width;
    if (x > 0) visit(Voxel{v.layer, v.pixel - 1});
    if (x + 1 < static_cast<std::uint32_t>(gap_.width)) visit(Voxel{v.layer, v.pixel + 1});
    if (v.pixel >= static_cast<std::uint32_t>(gap_.width)) visit(Voxel{v.layer, v.pixel - gap_.width});
    if (v.pixel + gap_.width < gap_.group[0].size()) visit(Voxel{v.layer, v.pixel + gap_.width});
    if (v.layer > 0) visit(Voxel{v.layer - 1, v.pixel});
    if (v.layer + 1 < count_) visit(Voxel{v.layer + 1, v.pixel});
  }
  std::int32_t at(Voxel v) const { return gap_.group[v.layer][v.pixel]; }
  bool clash(std::int32_t a, std::int32_t b) const {
    return a != b && a != 0 && b != 0 && gap_.label[a] == gap_.label[b];
  }

  /// Takes away both sides of every face between two groups of a label, where they are free: of two that face
  /// each other one at least is.
  void part_groups() {
    std::vector<Voxel> offending;
    const auto check = [&](Voxel a, Voxel b) {
      if (!clash(at(a), at(b))) return;
      if (!fixed(a)) offending.push_back(a);
      if (!fixed(b)) offending.push_back(b);
    };
    const std::uint32_t width = gap_.width, size = static_cast<std::uint32_t>(gap_.group[0].size());
    for (std::int32_t layer = 0; layer < count_; ++layer) {
      const bool last = layer + 1 == count_;
      const std::int32_t* here = gap_.group[layer].data();
      const std::int32_t* above = last ? here : gap_.group[layer + 1].data();
      for (std::uint32_t p = 0; p < size; ++p) {
        if (here[p] == 0) continue;
        if (here[p] != above[p]) check({layer, p}, {layer + 1, p});
        if (p % width + 1 < width && here[p] != here[p + 1]) check({layer, p}, {layer, p + 1});
        if (p + width < size && here[p] != here[p + width]) check({layer, p}, {layer, p + width});
      }
    }
    drop(offending);
  }

  /// Takes away what does not reach a real slice within its group.
  void drop_fragments() {
    const std::size_t size = gap_.group[0].size();
    std::vector<std::vector<std::uint8_t>> attached(count_, std::vector<std::uint8_t>(size, 0));
    attached.front().assign(size, 1);
    attached.back().assign(size, 1);
    const auto inherit = [&](int layer, int from) {
      const std::int32_t *here = gap_.group[layer].data(), *there = gap_.group[from].data();
      const std::uint8_t* source = attached[from].data();
      std::uint8_t* target = attached[layer].data();
      for (std::size_t p = 0; p < size; ++p) target[p] |= static_cast<std::uint8_t>(here[p] == there[p]) & source[p];
    };
    for (int layer = 1; layer + 1 < count_; ++layer) inherit(layer, layer - 1);
    for (int layer = count_ - 2; layer > 0; --layer) inherit(layer, layer + 1);
    std::vector<Voxel> loose, front;
    for (std::int32_t layer = 1; layer + 1 < count_; ++layer)
      for (std::size_t p = 0; p < size; ++p)
        if (attached[layer][p] == 0 && gap_.group[layer][p] != 0)
          loose.push_back({layer, static_cast<std::uint32_t>(p)});
    const auto grow = [&](Voxel v) {
      for_neighbours(v, [&](Voxel n) {
        if (attached[v.layer][v.pixel] == 0 && attached[n.layer][n.pixel] != 0 && at(n) == at(v)) {
          attached[v.layer][v.pixel] = 1;
          front.push_back(v);
        }
      });
    };
    for (Voxel v : loose) grow(v);
    while (!front.empty()) {
      const Voxel v = front.back();
      front.pop_back();
      for_neighbours(v, [&](Voxel n) {
        if (attached[n.layer][n.pixel] == 0 && at(n) == at(v)) {
          attached[n.layer][n.pixel] = 1;
          front.push_back(n);
        }
      });
    }
    loose.erase(std::remove_if(loose.begin(), loose.end(), [&](Voxel v) { return attached[v.layer][v.pixel] != 0; }),
                loose.end());
    drop(loose);
  }

  void drop(const std::vector<Voxel>& voxels) {
    for (Voxel v : voxels) {
      std::int32_t& group = gap_.group[v.layer][v.pixel];
      if (group == 0) continue;
      group = 0;
      dropped_.push_back(v);
    }
  }

  /// Inside tissue, a voxel that was taken away goes to the neighbour with most faces that may have it.
  void refill() {
    const auto inside = [&](Voxel v) { return gap_.group.front()[v.pixel] != 0 && gap_.group.back()[v.pixel] != 0; };
    for (Voxel v : dropped_) {
      if (!inside(v)) continue;
      std::array<std::int32_t, 6> near = {};
      int n = 0;
      for_neighbours(v, [&](Voxel other) { near[n++] = at(other); });
      int best_faces = 0;
      std::int32_t best = 0;
      for (int i = 0; i < n; ++i) {
        const int faces = static_cast<int>(std::count(near.begin(), near.begin() + n, near[i]));
        const bool free = near[i] != 0 && std::none_of(near.begin(), near.begin() + n,
                                                       [&](std::int32_t g) { return clash(g, near[i]); });
        if (free && faces > best_faces) {
          best_faces = faces;
          best = near[i];
        }
      }
      gap_.group[v.layer][v.pixel] = best;
    }
  }

  GapLayers& gap_;
  int count_;
  std::vector<Voxel> dropped_;
};

}  // namespace

std::size_t keep_components(GapLayers& gap) {
  return Mender(gap).run();
}

}  // namespace stackmesh::interpolate
