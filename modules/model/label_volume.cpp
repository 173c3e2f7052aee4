#include "model/label_volume.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <sstream>

#include "base/error.h"

namespace stackmesh {
namespace {

constexpr double kLeastVoxel = 1e-12, kLargestVoxel = 1e12, kFarthestVoxels = 1e14;

std::string short_number(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

}  // namespace

void check_grid(const std::array<double, 3>& spacing_mm, Vec3 origin_mm, const std::string& name) {
  for (int d = 0; d < 3; ++d)
    if (!(spacing_mm[d] >= kLeastVoxel && spacing_mm[d] <= kLargestVoxel))
      fail_input("voxels are " + short_number(spacing_mm[d]) + " mm long along " + std::string(1, "xyz"[d]), name,
                 "give the size of a voxel in mm, between 1e-12 and 1e12");
  const double far = std::max({std::abs(origin_mm.x), std::abs(origin_mm.y), std::abs(origin_mm.z)}),
               least = *std::min_element(spacing_mm.begin(), spacing_mm.end());
  if (!(far <= kFarthestVoxels * least))
    fail_input("the first voxel lies " + short_number(far) + " mm away from the origin, where voxels of " +
                   short_number(least) + " mm cannot be told apart",
               name, "move the volume nearer to the origin");
}

void check_label_volume(const LabelVolume& v, const std::string& name) {
  const auto refuse = [&](const std::string& what, const std::string& mend) {
    fail_input(what, name.empty() ? "the label volume" : name, mend);
  };
  std::size_t voxels = 1;
  for (int d = 0; d < 3; ++d) {
    if (v.size[d] <= 0)
      refuse("the volume has no voxels along " + std::string(1, "xyz"[d]),
             "give an array of three dimensions that are all above 0");
    if (!(v.spacing_mm[d] > 0 && std::isfinite(v.spacing_mm[d])))
      refuse("the spacing is not above 0 along " + std::string(1, "xyz"[d]), "give the size of a voxel in mm");
    voxels *= static_cast<std::size_t>(v.size[d]);
    for (int e = 0; e <= d; ++e)
      if (!(std::abs(dot(v.axes[d], v.axes[e]) - (d == e ? 1 : 0)) < 1e-4))
        refuse("the axes are no orthonormal ones", "give unit vectors at right angles");
  }
  if (!std::isfinite(v.origin_mm.x + v.origin_mm.y + v.origin_mm.z))
    refuse("the origin is not finite", "give the centre of the first voxel in mm");
  check_grid(v.spacing_mm, v.origin_mm, name.empty() ? "the label volume" : name);
  if (v.voxels.size() != voxels)
    refuse(std::to_string(v.voxels.size()) + " voxels for a size of " + std::to_string(voxels),
           "give as many as the size says");
  if (v.labels.empty() || v.labels[0].number != 0)
    refuse("the first label is not the background", "give labels[0] the number 0");
  for (std::size_t k = 1; k < v.labels.size(); ++k)
    if (v.labels[k].number <= v.labels[k - 1].number)
      refuse("label " + std::to_string(v.labels[k].number) + " does not follow the one before it",
             "sort the labels by number, each once");
  bool any = false;
  for (const std::uint16_t x : v.voxels) {
    if (x >= v.labels.size())
      refuse("a voxel has the label index " + std::to_string(x) + " of " + std::to_string(v.labels.size()),
             "voxels hold indices into labels");
    any = any || x != 0;
  }
  if (!any) refuse("no label: every voxel is background (0)", "give a segmentation");
}

LabelVolume volume_of_labels(const std::vector<Label>& numbers, const std::array<int, 3>& size,
                             const std::array<double, 3>& spacing_mm) {
  LabelVolume v;
  v.size = size;
  v.spacing_mm = spacing_mm;
  std::vector<Label> sorted = numbers;
  std::sort(sorted.begin(), sorted.end());
  sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
  if (!sorted.empty() && sorted[0] < 0)
    fail_input("a label is negative", "label " + std::to_string(sorted[0]),
               "number labels from 1; 0 is the background");
  v.labels.push_back({0, ""});
  for (const Label l : sorted)
    if (l > 0) v.labels.push_back({l, ""});
  if (v.labels.size() > 65536)
    fail_input(std::to_string(v.labels.size() - 1) + " different labels", "the label volume",
               "give a segmentation, not intensities");
  v.voxels.reserve(numbers.size());
  for (const Label l : numbers)
    v.voxels.push_back(
        static_cast<std::uint16_t>(std::lower_bound(v.labels.begin(), v.labels.end(), l,
                                                    [](const LabelInfo& a, Label b) { return a.number < b; }) -
                                   v.labels.begin()));
  check_label_volume(v, "");
  return v;
}

LabelVolume without_voxels(const LabelVolume& volume) {
  LabelVolume out;
  out.size = volume.size;
  out.spacing_mm = volume.spacing_mm;
  out.origin_mm = volume.origin_mm;
  out.axes = volume.axes;
  out.anatomical = volume.anatomical;
  out.goes_on_low = volume.goes_on_low;
  out.goes_on_high = volume.goes_on_high;
  out.labels = volume.labels;
  out.kind = volume.kind;
  out.warnings = volume.warnings;
  return out;
}

std::vector<std::size_t> count_voxels(const LabelVolume& volume) {
  std::vector<std::size_t> counts(volume.labels.size(), 0);
  for (std::uint16_t v : volume.voxels) ++counts[v];
  return counts;
}

LabelVolume select_labels(LabelVolume volume, const std::vector<std::size_t>& keep, bool merge) {
  std::vector<std::uint16_t> target(volume.labels.size(), 0);
  std::vector<LabelInfo> labels = {volume.labels[0]};
  for (std::size_t k : keep) {
    if (!merge || labels.size() == 1) labels.push_back(volume.labels[k]);
    target[k] = static_cast<std::uint16_t>(labels.size() - 1);
  }
  volume.labels = std::move(labels);
  for (std::uint16_t& v : volume.voxels) v = target[v];
  return volume;
}

}  // namespace stackmesh
