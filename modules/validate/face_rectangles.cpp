#include "validate/face_rectangles.h"

#include <utility>

namespace stackmesh {

std::vector<Rectangle> rectangles_of(const LabelRuns& runs, const std::vector<FaceStrip>& strips) {
  std::vector<Rectangle> rectangles;
  rectangles.reserve(strips.size());
  for (const FaceStrip& s : strips) {
    double low[3] = {s.begin - 0.5, s.u - 0.5, s.v - 0.5}, high[3] = {s.end - 0.5, s.u + 0.5, s.v + 0.5};
    (s.sign > 0 ? low : high)[s.axis] = (s.sign > 0 ? high : low)[s.axis];
    rectangles.push_back({runs.place(low[0], low[1], low[2]), runs.place(high[0], high[1], high[2])});
  }
  return rectangles;
}

std::vector<Box> boxes_of(const std::vector<Rectangle>& rectangles) {
  std::vector<Box> boxes(rectangles.size());
  for (std::size_t i = 0; i < rectangles.size(); ++i) boxes[i].add(rectangles[i].low), boxes[i].add(rectangles[i].high);
  return boxes;
}

}  // namespace stackmesh
