#include "interpolate/slice_fields.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

namespace stackmesh::interpolate {
namespace {

/// Squared distances (mm2) along a row from columns at squared height f, with the column that gives them.
class LowerEnvelope {
 public:
  LowerEnvelope(int n, double step) : n_(n), step2_(step * step), parabola_(n), from_(n + 1) {}

  template <class Visit>
  void run(const std::vector<double>& f, Visit visit) {
    int top = -1;
    for (int q = 0; q < n_; ++q) {
      if (std::isinf(f[q])) continue;
      double s = -std::numeric_limits<double>::infinity();
      while (top >= 0) {
        const int p = parabola_[top];
        s = ((f[q] - f[p]) / step2_ + static_cast<double>(q) * q - static_cast<double>(p) * p) /
            (2.0 * (q - p));
        if (s > from_[top]) break;
        --top;
      }
      if (top < 0) s = -std::numeric_limits<double>::infinity();
      parabola_[++top] = q;
      from_[top] = s;
    }
    if (top < 0) return;
    int k = 0;
    for (int x = 0; x < n_; ++x) {
      while (k < top && from_[k + 1] < x) ++k;
      visit(x, parabola_[k]);
    }
  }

 private:
  int n_;
  double step2_;
  std::vector<int> parabola_;
  std::vector<double> from_;
};

/// Distance from each pixel with in == wanted to the nearest other one, less half a pixel; 0 for the others.
void distances(const Mask& mask, bool wanted, const std::array<double, 2>& pixel_mm,
               std::vector<float>& out) {
  const int width = mask.box.width(), height = mask.box.height();
  const double sx = pixel_mm[0], sy = pixel_mm[1];
  constexpr int kNone = std::numeric_limits<int>::max() / 4;
  std::vector<int> rows(mask.in.size(), kNone);  // to the nearest other pixel of the column
  for (int x = 0; x < width; ++x) {
    int last = -kNone;
    for (int y = 0; y < height; ++y) {
      const std::size_t p = static_cast<std::size_t>(y) * width + x;
      if ((mask.in[p] != 0) != wanted) last = y;
      rows[p] = std::min(rows[p], y - last);
    }
    last = 2 * kNone;
    for (int y = height - 1; y >= 0; --y) {
      const std::size_t p = static_cast<std::size_t>(y) * width + x;
      if ((mask.in[p] != 0) != wanted) last = y;
      rows[p] = std::min(rows[p], last - y);
    }
  }
  LowerEnvelope envelope(width, sx);
  std::vector<double> f(width);
  for (int y = 0; y < height; ++y) {
    const int* row = &rows[static_cast<std::size_t>(y) * width];
    for (int x = 0; x < width; ++x)
      f[x] = row[x] >= kNone ? std::numeric_limits<double>::infinity() : (row[x] * sy) * (row[x] * sy);
    envelope.run(f, [&](int x, int q) {
      const std::size_t p = static_cast<std::size_t>(y) * width + x;
      if ((mask.in[p] != 0) != wanted) return;
      const double dx = std::abs(x - q) * sx, dy = row[q] * sy, d = std::hypot(dx, dy);
      out[p] = static_cast<float>(d - 0.5 * std::hypot(dx * sx, dy * sy) / d);
    });
  }
}

}  // namespace

Field signed_distance(const Mask& mask, const Box& box, const std::array<double, 2>& pixel_mm,
                      double limit_mm) {
  const int width = mask.box.width(), height = mask.box.height();
  const float limit = static_cast<float>(limit_mm);
  Field field;
  field.box = box;
  field.value.resize(box.area());
  const auto crop = [&](const auto& inside_at, const auto& outside_at) {
    std::size_t to = 0;
    for (int y = box.y0; y < box.y1; ++y)
      for (int x = box.x0; x < box.x1; ++x) {
        const int mx = x - mask.box.x0, my = y - mask.box.y0;
        const bool in = mask.in[static_cast<std::size_t>(my) * width + mx] != 0;
        const float d = std::min(limit, in ? inside_at(mx, my) : outside_at(mx, my));
        field.value[to++] = in ? d : -d;
      }
  };
  const double pixel = pixel_mm[0];
  if (std::abs(pixel_mm[0] - pixel_mm[1]) <= 0.01 * std::min(pixel_mm[0], pixel_mm[1])) {
    const cv::Mat in(height, width, CV_8U, const_cast<std::uint8_t*>(mask.in.data()));
    cv::Mat out, inside, outside;
    cv::bitwise_not(in, out);
    cv::distanceTransform(in, inside, cv::DIST_L2, cv::DIST_MASK_PRECISE, CV_32F);
    cv::distanceTransform(out, outside, cv::DIST_L2, cv::DIST_MASK_PRECISE, CV_32F);
    const auto mm = [&](const cv::Mat& d) {
      return [&d, pixel](int x, int y) { return static_cast<float>((d.at<float>(y, x) - 0.5) * pixel); };
    };
    crop(mm(inside), mm(outside));
  } else {
    const float far = std::numeric_limits<float>::max();
    std::vector<float> inside(mask.in.size(), far), outside(mask.in.size(), far);
    distances(mask, true, pixel_mm, inside);
    distances(mask, false, pixel_mm, outside);
    const auto of = [&](const std::vector<float>& d) {
      return [&d, width](int x, int y) { return d[static_cast<std::size_t>(y) * width + x]; };
    };
    crop(of(inside), of(outside));
  }
  return field;
}

}  // namespace stackmesh::interpolate
