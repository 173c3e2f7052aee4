#include "sections/fill_gap.h"

#include <algorithm>
#include <limits>

#include "sections/group_field.h"

namespace stackmesh::interpolate {
namespace {

constexpr float kSteps = 4096;  // values are compared in steps of this fraction of a pixel
constexpr int kLowest = std::numeric_limits<int>::min();
constexpr int kHighest = std::numeric_limits<int>::max();

Pixels tissue_of(const Pixels& slice) {
  Pixels tissue = slice;
  for (std::uint16_t& l : tissue.label) l = l != 0 ? 1 : 0;
  tissue.border.clear();
  for (BorderPiece piece : slice.border) {
    piece.left = piece.left != 0 ? 1 : 0;
    piece.right = piece.right != 0 ? 1 : 0;
    if (piece.left != piece.right) tissue.border.push_back(piece);
  }
  return tissue;
}

class GapFiller {
 public:
  GapFiller(const Gap& gap, int per_gap, double tension, const std::array<double, 2>& pixel_mm,
            std::vector<LayerDepth>* depth)
      : gap_(gap),
        depth_(depth),
        per_gap_(per_gap),
        tension_(tension),
        pixel_mm_(pixel_mm),
        width_(gap.low->width),
        height_(gap.low->height),
        size_(gap.low->label.size()),
        labels_(gap) {}

  GapLayers run() {
    GapLayers out;
    out.width = width_;
    out.height = height_;
    for (const Group& g : labels_.groups.list) out.label.push_back(g.label);
    out.group.assign(per_gap_ + 2, std::vector<std::int32_t>(size_, 0));
    for (std::size_t p = 0; p < size_; ++p) {
      out.group.front()[p] = labels_.groups.of_low[labels_.low.of[p]];
      out.group.back()[p] = labels_.groups.of_high[labels_.high.of[p]];
    }
    collect_bodies();
    body_of_.assign(labels_.groups.list.size(), -1);
    for (std::size_t b = 0; b < bodies_.size(); ++b)
      for (std::int32_t g : bodies_[b].groups) body_of_[g] = static_cast<std::ptrdiff_t>(b);
    std::vector<int> height(size_);  // of the body that holds the pixel, 0: background
    if (depth_) depth_->resize(per_gap_);
    for (int j = 1; j <= per_gap_; ++j) {
      std::fill(height.begin(), height.end(), 0);
      if (depth_) {
        nearest_outline_.assign(size_, kLowest);
        margin_.assign(size_, 0);
        placed_.assign(size_, 0);
      }
      const double t = static_cast<double>(j) / (per_gap_ + 1);
      for (const Body& body : bodies_) place(body, t, out, height, out.group[j]);
      for (std::size_t p = 0; p < size_; ++p)
        if (gap_.low->label[p] != 0 && gap_.low->label[p] == gap_.high->label[p])
          out.group[j][p] = out.group.front()[p];
      if (depth_) (*depth_)[j - 1] = depth_of(out.group[j]);
    }
    keep_components(out);
    return out;
  }

 private:
  /// Connected tissue of the slab: its outline against the background, and the labels that share it.
  struct Body {
    GroupField outline;
    std::vector<std::int32_t> groups;
    std::vector<GroupField> fields;  // of the groups, if there are several
  };

  LayerDepth depth_of(const std::vector<std::int32_t>& layer) const {
    constexpr float kFar = 8;  // pixels
    LayerDepth depth;
    depth.tissue.resize(size_);
    depth.label.resize(size_);
    for (std::size_t p = 0; p < size_; ++p) {
      const float outline = static_cast<float>(nearest_outline_[p]) / kSteps;
      depth.tissue[p] = std::clamp(layer[p] != 0 ? outline : -outline, 0.0f, kFar);
      depth.label[p] = layer[p] == placed_[p] ? std::clamp(static_cast<float>(margin_[p]) / kSteps, 0.0f, kFar) : 0.0f;
    }
    return depth;
  }

  void collect_bodies() {
    const std::vector<Group>& groups = labels_.groups.list;
    const auto field = [&](const Partition& part, std::int32_t id) {
      return GroupField(part, id, width_, height_, pixel_mm_, gap_.gap_mm);
    };
    const bool one_label =
        std::all_of(groups.begin() + 1, groups.end(), [&](const Group& g) { return g.label == groups[1].label; });
    if (one_label) {
      for (std::size_t g = 1; g < groups.size(); ++g)
        bodies_.push_back({field(labels_, static_cast<std::int32_t>(g)), {static_cast<std::int32_t>(g)}, {}});
      return;
    }
    std::array<Pixels, 4> tissue;
    Gap gap;
    const auto convert = [&](const Pixels* from, Pixels& to) -> const Pixels* {
      if (from == nullptr) return nullptr;
      to = tissue_of(*from);
      return &to;
    };
    gap.before = convert(gap_.before, tissue[0]);
    gap.low = convert(gap_.low, tissue[1]);
    gap.high = convert(gap_.high, tissue[2]);
    gap.after = convert(gap_.after, tissue[3]);
    const Partition whole(gap);
    std::vector<std::vector<std::int32_t>> members(whole.groups.list.size());
    std::vector<std::uint8_t> seen(groups.size(), 0);
    const auto add = [&](std::int32_t group, std::int32_t body) {
      if (group == 0 || seen[group]) return;
      seen[group] = 1;
      members[body].push_back(group);
    };
    for (std::size_t p = 0; p < size_; ++p) {
      add(labels_.groups.of_low[labels_.low.of[p]], whole.groups.of_low[whole.low.of[p]]);
      add(labels_.groups.of_high[labels_.high.of[p]], whole.groups.of_high[whole.high.of[p]]);
    }
    for (std::size_t b = 1; b < members.size(); ++b) {
      if (members[b].size() == 1) {
        bodies_.push_back({field(labels_, members[b][0]), members[b], {}});
        continue;
      }
      Body body{field(whole, static_cast<std::int32_t>(b)), members[b], {}};
      for (std::int32_t g : members[b]) body.fields.push_back(field(labels_, g));
      bodies_.push_back(std::move(body));
    }
  }

