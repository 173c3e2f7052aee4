#include "sections/gap_pieces.h"

#include <map>

#include "base/disjoint_sets.h"
#include "base/parallel.h"
#include "model/slices.h"
#include "sections/extract.h"
#include "sections/section_raster.h"

namespace stackmesh {
namespace {

/// The runs of labels of a few slices, and which of them hang together.
class Pieces {
 public:
  struct Run {
    int x0, x1;  // [x0, x1)
    std::uint16_t label;
  };
  void add_row(const std::uint16_t* row, int width, std::ptrdiff_t above, std::ptrdiff_t below) {
    start_.push_back(static_cast<std::int32_t>(runs_.size()));
    for (int x = 0, end; x < width; x = end) {
      end = run_end(row, x, width);
      if (row[x] == 0) continue;
      runs_.push_back({x, end, row[x]});
      sets_.add();
    }
    const std::ptrdiff_t here = static_cast<std::ptrdiff_t>(start_.size()) - 1;
    for (const std::ptrdiff_t other : {above, below})
      if (other >= 0) join(here, other);
  }
  std::int32_t begin(std::size_t row) const { return start_[row]; }
  std::int32_t end(std::size_t row) const {
    return row + 1 < start_.size() ? start_[row + 1] : static_cast<std::int32_t>(runs_.size());
  }
  const Run& run(std::int32_t r) const { return runs_[r]; }
  std::int32_t piece(std::int32_t r) { return sets_.find(r); }
  std::size_t runs() const { return runs_.size(); }

 private:
  void join(std::size_t row, std::size_t other) {
    for (std::int32_t i = begin(row), j = begin(other); i < end(row) && j < end(other);) {
      if (runs_[i].label == runs_[j].label && runs_[i].x0 < runs_[j].x1 && runs_[j].x0 < runs_[i].x1) sets_.join(i, j);
      if (runs_[i].x1 < runs_[j].x1) ++i;
      else ++j;
    }
  }
  std::vector<Run> runs_;
  std::vector<std::int32_t> start_;
  DisjointSets sets_;
};

Pieces pieces_of(const std::vector<Slice>& slices) {
  Pieces out;
  const std::ptrdiff_t height = slices[0].height;
  for (std::size_t k = 0; k < slices.size(); ++k)
    for (std::ptrdiff_t y = 0; y < height; ++y) {
      const std::ptrdiff_t row = static_cast<std::ptrdiff_t>(k) * height + y;
      out.add_row(&slices[k].pixels[static_cast<std::size_t>(y) * slices[k].width], slices[k].width,
                  y > 0 ? row - 1 : -1, k > 0 ? row - height : -1);
    }
  return out;
}

/// Are the pieces of two versions of the same slices one to one, by the pixels that did not change?
bool one_to_one(Pieces& a, Pieces& b, std::size_t rows) {
  std::vector<std::int32_t> to_b(a.runs(), -1), to_a(b.runs(), -1);
  for (std::size_t row = 0; row < rows; ++row)
    for (std::int32_t i = a.begin(row), j = b.begin(row); i < a.end(row) && j < b.end(row);) {
      const Pieces::Run &p = a.run(i), &q = b.run(j);
      if (p.label == q.label && p.x0 < q.x1 && q.x0 < p.x1) {
        std::int32_t &there = to_b[a.piece(i)], &back = to_a[b.piece(j)];
        if (there < 0) there = b.piece(j);
        if (back < 0) back = a.piece(i);
        if (there != b.piece(j) || back != a.piece(i)) return false;
      }
      if (p.x1 < q.x1) ++i;
      else ++j;
    }
  const auto all_found = [](Pieces& pieces, const std::vector<std::int32_t>& found) {
    for (std::int32_t r = 0; r < static_cast<std::int32_t>(found.size()); ++r)
      if (found[pieces.piece(r)] < 0) return false;
    return true;
  };
  return all_found(a, to_b) && all_found(b, to_a);
}

}  // namespace

std::vector<int> gaps_with_other_pieces(const LabelVolume& dense, int stacking_axis, int period, const Stack& stack,
                                        int threads) {
  const StackAxes axes = axes_for(stacking_axis);
  std::map<Label, std::uint16_t> index_of;
  for (std::size_t k = 0; k < dense.labels.size(); ++k)
    index_of[dense.labels[k].number] = static_cast<std::uint16_t>(k);
  const int gaps = (dense.size[axes.w] - 1) / period;
  std::vector<char> other(gaps, 0);
  parallel_for(other.size(), threads, [&](std::size_t g) {
    const int first = static_cast<int>(g) * period;
    const std::vector<Slice> before = read_slices(dense, axes, first, first + period + 1);
    std::vector<Slice> after = before;
    interpolate::Raster raster;
    raster.x0 = raster.y0 = 0.5 * kGridPerPixel - 0.5;  // between grid points
    raster.unit = {kGridPerPixel, kGridPerPixel};
    raster.width = before[0].width;
    raster.height = before[0].height;
    bool changed = false;
    for (int k = 1; k < period; ++k) {
      after[k].pixels = interpolate::rasterise(stack.sections[first + k], raster, index_of).label;
      changed = changed || after[k].pixels != before[k].pixels;
    }
    if (!changed) return;
    const auto same_pieces = [&](const std::vector<Slice>& old, const std::vector<Slice>& now) {
      Pieces a = pieces_of(old), b = pieces_of(now);
      return one_to_one(a, b, old.size() * static_cast<std::size_t>(raster.height));
    };
    other[g] = !same_pieces(before, after);
    // an island that holds no pixel centre any more would be a piece of its own
    for (int k = 1; k < period && !other[g]; ++k) other[g] = !same_pieces({before[k]}, {after[k]});
  });
  std::vector<int> out;
  for (int g = 0; g < gaps; ++g)
    if (other[g]) out.push_back(g);
  return out;
}

}  // namespace stackmesh
