#include "validate/band.h"

#include <algorithm>

#include "base/parallel.h"

namespace stackmesh {
namespace {

/// A place along a row of cells where a line of centres begins or ends to give a cell one end, or both, in the label.
struct Event {
  std::int32_t label, at;
  std::int8_t any, both;
};

}  // namespace

std::vector<std::vector<BandStrip>> find_bands(const LabelRuns& runs, std::size_t labels, int threads) {
  struct Found {
    std::int32_t label;
    BandStrip strip;
  };
  const std::int32_t rows = runs.size[1], planes = runs.size[2];
  std::vector<std::vector<Found>> of_plane(static_cast<std::size_t>(planes) + 1);
  parallel_for(of_plane.size(), threads, [&](std::size_t plane) {
    const std::int32_t v = static_cast<std::int32_t>(plane) - 1;
    std::vector<Event> events;
    for (std::int32_t u = -1; u < rows; ++u) {
      events.clear();
      for (const std::int32_t plane_of : {v, v + 1})
        for (const std::int32_t row_of : {u, u + 1}) {
          if (plane_of < 0 || plane_of >= planes || row_of < 0 || row_of >= rows) continue;
          const std::size_t line =
              static_cast<std::size_t>(plane_of) * static_cast<std::size_t>(rows) + static_cast<std::size_t>(row_of);
          for (std::size_t k = runs.start[line]; k < runs.start[line + 1]; ++k) {
            const LabelRun& r = runs.runs[k];
            events.push_back({r.label, r.begin - 1, 1, 0}), events.push_back({r.label, r.end, -1, 0});
            if (r.end - r.begin > 1)
              events.push_back({r.label, r.begin, 0, 1}), events.push_back({r.label, r.end - 1, 0, -1});
          }
        }
      std::sort(events.begin(), events.end(),
                [](const Event& a, const Event& b) { return a.label != b.label ? a.label < b.label : a.at < b.at; });
      int any = 0, both = 0;
      std::int32_t since = 0;
      bool inside = false;
      for (std::size_t i = 0; i < events.size();) {
        const std::int32_t label = events[i].label, at = events[i].at;
        for (; i < events.size() && events[i].label == label && events[i].at == at; ++i)
          any += events[i].any, both += events[i].both;
        const bool mixed = any > 0 && both < 4;  // all eight centres: both ends of the cell on all four lines
        if (inside && !mixed) of_plane[plane].push_back({label, {since, at, u, v}});
        if (mixed && !inside) since = at;
        inside = mixed;
      }
    }
  });
  std::vector<std::vector<BandStrip>> bands(labels);
  for (auto& plane : of_plane) {
    for (const Found& f : plane) bands[f.label].push_back(f.strip);
    std::vector<Found>().swap(plane);
  }
  return bands;
}

std::vector<Rectangle> boxes_of_band(const LabelRuns& runs, const std::vector<BandStrip>& band, const Vec3& wider_mm) {
  std::vector<Rectangle> boxes;
  boxes.reserve(band.size());
  for (const BandStrip& s : band)
    boxes.push_back({runs.place(s.begin, s.u, s.v) - wider_mm, runs.place(s.end, s.u + 1, s.v + 1) + wider_mm});
  return boxes;
}

}  // namespace stackmesh
