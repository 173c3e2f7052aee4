#include "interpolate/group_field.h"

#include <algorithm>
#include <cmath>

namespace stackmesh::interpolate {
namespace {

constexpr int kMargin = 3;            // pixels round a group that the spline may reach by overshooting
constexpr double kFullMotion = 0.05;  // relative gain of overlap from which a group follows its centre fully
constexpr double kNear = 0.25, kFar = 0.45;  // motion, in widths of the smaller slice: not followed, followed fully

constexpr double kShortest = 0.25;    // neighbouring gaps count as no shorter than this share of the gap

/// Weights of four slices at t between the second and the third: a cardinal spline; the slopes are those of
/// parabolas through three slices, so that unevenly spaced slices are no matter.
std::array<double, 4> spline_weights(double t, double tension, double beneath, double above) {
  const double t2 = t * t, t3 = t2 * t;
  const double low = 2 * tension * (t3 - 2 * t2 + t), high = 2 * tension * (t3 - t2);  // of the slopes
  const double b0 = 1 / (beneath * (beneath + 1)), b2 = beneath / (beneath + 1);
  const double a1 = above / (above + 1), a3 = 1 / (above * (above + 1));
  return {-low * b0, 2 * t3 - 3 * t2 + 1 + low * (b0 - b2) - high * a1, 3 * t2 - 2 * t3 + low * b2 + high * (a1 - a3),
          high * a3};
}

/// sum += weight * the field moved by (dx, dy) pixels, bilinear, continued beyond its box by its rim.
void add_moved(const Field& field, double dx, double dy, float weight, std::vector<float>& sum) {
  const int width = field.box.width(), height = field.box.height();
  if (dx == 0 && dy == 0) {
    for (std::size_t p = 0; p < sum.size(); ++p) sum[p] += weight * field.value[p];
    return;
  }
  const int ix = static_cast<int>(std::floor(-dx)), iy = static_cast<int>(std::floor(-dy));
  const float fx = static_cast<float>(-dx - ix), fy = static_cast<float>(-dy - iy);
  for (int y = 0; y < height; ++y) {
    const float* under = &field.value[static_cast<std::size_t>(std::clamp(y + iy, 0, height - 1)) * width];
    const float* over = &field.value[static_cast<std::size_t>(std::clamp(y + iy + 1, 0, height - 1)) * width];
    float* row = &sum[static_cast<std::size_t>(y) * width];
    const auto add = [&](int x, int left, int right) {
      row[x] += weight * ((1 - fy) * ((1 - fx) * under[left] + fx * under[right]) +
                          fy * ((1 - fx) * over[left] + fx * over[right]));
    };
    const int first = std::clamp(-ix, 0, width), last = std::clamp(width - 1 - ix, first, width);
    for (int x = 0; x < first; ++x) add(x, 0, std::clamp(x + ix + 1, 0, width - 1));
    for (int x = first; x < last; ++x) add(x, x + ix, x + ix + 1);
    for (int x = last; x < width; ++x) add(x, std::clamp(x + ix, 0, width - 1), width - 1);
  }
}

/// Pixels that are in one of the fields' shapes but not in both, the first one moved.
std::size_t difference(const Field& low, const Field& high, int dx, int dy) {
  const int width = low.box.width(), height = low.box.height();
  std::size_t in_low = 0, in_high = 0, in_both = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::size_t p = static_cast<std::size_t>(y) * width + x;
      in_high += high.value[p] > 0;
      if (!(low.value[p] > 0)) continue;
      ++in_low;
      const int mx = x + dx, my = y + dy;
      if (mx >= 0 && my >= 0 && mx < width && my < height)
        in_both += high.value[static_cast<std::size_t>(my) * width + mx] > 0;
    }
  return in_low + in_high - 2 * in_both;
}

}  // namespace

Partition::Partition(const Gap& gap) {
  low = find_islands(*gap.low);
  high = find_islands(*gap.high);
  if (gap.before != nullptr) before = find_islands(*gap.before);
  if (gap.after != nullptr) after = find_islands(*gap.after);
  groups = group_islands(low, high, gap.before != nullptr ? &before : nullptr,
                         gap.after != nullptr ? &after : nullptr);
}

template <class Belongs>
GroupField::Slice GroupField::slice(const Islands& islands, int width, const Box& from, double limit_mm,
                                    const std::array<double, 2>& pixel_mm, const Belongs& belongs) const {
  Slice s;
  Mask mask;
  mask.box = from;
  mask.in.resize(from.area());
  std::size_t to = 0;
  double count = 0;
  for (int y = from.y0; y < from.y1; ++y)
    for (int x = from.x0; x < from.x1; ++x, ++to) {
      if (!belongs(islands.of[static_cast<std::size_t>(y) * width + x])) continue;
      mask.in[to] = 255;
      s.x += x;
      s.y += y;
      ++count;
    }
  s.x /= std::max(1.0, count);
  s.y /= std::max(1.0, count);
  if (count == 0) return s;
  std::vector<BorderPiece> border;
  for (const BorderPiece& piece : islands.border)
    if ((piece.left > 0 && belongs(piece.left)) != (piece.right > 0 && belongs(piece.right))) border.push_back(piece);
  s.field = border.empty() ? signed_distance(mask, box_, pixel_mm, limit_mm)
                           : signed_distance(mask, border, box_, pixel_mm, limit_mm);
  return s;
}

