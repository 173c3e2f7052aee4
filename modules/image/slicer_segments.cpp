#include "image/slicer_segments.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "base/error.h"
#include "base/warning.h"

namespace stackmesh {
namespace {

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> parts = {""};
  for (char c : text) {
    if (c == at) parts.emplace_back();
    else parts.back() += c;
  }
  return parts;
}

/// Six index bounds at the end of "a;b;...": the extent of the geometry that the segments were drawn on.
bool reference_extent(const TextHeader& header, std::array<double, 6>& extent, const std::string& path) {
  const std::string field = "Segmentation_ConversionParameters";
  for (const std::string& parameter : split(header.get("=" + field), '&')) {
    const std::vector<std::string> parts = split(parameter, '|');
    if (parts.size() < 2 || trim(parts[0]) != "Reference image geometry") continue;
    std::vector<double> n;
    for (const std::string& word : split(parts[1], ';'))
      if (!trim(word).empty()) n.push_back(to_number(trim(word), field, path));
    if (n.size() != 22) return false;  // a matrix of 16, and the extent
    std::copy(n.begin() + 16, n.end(), extent.begin());
    return true;
  }
  return false;
}

/// The numbers of "Segment7_...", which need not be without holes.
std::set<int> segment_numbers(const TextHeader& header) {
  std::set<int> found;
  for (const auto& entry : header.fields) {
    if (entry.first.compare(0, 8, "=Segment") != 0) continue;
    const std::size_t end = entry.first.find_first_not_of("0123456789", 8);
    if (end == 8 || end == std::string::npos || end > 16 || entry.first[end] != '_') continue;
    found.insert(std::stoi(entry.first.substr(8, end - 8)));
  }
  return found;
}

}  // namespace

SlicerSegmentation read_slicer_segments(const TextHeader& header, const std::array<double, 3>& size, int layers,
                                        const std::string& path) {
  SlicerSegmentation found;
  std::set<Label> values;
  bool own_numbers = true;
  for (const int i : segment_numbers(header)) {
    const std::string key = "Segment" + std::to_string(i) + "_";
    const auto get = [&](const char* field) { return header.get("=" + key + field); };
    if (get("ID").empty() && get("Name").empty() && get("LabelValue").empty()) continue;
    SlicerSegment s;
    s.label.name = get("Name").empty() ? get("ID") : get("Name");
    // Before Slicer 4.11 each segment was a layer of its own, with the value 1.
    const double value = get("LabelValue").empty() ? 1 : to_number(get("LabelValue"), key + "LabelValue", path);
    const double layer = get("Layer").empty() ? (layers > 1 ? i : 0) : to_number(get("Layer"), key + "Layer", path);
    if (!(value >= 0 && value < 2147483648.0) || value != std::floor(value))
      fail_input("the header is damaged: '" + key + "LabelValue'", path, "save the segmentation again");
    if (!(layer >= 0 && layer < layers) || layer != std::floor(layer))
      fail_input("the header is damaged: '" + key + "Layer' names no layer of the " + std::to_string(layers), path,
                 "save the segmentation again");
    s.value = static_cast<Label>(value);
    s.layer = static_cast<int>(layer);
    const std::vector<double> colour = numbers(get("Color"), key + "Color", path);
    if (colour.size() == 3) {
      std::array<std::uint8_t, 3> rgb{};
      for (int c = 0; c < 3; ++c)
        rgb[c] = static_cast<std::uint8_t>(std::lround(255 * std::clamp(colour[c], 0.0, 1.0)));
      s.label.colour = rgb;
    }
    if (s.value == 0) continue;
    own_numbers = values.insert(s.value).second && own_numbers;
    found.segments.push_back(std::move(s));
  }
  if (found.segments.empty()) return found;
  for (std::size_t i = 0; i < found.segments.size(); ++i)
    found.segments[i].label.number = own_numbers ? found.segments[i].value : static_cast<Label>(i + 1);
  if (!own_numbers)
    found.warnings.push_back(
        warning_at(WarningCode::renumbered, path,
                   "segments of different layers have the same label value; they are numbered in their order"));

  const std::vector<double> offset =
      numbers(header.get("=Segmentation_ReferenceImageExtentOffset"), "Segmentation_ReferenceImageExtentOffset", path);
  const std::array<double, 3> first =
      offset.size() == 3 ? std::array<double, 3>{offset[0], offset[1], offset[2]} : std::array<double, 3>{0, 0, 0};
  std::array<double, 6> extent{};
  const bool known = reference_extent(header, extent, path);
  const bool shifted = first[0] != 0 || first[1] != 0 || first[2] != 0;
  for (int d = 0; d < 3; ++d) {
    found.goes_on_low[d] = known ? first[d] > extent[2 * d] : first[d] > 0;
    // Without the reference geometry a shifted file is cropped; where it ends is not known to be the image's end.
    found.goes_on_high[d] = known ? first[d] + size[d] - 1 < extent[2 * d + 1] : shifted;
  }
  return found;
}

}  // namespace stackmesh
