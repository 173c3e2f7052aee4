#include "validate/label_runs.h"

#include <algorithm>

#include "base/parallel.h"
#include "validate/boundaries.h"

namespace stackmesh {
namespace {

/// Calls visit(a, b) for the runs of two lines that overlap.
template <class Visit>
void overlaps(const LabelRuns& r, std::size_t line, std::size_t other, Visit visit) {
  std::size_t i = r.start[line], j = r.start[other];
  while (i < r.start[line + 1] && j < r.start[other + 1]) {
    if (r.runs[i].begin < r.runs[j].end && r.runs[j].begin < r.runs[i].end) visit(i, j);
    if (r.runs[i].end < r.runs[j].end) {
      ++i;
    } else {
      ++j;
    }
  }
}

void number_components(LabelRuns& r) {
  DisjointSets sets(r.runs.size());
  const std::size_t lines = r.start.size() - 1, in_plane = static_cast<std::size_t>(r.size[1]);
  for (std::size_t line = 0; line < lines; ++line) {
    const auto join = [&](std::size_t i, std::size_t j) {
      if (r.runs[i].label == r.runs[j].label) sets.join(static_cast<std::int32_t>(i), static_cast<std::int32_t>(j));
    };
    if (line % in_plane > 0) overlaps(r, line, line - 1, join);
    if (line >= in_plane) overlaps(r, line, line - in_plane, join);
  }
  for (std::size_t i = 0; i < r.runs.size(); ++i) {
    const std::int32_t root = sets.find(static_cast<std::int32_t>(i));  // the smallest member: numbered before
    if (root == static_cast<std::int32_t>(i)) {
      r.runs[i].component = static_cast<std::int32_t>(r.component_label.size());
      r.component_label.push_back(r.runs[i].label);
    } else {
      r.runs[i].component = r.runs[root].component;
    }
  }
}

}  // namespace

LabelRuns find_runs(const LabelVolume& volume, int stack_axis, int threads) {
  LabelRuns r;
  r.axis = stack_axis == 0   ? std::array<int, 3>{1, 2, 0}
           : stack_axis == 1 ? std::array<int, 3>{0, 2, 1}
                             : std::array<int, 3>{0, 1, 2};
  const std::size_t strides[3] = {1, static_cast<std::size_t>(volume.size[0]),
                                  static_cast<std::size_t>(volume.size[0]) * volume.size[1]};
  std::size_t stride[3];
  for (int k = 0; k < 3; ++k) {
    r.size[k] = volume.size[r.axis[k]];
    r.spacing_mm[k] = volume.spacing_mm[r.axis[k]];
    r.direction[k] = volume.axes[r.axis[k]];
    stride[k] = strides[r.axis[k]];
  }
  r.origin_mm = volume.origin_mm;
  const std::size_t planes = static_cast<std::size_t>(r.size[2]), in_plane = static_cast<std::size_t>(r.size[1]);
  std::vector<std::vector<LabelRun>> of_plane(planes);
  r.start.assign(planes * in_plane + 1, 0);
  parallel_for(planes, threads, [&](std::size_t v) {
    for (std::size_t u = 0; u < in_plane; ++u) {
      const std::uint16_t* line = volume.voxels.data() + v * stride[2] + u * stride[1];
      const std::size_t before = of_plane[v].size();
      for (std::int32_t w = 0, end; w < r.size[0]; w = end) {
        const std::uint16_t label = line[w * stride[0]];
        for (end = w + 1; end < r.size[0] && line[end * stride[0]] == label; ++end) {
        }
        if (label != 0) of_plane[v].push_back({w, end, label, -1});
      }
      r.start[v * in_plane + u + 1] = of_plane[v].size() - before;
    }
  });
  for (std::size_t line = 0; line + 1 < r.start.size(); ++line) r.start[line + 1] += r.start[line];
  r.runs.reserve(r.start.back());
  for (auto& plane : of_plane) {
    r.runs.insert(r.runs.end(), plane.begin(), plane.end());
    std::vector<LabelRun>().swap(plane);
  }
  number_components(r);
  return r;
}

std::vector<std::vector<FaceStrip>> find_faces(const LabelRuns& r, std::size_t labels, int threads) {
  struct Found {
    std::int32_t label;
    FaceStrip strip;
  };
  const std::int32_t in_plane = r.size[1], planes = r.size[2];
  std::vector<std::vector<Found>> of_plane(planes);
  parallel_for(planes, threads, [&](std::size_t plane) {
    const std::int32_t v = static_cast<std::int32_t>(plane);
    for (std::int32_t u = 0; u < in_plane; ++u) {
      const std::size_t line = plane * in_plane + u;
      for (std::size_t i = r.start[line]; i < r.start[line + 1]; ++i) {
        const LabelRun& run = r.runs[i];
        of_plane[v].push_back({run.label, {run.begin, run.begin + 1, u, v, 0, -1}});
        of_plane[v].push_back({run.label, {run.end - 1, run.end, u, v, 0, 1}});
      }
      for (int side = 0; side < 4; ++side) {
        const std::int8_t axis = side < 2 ? 1 : 2, sign = side % 2 == 0 ? -1 : 1;
        const std::int32_t at = (axis == 1 ? u : v) + sign;
        const bool border = at < 0 || at >= (axis == 1 ? in_plane : planes);
        const std::size_t other = border      ? 0
                                  : axis == 1 ? line + sign
                                              : line + static_cast<std::ptrdiff_t>(sign) * in_plane;
        std::size_t j = border ? 0 : r.start[other];
        const std::size_t last = border ? 0 : r.start[other + 1];
        for (std::size_t i = r.start[line]; i < r.start[line + 1]; ++i) {
          const LabelRun& run = r.runs[i];
          std::int32_t from = run.begin;
          const auto emit = [&](std::int32_t to) {
            if (to > from) of_plane[v].push_back({run.label, {from, to, u, v, axis, sign}});
          };
          while (j < last && r.runs[j].end <= run.begin) ++j;
          for (std::size_t k = j; k < last && r.runs[k].begin < run.end; ++k)
            if (r.runs[k].label == run.label) {
              emit(r.runs[k].begin);
              from = r.runs[k].end;
            }
          emit(run.end);
        }
      }
    }
  });
  std::vector<std::vector<FaceStrip>> faces(labels);
  for (auto& plane : of_plane) {
    for (const Found& f : plane) faces[f.label].push_back(f.strip);
    std::vector<Found>().swap(plane);
  }
  return faces;
}

}  // namespace stackmesh
