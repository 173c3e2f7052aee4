#include "sections/slice_fields.h"

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
        s = ((f[q] - f[p]) / step2_ + static_cast<double>(q) * q - static_cast<double>(p) * p) / (2.0 * (q - p));
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
void distances(const Mask& mask, bool wanted, const std::array<double, 2>& pixel_mm, std::vector<float>& out) {
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

/// The nearest of some pieces of contour for each pixel of a box.
class NearestPiece {
 public:
  NearestPiece(const Box& box, const std::vector<BorderPiece>& pieces, const std::array<double, 2>& pixel_mm)
      : box_(box),
        pieces_(pieces),
        mm_(pixel_mm),
        piece_(box.area(), -1),
        squared_(box.area(), std::numeric_limits<float>::infinity()) {
    for (std::size_t i = 0; i < pieces_.size(); ++i) seed(static_cast<std::int32_t>(i));
    for (int pass = 0; pass < 2; ++pass) {
      for (int y = box_.y0; y < box_.y1; ++y) sweep_row(y, -1);
      for (int y = box_.y1 - 1; y >= box_.y0; --y) sweep_row(y, 1);
    }
  }
  /// mm; infinite if there is no piece in the box
  float at(int x, int y) const { return std::sqrt(squared_[index(x, y)]); }

 private:
  std::size_t index(int x, int y) const { return static_cast<std::size_t>(y - box_.y0) * box_.width() + (x - box_.x0); }

  void offer(int x, int y, std::int32_t piece) {
    const std::size_t p = index(x, y);
    if (piece < 0 || piece == piece_[p]) return;
    const BorderPiece& b = pieces_[piece];
    const double dx = (b.bx - b.ax) * mm_[0], dy = (b.by - b.ay) * mm_[1], px = (x - b.ax) * mm_[0],
                 py = (y - b.ay) * mm_[1];
    const double length = dx * dx + dy * dy, t = length > 0 ? std::clamp((px * dx + py * dy) / length, 0.0, 1.0) : 0.0;
    const float d = static_cast<float>((px - t * dx) * (px - t * dx) + (py - t * dy) * (py - t * dy));
    if (d >= squared_[p]) return;
    squared_[p] = d;
    piece_[p] = piece;
  }

  /// The pixels round the piece.
  void seed(std::int32_t i) {
    const BorderPiece& b = pieces_[i];
    const int steps = 1 + static_cast<int>(2 * std::max(std::abs(b.bx - b.ax), std::abs(b.by - b.ay)));
    for (int s = 0; s <= steps; ++s) {
      const double t = static_cast<double>(s) / steps;
      const int x = static_cast<int>(std::floor(b.ax + t * (b.bx - b.ax))),
                y = static_cast<int>(std::floor(b.ay + t * (b.by - b.ay)));
      for (int v = std::max(box_.y0, y); v <= std::min(box_.y1 - 1, y + 1); ++v)
        for (int u = std::max(box_.x0, x); u <= std::min(box_.x1 - 1, x + 1); ++u) offer(u, v, i);
    }
  }

  /// Takes over from the row at y + from_row, then along the row both ways.
  void sweep_row(int y, int from_row) {
    const int from = y + from_row;
    if (from >= box_.y0 && from < box_.y1)
      for (int x = box_.x0; x < box_.x1; ++x)
        for (int u = std::max(box_.x0, x - 1); u <= std::min(box_.x1 - 1, x + 1); ++u)
          offer(x, y, piece_[index(u, from)]);
    for (int x = box_.x0 + 1; x < box_.x1; ++x) offer(x, y, piece_[index(x - 1, y)]);
    for (int x = box_.x1 - 2; x >= box_.x0; --x) offer(x, y, piece_[index(x + 1, y)]);
  }

  const Box& box_;
  const std::vector<BorderPiece>& pieces_;
  std::array<double, 2> mm_;
  std::vector<std::int32_t> piece_;
  std::vector<float> squared_;
};

}  // namespace

Field signed_distance(const Mask& mask, const std::vector<BorderPiece>& border, const Box& box,
                      const std::array<double, 2>& pixel_mm, double limit_mm) {
  const float limit = static_cast<float>(limit_mm);
  const NearestPiece nearest(mask.box, border, pixel_mm);
  Field field;
  field.box = box;
  field.value.reserve(box.area());
  for (int y = box.y0; y < box.y1; ++y)
    for (int x = box.x0; x < box.x1; ++x) {
      const bool in = mask.in[static_cast<std::size_t>(y - mask.box.y0) * mask.box.width() + (x - mask.box.x0)] != 0;
      const float d = std::min(limit, nearest.at(x, y));
      field.value.push_back(in ? d : -d);
    }
  return field;
}

Field signed_distance(const Mask& mask, const Box& box, const std::array<double, 2>& pixel_mm, double limit_mm) {
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
