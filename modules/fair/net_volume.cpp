#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "fair/net.h"

namespace stackmesh::fair {
namespace {

Float3 operator-(const Float3& a, const Float3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Float3 cross(const Float3& a, const Float3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
float dot(const Float3& a, const Float3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

constexpr float kNeighbours = 0.8F;  // share of the neighbours in a step of averaging

/// In voxels of their own axis, where the ratio of volume and area vector is right in any metric.
class LocalVolumes {
 public:
  LocalVolumes(Net& net, int threads) : net_(net), threads_(threads), n_(net.cell.size()) {
    // Quads around each vertex, in the order of the quads.
    start_.assign(n_ + 1, 0);
    for (const Net::Quad& q : net.quads)
      for (std::int32_t v : q.corner) ++start_[v + 1];
    for (std::size_t v = 0; v < n_; ++v) start_[v + 1] += start_[v];
    items_.resize(start_[n_]);
    std::vector<std::int32_t> at(start_.begin(), start_.end() - 1);
    for (std::size_t q = 0; q < net.quads.size(); ++q)
      for (std::int32_t v : net.quads[q].corner) items_[at[v]++] = static_cast<std::int32_t>(q);
  }

  void restore(int reach, int rounds) {
    std::vector<std::array<float, 2>> sums(n_), next(n_);  // volume gained and area, averaged along the net
    const double largest = *std::max_element(net_.spacing_mm.begin(), net_.spacing_mm.end());
    std::array<float, 3> weight, h;
    for (int a = 0; a < 3; ++a) {
      weight[a] = static_cast<float>(largest * largest / (net_.spacing_mm[a] * net_.spacing_mm[a]));
      h[a] = static_cast<float>(net_.spacing_mm[a] / largest);
    }
    // A step of averaging takes most of the neighbours' mean; only vertices of one sheet count.
    struct Mean {
      std::array<std::int32_t, kDirections> next;
      std::array<float, kDirections> share;
      float own;
    };
    std::vector<Mean> means(n_);
    for_each_index(n_, threads_, [&](std::size_t v) {
      Mean& m = means[v];
      float total = 0;
      for (int d = 0; d < kDirections; ++d) {
        const std::int32_t w = net_.next[v][d];
        const bool counts = !net_.curve[v] && w >= 0 && !net_.curve[w];
        m.next[d] = counts ? w : static_cast<std::int32_t>(v);
        m.share[d] = counts ? weight[d / 2] : 0;
        total += m.share[d];
      }
      for (float& x : m.share) x *= total > 0 ? kNeighbours / total : 0;
      m.own = total > 0 ? 1 - kNeighbours : 1;
    });
    std::vector<Float3> normal(n_);
    for (int round = 0; round < rounds; ++round) {
      for_each_index(n_, threads_, [&](std::size_t v) {
        if (net_.curve[v]) {
          sums[v] = {0, 0};
          return;
        }
        const Float3 before = area(v, 0), half = area(v, 0.5F), now = area(v, 1);
        Float3 mean;
        for (int a = 0; a < 3; ++a) mean[a] = (before[a] + 4 * half[a] + now[a]) / 6;
        Float3 n;  // in a metric of cubes
        for (int a = 0; a < 3; ++a) n[a] = now[a] / h[a];
        const float length = std::sqrt(dot(n, n));
        sums[v] = {dot(net_.way[v], mean), length};
        for (int a = 0; a < 3; ++a) normal[v][a] = length > 0 ? n[a] / length / h[a] : 0;  // a step along it, in voxels
      });
      for (int step = 0; step < reach; ++step) {
        for_each_index(
            n_, threads_,
            [&](std::size_t v) {
              const Mean& m = means[v];
              std::array<float, 2> sum = {m.own * sums[v][0], m.own * sums[v][1]};
              for (int d = 0; d < kDirections; ++d)
                for (int i = 0; i < 2; ++i) sum[i] += m.share[d] * sums[m.next[d]][i];
              next[v] = sum;
            },
            4096);
        std::swap(sums, next);
      }
      for_each_index(n_, threads_, [&](std::size_t v) {
        if (net_.curve[v] || !(sums[v][1] > 0)) return;
        const float back = sums[v][0] / sums[v][1];
        for (int a = 0; a < 3; ++a)
          net_.way[v][a] = std::clamp(net_.way[v][a] - back * normal[v][a], net_.low[v][a], net_.high[v][a]);
      });
    }
  }

 private:
  /// Area vector of a quarter of the quads around v with a share of all ways gone, from the smaller label to the
  /// larger.
  Float3 area(std::size_t v, float share) const {
    Float3 sum = {0, 0, 0};
    const Cell& origin = net_.cell[v];
    for (std::int32_t i = start_[v]; i < start_[v + 1]; ++i) {
      const Net::Quad& q = net_.quads[items_[i]];
      std::array<Float3, 4> p;
      for (int k = 0; k < 4; ++k) {
        const Cell& c = net_.cell[q.corner[k]];
        const Float3& w = net_.way[q.corner[k]];
        p[k] = {static_cast<float>(c.x - origin.x) + share * w[0], static_cast<float>(c.y - origin.y) + share * w[1],
                static_cast<float>(c.z - origin.z) + share * w[2]};
      }
      const Float3 twice = cross(p[2] - p[0], p[3] - p[1]);
      const float sign = q.low < q.high ? 0.125F : -0.125F;
      for (int a = 0; a < 3; ++a) sum[a] += sign * twice[a];
    }
    return sum;
  }

  Net& net_;
  const int threads_;
  const std::size_t n_;
  std::vector<std::int32_t> start_, items_;
};

}  // namespace

void restore_local_volumes(Net& net, int reach, int rounds, int threads) {
  if (!net.cell.empty()) LocalVolumes(net, threads).restore(reach, rounds);
}

}  // namespace stackmesh::fair
