#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "fair/net.h"

namespace stackmesh::fair {
namespace {

constexpr std::size_t kRun = 4096;  // vertices that are summed in order, whatever the number of threads

/// Minimises |L x|^2 (or |L L x|^2) over the boxes by accelerated projected gradients [Nesterov 1983; restarts of
/// O'Donoghue and Candes 2015]. L is the difference of a vertex to the mean of the neighbours that it uses, weighted by one
/// over their squared distance. The coordinates are independent of each other, so each is in voxels of its own axis.
class Bender {
 public:
  Bender(Net& net, const BendOptions& options) : net_(net), options_(options), n_(net.cell.size()) {
    double largest = 0;
    for (double h : net.spacing_mm) largest = std::max(largest, h);
    for (int a = 0; a < 3; ++a) weight_[a] = static_cast<float>(largest * largest / (net.spacing_mm[a] * net.spacing_mm[a]));
    share_.resize(n_);
    used_by_.assign(n_, 0);
    for_each_index(n_, options.threads, [&](std::size_t v) {
      float sum = 0;
      for (int d = 0; d < kDirections; ++d) {
        if (net_.uses[v] >> d & 1) sum += weight_[d / 2];
        const std::int32_t w = net_.next[v][d];
        if (w >= 0 && (net_.uses[w] >> (d ^ 1) & 1)) used_by_[v] |= static_cast<std::uint8_t>(1 << d);
      }
      share_[v] = sum > 0 ? 1 / sum : 0;
    });
  }

  void run() {
    std::vector<Float3>& x = net_.way;
    std::vector<Float3> y = x, bend(n_), slope(n_);
    const float step = options_.order == 2 ? 0.25F : 0.0625F;
    double momentum = 1;
    std::vector<double> sums((n_ + kRun - 1) / kRun);
    for (int i = 0; i < options_.iterations; ++i) {
      differences(y, bend, true);
      if (options_.order == 3) {
        differences(bend, slope, false);
        transposed(slope, bend);
      }
      const double next_momentum = (1 + std::sqrt(1 + 4 * momentum * momentum)) / 2;
      const float ahead = static_cast<float>((momentum - 1) / next_momentum);
      parallel_for(sums.size(), options_.threads, [&](std::size_t run) {
        double against = 0;
        for (std::size_t v = run * kRun; v < std::min(n_, (run + 1) * kRun); ++v) {
          const Float3 down = transposed_at(bend, v);
          for (int a = 0; a < 3; ++a) {
            const float to = std::clamp(y[v][a] - step * down[a], net_.low[v][a], net_.high[v][a]);
            const float moved = to - x[v][a];
            against += static_cast<double>(y[v][a] - to) * moved;
            slope[v][a] = to + ahead * moved;
            x[v][a] = to;
          }
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
  }

 private:
  /// out = L in; with the cells' own places if `places`.
  void differences(const std::vector<Float3>& in, std::vector<Float3>& out, bool places) const {
    for_each_index(n_, options_.threads, [&](std::size_t v) {
      const std::uint8_t uses = net_.uses[v];
      Float3 sum = {0, 0, 0};
      for (int d = 0; d < kDirections; ++d) {
        if (!(uses >> d & 1)) continue;
        const Float3& w = in[net_.next[v][d]];
        const float weight = weight_[d / 2];
        for (int a = 0; a < 3; ++a) sum[a] += weight * w[a];
        if (places) sum[d / 2] += (d & 1) ? weight : -weight;
      }
      for (int a = 0; a < 3; ++a) out[v][a] = uses ? in[v][a] - share_[v] * sum[a] : 0;
    }, kRun);
  }

  Float3 transposed_at(const std::vector<Float3>& in, std::size_t v) const {
    Float3 sum = {0, 0, 0};
    if (net_.uses[v]) sum = in[v];
    const std::uint8_t used_by = used_by_[v];
    for (int d = 0; d < kDirections; ++d) {
      if (!(used_by >> d & 1)) continue;
      const std::int32_t w = net_.next[v][d];
      const float weight = weight_[d / 2] * share_[w];
      for (int a = 0; a < 3; ++a) sum[a] -= weight * in[w][a];
    }
    return sum;
  }

  void transposed(const std::vector<Float3>& in, std::vector<Float3>& out) const {
    for_each_index(n_, options_.threads, [&](std::size_t v) { out[v] = transposed_at(in, v); }, kRun);
  }

  Net& net_;
  const BendOptions& options_;
  const std::size_t n_;
  std::array<float, 3> weight_;
  std::vector<float> share_;            // one over the sum of the weights that a vertex uses
  std::vector<std::uint8_t> used_by_;   // directions in which a neighbour uses the vertex
};

}  // namespace

void bend_least(Net& net, const BendOptions& options) {
  if (!net.cell.empty()) Bender(net, options).run();
}

}  // namespace stackmesh::fair