  /// Gives the body its pixels at height t, where no other one has a higher claim.
  void place(const Body& body, double t, const GapLayers& out, std::vector<int>& height,
             std::vector<std::int32_t>& layer) {
    const double steps = kSteps / std::min(pixel_mm_[0], pixel_mm_[1]);
    const Box& box = body.outline.box();
    body.outline.blend(t, tension_, gap_.neighbours_rel, gap_.end_at, steps, outline_);
    if (depth_)
      for_pixels(
          box, [&](std::size_t p, std::size_t i) { nearest_outline_[p] = std::max(nearest_outline_[p], outline_[i]); });
    if (body.fields.empty()) {
      for_pixels(box, [&](std::size_t p, std::size_t i) {
        if (outline_[i] <= height[p]) return;
        height[p] = outline_[i];
        layer[p] = body.groups[0];
      });
      return;
    }
    best_.assign(box.area(), kLowest);
    second_.assign(box.area(), kLowest);
    best_group_.assign(box.area(), 0);
    for (std::size_t g = 0; g < body.groups.size(); ++g) {
      const Box& inner = body.fields[g].box();
      body.fields[g].blend(t, tension_, gap_.neighbours_rel, gap_.end_at, steps, value_);
      const std::int32_t group = body.groups[g];
      for_pixels(inner, [&](std::size_t p, std::size_t i) {
        const std::size_t x = p % width_ - box.x0, y = p / width_ - box.y0, b = y * box.width() + x;
        const bool tie = value_[i] == best_[b] && rank(out, group, p) > rank(out, best_group_[b], p);
        if (value_[i] <= best_[b] && !tie) {
          second_[b] = std::max(second_[b], value_[i]);
          return;
        }
        second_[b] = best_[b];
        best_[b] = value_[i];
        best_group_[b] = group;
      });
    }
    for_pixels(box, [&](std::size_t p, std::size_t i) {
      const bool tissue = gap_.low->label[p] != 0 && gap_.high->label[p] != 0 &&
                          body_of_[out.group.front()[p]] == &body - bodies_.data();
      const int claim = tissue ? kHighest : outline_[i];
      if (claim <= height[p] || best_group_[i] == 0) return;
      height[p] = claim;
      layer[p] = best_group_[i];
      if (!depth_) return;
      placed_[p] = best_group_[i];
      margin_[p] =
          second_[i] == kLowest
              ? kHighest
              : static_cast<int>(std::min<std::int64_t>(kHighest, static_cast<std::int64_t>(best_[i]) - second_[i]));
    });
  }

  /// Of groups with equal claims at a pixel, the one of the lower slice wins, then that of the upper one.
  static int rank(const GapLayers& out, std::int32_t group, std::size_t p) {
    return group == out.group.front()[p] ? 2 : group == out.group.back()[p] ? 1 : 0;
  }

  template <class Visit>
  void for_pixels(const Box& box, Visit visit) const {
    std::size_t i = 0;
    for (int y = box.y0; y < box.y1; ++y) {
      std::size_t p = static_cast<std::size_t>(y) * width_ + box.x0;
      for (int x = box.x0; x < box.x1; ++x) visit(p++, i++);
    }
  }

  const Gap& gap_;
  std::vector<LayerDepth>* depth_;
  int per_gap_;
  double tension_;
  std::array<double, 2> pixel_mm_;
  int width_, height_;
  std::size_t size_;
  Partition labels_;
  std::vector<Body> bodies_;
  std::vector<std::ptrdiff_t> body_of_;  // of a group
  std::vector<int> outline_, value_, best_, second_;
  std::vector<std::int32_t> best_group_;
  std::vector<int> nearest_outline_, margin_;  // per pixel of the layer, if depths are requested
  std::vector<std::int32_t> placed_;
};

}  // namespace

GapLayers fill_gap(const Gap& gap, int per_gap, double tension, const std::array<double, 2>& pixel_mm,
                   std::vector<LayerDepth>* depth) {
  return GapFiller(gap, per_gap, tension, pixel_mm, depth).run();
}

}  // namespace stackmesh::interpolate
