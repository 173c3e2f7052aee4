#include "image/segments.h"

#include <algorithm>
#include <cstdio>
#include <map>

#include "base/error.h"
#include "base/warning.h"
#include "model/label_table.h"

namespace stackmesh {
namespace {

constexpr double kInside_rel = 0.999;  // of a segment in another one is all of it
constexpr double kCovered_rel = 0.95;  // of a segment under another one leaves too little of it
constexpr std::size_t kMaxSegments = 1000;

std::string name_of(const LabelInfo& label) {
  return label.name.empty() ? "segment " + std::to_string(label.number) : "'" + label.name + "'";
}

std::string share(double part, double whole) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2g", 100 * part / whole);
  return text;
}

class Joiner {
 public:
  Joiner(const std::vector<LabelInfo>& segments, const SliceLayers& layers, const std::string& labels,
         const std::string& path, LabelVolume& volume)
      : segments_(segments), layers_(layers), path_(path), volume_(volume), by_name_(!labels.empty()) {
    if (segments.size() > kMaxSegments)
      fail_input("the file holds " + std::to_string(segments.size()) + " segments", path, "keep at most 1000 segments");
    asked_ = LabelTable(segments).in_order(labels);
    is_asked_.assign(segments.size(), false);
    for (std::size_t k : asked_) is_asked_[k] = true;
  }

  void run() {
    count();
    rank();
    paint();
    warn();
  }

 private:
  std::size_t pair(std::size_t a, std::size_t b) const { return std::min(a, b) * segments_.size() + std::max(a, b); }

  /// Calls visit(voxel of the slice, segments there) for every voxel that has any of those requested.
  template <class Visit>
  void each_voxel(int k, Visit visit) const {
    const std::size_t pixels = static_cast<std::size_t>(volume_.size[0]) * volume_.size[1];
    std::vector<std::uint16_t> first(pixels, 0);              // the first segment of each voxel, and
    std::vector<std::pair<std::size_t, std::uint16_t>> more;  // the others of the few that have several
    for (const auto& layer : layers_(k))
      for (std::size_t i = 0; i < pixels; ++i) {
        const std::uint16_t s = layer[i];
        if (s == 0 || s == first[i] || !is_asked_[s - 1]) continue;
        if (first[i] == 0) first[i] = s;
        else more.emplace_back(i, s);
      }
    std::sort(more.begin(), more.end());
    more.erase(std::unique(more.begin(), more.end()), more.end());
    std::size_t next = 0;
    std::vector<std::size_t> here;
    for (std::size_t i = 0; i < pixels; ++i) {
      if (first[i] == 0) continue;
      here.assign(1, first[i] - 1u);
      for (; next < more.size() && more[next].first == i; ++next) here.push_back(more[next].second - 1u);
      visit(i, here);
    }
  }

  void count() {
    voxels_.assign(segments_.size(), 0);
    shared_.assign(segments_.size() * segments_.size(), 0);
    for (int k = 0; k < volume_.size[2]; ++k)
      each_voxel(k, [&](std::size_t, const std::vector<std::size_t>& here) {
        for (std::size_t a = 0; a < here.size(); ++a) {
          ++voxels_[here[a]];
          for (std::size_t b = 0; b < a; ++b) ++shared_[pair(here[a], here[b])];
        }
      });
    if (by_name_)
      for (std::size_t k : asked_)
        if (voxels_[k] == 0) fail_input(name_of(segments_[k]) + " has no voxel", path_, "leave it out of --label");
  }

  void rank() {
    if (!by_name_) {
      by_rank_ = asked_;
      std::stable_sort(by_rank_.begin(), by_rank_.end(),
                       [&](std::size_t a, std::size_t b) { return voxels_[a] < voxels_[b]; });
    } else {
      for (std::size_t f : asked_) {
        const auto covers = [&](std::size_t g) {
          return voxels_[g] > voxels_[f] &&
                 static_cast<double>(shared_[pair(f, g)]) >= kCovered_rel * static_cast<double>(voxels_[f]);
        };
        by_rank_.insert(std::find_if(by_rank_.begin(), by_rank_.end(), covers), f);
      }
    }
    place_.assign(segments_.size(), 0);
    for (std::size_t i = 0; i < by_rank_.size(); ++i) place_[by_rank_[i]] = i;
  }

