#include "sections/group_field.h"

#include <algorithm>
#include <cmath>

namespace stackmesh::interpolate {
namespace {

constexpr int kMargin = 3;                   // pixels round a group that the spline may reach by overshooting
constexpr double kFullMotion = 0.05;         // relative gain of overlap from which a group follows its centre fully
constexpr double kNear = 0.25, kFar = 0.45;  // motion, in widths of the smaller slice: not followed, followed fully
// a slice of so large a share of the area of that before it may be where a body was cut
constexpr double kNoBall_rel = 0.7;
constexpr double kNearestEnd = 0.2, kFurthestEnd = 0.95;  // shares of a gap

constexpr double kShortest = 0.25;  // neighbouring gaps count as no shorter than this share of the gap

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

/// Pixels of the islands that belong, with what lies in their holes.
template <class Belongs>
double enclosed_pixels(const Islands& islands, int width, const Belongs& belongs) {
  Box box;
  for (std::int32_t i = 1; i < islands.count(); ++i)
    if (belongs(i)) box.add(islands.box[i]);
  if (box.empty()) return 0;
  const int wide = box.width() + 2, high = box.height() + 2;  // a rim all round, from which the outside is flooded
  std::vector<std::uint8_t> closed(static_cast<std::size_t>(wide) * high, 0);
  for (int y = box.y0; y < box.y1; ++y)
    for (int x = box.x0; x < box.x1; ++x)
      closed[static_cast<std::size_t>(y - box.y0 + 1) * wide + (x - box.x0 + 1)] =
          belongs(islands.of[static_cast<std::size_t>(y) * width + x]);
  std::vector<std::size_t> open = {0};
  closed[0] = 1;
  std::size_t outside = 1;
  while (!open.empty()) {
    const std::size_t at = open.back();
    open.pop_back();
    const std::size_t x = at % wide, y = at / wide;
    const auto visit = [&](std::size_t next) {
      if (closed[next]) return;
      closed[next] = 1;
      ++outside;
      open.push_back(next);
    };
    if (x > 0) visit(at - 1);
    if (x + 1 < static_cast<std::size_t>(wide)) visit(at + 1);
    if (y > 0) visit(at - wide);
    if (y + 1 < static_cast<std::size_t>(high)) visit(at + wide);
  }
  return static_cast<double>(closed.size() - outside);
}

/// Where in the gap beyond a slice of this area a ball ends that has the other area a gap before it, as a share of the
/// gap; 0 when the areas do not say: no slice before, or one that is hardly larger.
double end_of_ball(double here_mm2, double before_mm2, double gap_mm) {
  if (!(before_mm2 > 0) || here_mm2 >= kNoBall_rel * before_mm2) return 0;
  // A plane a height h below the pole of a ball of radius R has the area pi (2 R h - h^2).
  const double p = (before_mm2 - here_mm2) / M_PI / gap_mm + gap_mm, q = here_mm2 / M_PI;
  return std::clamp((std::sqrt(p * p + 4 * q) - p) / (2 * gap_mm), kNearestEnd, kFurthestEnd);
}

/// The share of the gap at which a group ends that only one slice has; 0: not known.
double where_it_ends(const Partition& part, std::int32_t id, int width, const std::array<double, 2>& pixel_mm,
                     double gap_mm) {
  const Group& group = part.groups.list[id];
  const bool up = group.high.empty();  // it ends above the lower slice
  const Islands &own = up ? part.low : part.high, &next = up ? part.before : part.after;
  const std::vector<std::int32_t>&of = up ? part.groups.of_low : part.groups.of_high,
        &members = up ? group.before : group.after;
  const Box& box = up ? group.low : group.high;
  const auto goes_on = [&](std::int32_t i) {
    if (!members.empty()) return std::find(members.begin(), members.end(), i) != members.end();
    const Box& b = next.box[i];  // a wall that is thinner than what its end moved by lies round it
    return next.label[i] == group.label && b.x0 <= box.x0 && b.y0 <= box.y0 && b.x1 >= box.x1 && b.y1 >= box.y1;
  };
  const double pixel = pixel_mm[0] * pixel_mm[1];
  return end_of_ball(pixel * enclosed_pixels(own, width, [&](std::int32_t i) { return of[i] == id; }),
                     pixel * enclosed_pixels(next, width, goes_on), gap_mm);
}

}  // namespace

Partition::Partition(const Gap& gap) {
  low = find_islands(*gap.low);
  high = find_islands(*gap.high);
  if (gap.before != nullptr) before = find_islands(*gap.before);
  if (gap.after != nullptr) after = find_islands(*gap.after);
  groups = group_islands(low, high, gap.before != nullptr ? &before : nullptr, gap.after != nullptr ? &after : nullptr);
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
                       const std::array<double, 2>& pixel_mm, double gap_mm) {
  const Group& group = part.groups.list[id];
  box_ = group.low;
  box_.add(group.high);
  box_ = box_.grown(kMargin, width, height);
  const double everything = std::hypot(width * pixel_mm[0], height * pixel_mm[1]);
  if (!group.low.empty())
    slices_[1] =
        slice(part.low, width, box_, everything, pixel_mm, [&](std::int32_t i) { return part.groups.of_low[i] == id; });
  if (!group.high.empty())
    slices_[2] = slice(part.high, width, box_, everything, pixel_mm,
                       [&](std::int32_t i) { return part.groups.of_high[i] == id; });
  if (group.low.empty() || group.high.empty()) {
    const std::vector<float>& only = slices_[group.low.empty() ? 2 : 1].field.value;
    peak_ = *std::max_element(only.begin(), only.end());
    if (gap_mm > 0) ends_at_ = where_it_ends(part, id, width, pixel_mm, gap_mm);
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
  const int dx = static_cast<int>(std::lround(high.x - low.x)), dy = static_cast<int>(std::lround(high.y - low.y));
  if (dx == 0 && dy == 0) return 0;
  const double still = static_cast<double>(difference(low.field, high.field, 0, 0));
  const double moved = static_cast<double>(difference(low.field, high.field, dx, dy));
  if (!(still > 0)) return 0;
  const auto pixels = [](const Field& f) {
    return static_cast<double>(std::count_if(f.value.begin(), f.value.end(), [](float d) { return d > 0; }));
  };
  const double widths = std::hypot(dx, dy) / std::sqrt(std::min(pixels(low.field), pixels(high.field)));
  return std::clamp((1 - moved / still) / kFullMotion, 0.0, 1.0) *
         std::clamp((widths - kNear) / (kFar - kNear), 0.0, 1.0);
}

void GroupField::blend(double t, double tension, const std::array<double, 2>& neighbours_rel, double end_at,
                       double steps_per_mm, std::vector<int>& out) const {
  std::array<double, 4> w = {0, 0, 0, 0};
  double sunk = 0;
  if (!slices_[1].present() || !slices_[2].present()) {
    // A part that ends here: a dome, by default one that closes half way, as its voxels do.
    const int only = slices_[1].present() ? 1 : 2;
    const double away = (only == 1 ? t : 1 - t) / (ends_at_ > 0 ? ends_at_ : end_at);
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