GroupField::GroupField(const Partition& part, std::int32_t id, int width, int height,
                       const std::array<double, 2>& pixel_mm) {
  const Group& group = part.groups.list[id];
  box_ = group.low;
  box_.add(group.high);
  box_ = box_.grown(kMargin, width, height);
  const double everything = std::hypot(width * pixel_mm[0], height * pixel_mm[1]);
  if (!group.low.empty())
    slices_[1] = slice(part.low, width, box_, everything, pixel_mm,
                       [&](std::int32_t i) { return part.groups.of_low[i] == id; });
  if (!group.high.empty())
    slices_[2] = slice(part.high, width, box_, everything, pixel_mm,
                       [&](std::int32_t i) { return part.groups.of_high[i] == id; });
  if (group.low.empty() || group.high.empty()) {
    const std::vector<float>& only = slices_[group.low.empty() ? 2 : 1].field.value;
    peak_ = *std::max_element(only.begin(), only.end());
    return;
  }
  share_ = share_of_motion();
  // Far away the outer slices' distances would only make the spline overshoot.
  const int reach = std::max(8, std::max(box_.width(), box_.height()) / 2);
  const Box wide = box_.grown(reach, width, height);
  const double limit = reach * std::min(pixel_mm[0], pixel_mm[1]);
  const auto outer = [&](const Islands& islands, const std::vector<std::int32_t>& members) {
    if (members.empty()) return Slice{};
    std::vector<std::uint8_t> in(islands.count(), 0);
    for (std::int32_t i : members) in[i] = 1;
    return slice(islands, width, wide, limit, pixel_mm, [&](std::int32_t i) { return in[i] != 0; });
  };
  slices_[0] = outer(part.before, group.before);
  slices_[3] = outer(part.after, group.after);
}

double GroupField::share_of_motion() const {
  const Slice &low = slices_[1], &high = slices_[2];
  const int dx = static_cast<int>(std::lround(high.x - low.x)),
            dy = static_cast<int>(std::lround(high.y - low.y));
  if (dx == 0 && dy == 0) return 0;
  const double still = static_cast<double>(difference(low.field, high.field, 0, 0));
  const double moved = static_cast<double>(difference(low.field, high.field, dx, dy));
  if (!(still > 0)) return 0;
  const auto pixels = [](const Field& f) {
    return static_cast<double>(std::count_if(f.value.begin(), f.value.end(), [](float d) { return d > 0; }));
  };
  const double widths = std::hypot(dx, dy) / std::sqrt(std::min(pixels(low.field), pixels(high.field)));
  return std::clamp((1 - moved / still) / kFullMotion, 0.0, 1.0) * std::clamp((widths - kNear) / (kFar - kNear), 0.0, 1.0);
}

void GroupField::blend(double t, double tension, const std::array<double, 2>& neighbours_rel,
                       double end_at, double steps_per_mm, std::vector<int>& out) const {
  std::array<double, 4> w = {0, 0, 0, 0};
  double sunk = 0;
  if (!slices_[1].present() || !slices_[2].present()) {
    // A part that ends here: a dome, by default one that closes half way, as its voxels do.
    const int only = slices_[1].present() ? 1 : 2;
    const double away = (only == 1 ? t : 1 - t) / end_at;
    sunk = peak_ * (away < 1 ? 1 - std::sqrt(1 - away * away) : away);
    w[only] = 1;
  } else {
    const double beneath = std::max(kShortest, neighbours_rel[0]), above = std::max(kShortest, neighbours_rel[1]);
    w = spline_weights(t, tension, beneath, above);
    if (!slices_[0].present()) {  // it ends beyond: as if it went on straight
      w[1] += (1 + beneath) * w[0];
      w[2] -= beneath * w[0];
      w[0] = 0;
    }
    if (!slices_[3].present()) {
      w[2] += (1 + above) * w[3];
      w[1] -= above * w[3];
      w[3] = 0;
    }
  }
  double x = 0, y = 0;
  for (int i = 0; i < 4; ++i) {
    x += w[i] * slices_[i].x;
    y += w[i] * slices_[i].y;
  }
  std::vector<float> sum(box_.area(), static_cast<float>(-sunk * steps_per_mm));
  for (int i = 0; i < 4; ++i)
    if (slices_[i].present() && w[i] != 0)
      add_moved(slices_[i].field, share_ * (x - slices_[i].x), share_ * (y - slices_[i].y),
                static_cast<float>(w[i] * steps_per_mm), sum);
  out.resize(sum.size());
  for (std::size_t p = 0; p < sum.size(); ++p) out[p] = static_cast<int>(sum[p]);
}

}  // namespace stackmesh::interpolate