  void paint() {
    const std::size_t pixels = static_cast<std::size_t>(volume_.size[0]) * volume_.size[1];
    volume_.voxels.assign(pixels * volume_.size[2], 0);
    std::vector<std::size_t> own(segments_.size(), 0);
    for (int k = 0; k < volume_.size[2]; ++k)
      each_voxel(k, [&](std::size_t i, const std::vector<std::size_t>& here) {
        std::size_t best = here[0];
        for (std::size_t s : here)
          if (place_[s] < place_[best]) best = s;
        ++own[best];
        volume_.voxels[pixels * k + i] = static_cast<std::uint16_t>(best + 1);
      });
    // The palette: what has voxels, by number.
    std::vector<std::size_t> order;
    for (std::size_t s = 0; s < segments_.size(); ++s) {
      if (own[s] > 0) order.push_back(s);
      else if (is_asked_[s] && voxels_[s] == 0)
        volume_.warnings.push_back(
            warning_at(WarningCode::left_out, path_, name_of(segments_[s]) + " has no voxel and is left out"));
    }
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return segments_[a].number < segments_[b].number; });
    std::vector<std::uint16_t> target(segments_.size() + 1, 0);
    volume_.labels = {{0, ""}};
    for (std::size_t s : order) {
      target[s + 1] = static_cast<std::uint16_t>(volume_.labels.size());
      volume_.labels.push_back(segments_[s]);
    }
    for (std::uint16_t& v : volume_.voxels) v = target[v];
  }

  void warn() {
    std::map<std::size_t, std::string> inside;  // outer -> what lies in it
    for (std::size_t a = 0; a < segments_.size(); ++a)
      for (std::size_t b = a + 1; b < segments_.size(); ++b) {
        const std::size_t shared = shared_[pair(a, b)];
        if (shared == 0) continue;
        const std::size_t first = place_[a] < place_[b] ? a : b, loser = first == a ? b : a;
        char mm3[48];
        std::snprintf(mm3, sizeof mm3, "%.4g mm3", static_cast<double>(shared) * volume_.voxel_volume_mm3());
        const std::string how_much = std::to_string(shared) + (shared == 1 ? " voxel, " : " voxels, ") + mm3;
        const auto all_of = [&](std::size_t s) {
          return static_cast<double>(shared) >= kInside_rel * static_cast<double>(voxels_[s]);
        };
        const std::string of_first = share(static_cast<double>(shared), static_cast<double>(voxels_[first])),
                          of_loser = share(static_cast<double>(shared), static_cast<double>(voxels_[loser]));
        if (all_of(loser))
          volume_.warnings.push_back(warning_at(WarningCode::overlap, path_,
                                                name_of(segments_[loser]) + " lies wholly under " +
                                                    name_of(segments_[first]) + ", which has priority (" + how_much +
                                                    ")"));
        else if (all_of(first))
          inside[loser] += (inside[loser].empty() ? "" : ", ") + name_of(segments_[first]) + " (" + how_much + ")";
        else
          volume_.warnings.push_back(warning_at(WarningCode::overlap, path_,
                                                name_of(segments_[first]) + " and " + name_of(segments_[loser]) +
                                                    " overlap in " + how_much + " (" + of_first + " and " + of_loser +
                                                    " % of them), which went to " + name_of(segments_[first])));
      }
    for (const auto& [outer, names] : inside)
      volume_.warnings.push_back(warning_at(WarningCode::taken_out, path_,
                                            "inside " + name_of(segments_[outer]) + ", and taken out of it: " + names));
  }

  const std::vector<LabelInfo>& segments_;
  const SliceLayers& layers_;
  const std::string& path_;
  LabelVolume& volume_;
  const bool by_name_;
  std::vector<std::size_t> asked_, by_rank_, place_;
  std::vector<char> is_asked_;
  std::vector<std::size_t> voxels_, shared_;
};

}  // namespace

void join_segments(const std::vector<LabelInfo>& segments, const SliceLayers& layers, const std::string& labels,
                   const std::string& path, LabelVolume& volume) {
  Joiner(segments, layers, labels, path, volume).run();
}

}  // namespace stackmesh
