#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "fair/net.h"

namespace stackmesh::fair {
namespace {

constexpr std::size_t kRun = 4096;  // vertices that are summed in order, whatever the number of threads

/// Minimises |L x|^2 (or |L L x|^2) over the boxes by accelerated projected gradients (\cite nesterov1983; restarts of
/// \cite odonoghue2015). L is the difference of a vertex to the mean of the neighbours that it uses, weighted by one
/// over their squared distance. The coordinates are independent of each other, so each is in voxels of its own axis.
class Bender {
 public:
  Bender(Net& net, const BendOptions& options) : net_(net), options_(options), n_(net.cell.size()) {
    double largest = 0;
    for (double h : net.spacing_mm) largest = std::max(largest, h);
    std::array<float, 3> weight;
    for (int a = 0; a < 3; ++a)
      weight[a] = static_cast<float>(largest * largest / (net.spacing_mm[a] * net.spacing_mm[a]));
    const auto uses = [&](std::size_t v, int d) { return (net.uses[v] >> d & 1) != 0; };
    std::vector<float> share(n_);
    for_each_index(n_, options.threads, [&](std::size_t v) {
      float sum = 0;
      for (int d = 0; d < kDirections; ++d)
        if (uses(v, d)) sum += weight[d / 2];
      share[v] = sum > 0 ? 1 / sum : 0;
    });
    links_.resize(n_);
    for_each_index(n_, options.threads, [&](std::size_t v) {
      Links& l = links_[v];
      l.own = net.uses[v] ? 1.0F : 0.0F;
      for (int a = 0; a < 4; ++a) l.place[a] = 0;
      for (int d = 0; d < kDirections; ++d) {
        const std::int32_t w = net.next[v][d];
        l.next[d] = w >= 0 ? w : static_cast<std::int32_t>(v);
        l.out[d] = uses(v, d) ? weight[d / 2] * share[v] : 0;
        l.in[d] = w >= 0 && uses(w, d ^ 1) ? weight[d / 2] * share[w] : 0;
        l.place[d / 2] -= (d & 1) ? l.out[d] : -l.out[d];
      }
    });
  }

  void run() {
    std::vector<Place> x(n_), y, bend(n_), slope(n_), low(n_), high(n_);
    for_each_index(n_, options_.threads, [&](std::size_t v) {
      x[v] = packed(net_.way[v]);
      low[v] = packed(net_.low[v]);
      high[v] = packed(net_.high[v]);
    });
    y = x;
    constexpr float step = 0.25F;
    double momentum = 1;
    std::vector<double> sums((n_ + kRun - 1) / kRun);
    for (int i = 0; i < options_.iterations; ++i) {
      for_each_index(
          n_, options_.threads, [&](std::size_t v) { bend[v] = difference(y, v) + links_[v].place; }, kRun);
      const double next_momentum = (1 + std::sqrt(1 + 4 * momentum * momentum)) / 2;
      const float ahead = static_cast<float>((momentum - 1) / next_momentum);
      parallel_for(sums.size(), options_.threads, [&](std::size_t run) {
        double against = 0;
        for (std::size_t v = run * kRun; v < std::min(n_, (run + 1) * kRun); ++v) {
          const Place wanted = y[v] - step * transposed(bend, v);
          const Place above = wanted < low[v] ? low[v] : wanted, to = above > high[v] ? high[v] : above;
          const Place moved = to - x[v], product = (y[v] - to) * moved;
          against += static_cast<double>(product[0]) + product[1] + product[2];
          slope[v] = to + ahead * moved;
          x[v] = to;
        }
        sums[run] = against;
      });
      double against = 0;
      for (double s : sums) against += s;
      if (against > 0) {  // the momentum has run past: start anew from here
        momentum = 1;
        y = x;
      } else {
        momentum = next_momentum;
        std::swap(y, slope);
      }
    }
    for_each_index(n_, options_.threads, [&](std::size_t v) { net_.way[v] = {x[v][0], x[v][1], x[v][2]}; });
  }

 private:
  typedef float Place __attribute__((vector_size(16)));  // three coordinates, and one that stays 0

  /// A row of L and a column of it.
  struct Links {
    Place place;  // L applied to the middles of the cells
    std::array<std::int32_t, kDirections> next;
    std::array<float, kDirections> out, in;
    float own;
  };

  static Place packed(const Float3& p) { return Place{p[0], p[1], p[2], 0}; }

  Place difference(const std::vector<Place>& in, std::size_t v) const {
    const Links& l = links_[v];
    Place sum = l.own * in[v];
    for (int d = 0; d < kDirections; ++d) sum -= l.out[d] * in[l.next[d]];
    return sum;
  }
  Place transposed(const std::vector<Place>& in, std::size_t v) const {
    const Links& l = links_[v];
    Place sum = l.own * in[v];
    for (int d = 0; d < kDirections; ++d) sum -= l.in[d] * in[l.next[d]];
    return sum;
  }

  Net& net_;
  const BendOptions& options_;
  const std::size_t n_;
  std::vector<Links> links_;
};

}  // namespace

void bend_least(Net& net, const BendOptions& options) {
  if (!net.cell.empty()) Bender(net, options).run();
}

}  // namespace stackmesh::fair
