#include "image/masks.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/error.h"
#include "base/warning.h"
#include "image/file_names.h"
#include "image/volume_file.h"

namespace stackmesh {
namespace {

/// What differs between two grids, "" when they agree.
std::string difference(const LabelVolume& a, const LabelVolume& b) {
  if (a.size != b.size) return "size";
  double pixel = a.spacing_mm[0];
  for (int d = 0; d < 3; ++d) {
    pixel = std::min(pixel, a.spacing_mm[d]);
    if (std::abs(a.spacing_mm[d] - b.spacing_mm[d]) > 1e-4 * a.spacing_mm[d]) return "voxel size";
    if (norm(a.axes[d] - b.axes[d]) > 1e-4) return "direction";
  }
  return norm(a.origin_mm - b.origin_mm) > 1e-2 * pixel ? "origin" : "";
}

std::string quoted(const LabelInfo& label) {
  return "'" + label.name + "'";
}

}  // namespace

LabelVolume read_masks(const std::vector<std::string>& files, bool allow_outside) {
  if (files.size() > 1000)
    fail_input(std::to_string(files.size()) + " masks are too many", files[0], "give at most 1000 masks");
  LabelVolume all;
  std::vector<LabelInfo> labels = {{0, ""}};
  std::map<std::pair<std::size_t, std::size_t>, std::size_t> overlap;  // (winner, loser) -> voxels
  std::vector<std::size_t> own(files.size() + 1, 0);
  std::vector<Warning> warnings;
  for (std::size_t k = 1; k <= files.size(); ++k) {
    const std::string& file = files[k - 1];
    LabelVolume mask = read_volume_file(file, format_of(file), "", allow_outside);
    labels.push_back({static_cast<Label>(k), stem_of(file)});
    for (std::size_t j = 1; j < k; ++j)
      if (labels[j].name == labels[k].name)
        fail_input("two masks have the name '" + labels[k].name + "'", files[j - 1] + " and " + file,
                   "rename or remove one of them");
    warnings.insert(warnings.end(), mask.warnings.begin(), mask.warnings.end());
    if (mask.labels.size() > 2)
      warnings.push_back(warning_at(WarningCode::values_changed, file,
                                    "holds " + std::to_string(mask.labels.size() - 1) +
                                        " different labels; all its voxels above 0 count as " + quoted(labels[k])));
    const bool first = k == 1;
    if (!first) {
      const std::string what = difference(all, mask);
      if (!what.empty())
        fail_input("the grid of the masks differs: " + what, file + " against " + files[0],
                   "resample the masks to one grid with nearest neighbour");
    }
    std::vector<std::size_t> lost(k, 0);
    if (first) {
      for (std::uint16_t& v : mask.voxels)
        if (v != 0) {
          v = 1;
          ++own[1];
        }
      all = std::move(mask);
    } else {
      for (std::size_t i = 0; i < all.voxels.size(); ++i) {
        if (mask.voxels[i] == 0) continue;
        if (all.voxels[i] == 0) {
          all.voxels[i] = static_cast<std::uint16_t>(k);
          ++own[k];
        } else {
          ++lost[all.voxels[i]];
        }
      }
      for (std::size_t j = 1; j < k; ++j)
        if (lost[j] > 0) overlap[{j, k}] = lost[j];
    }
  }
  for (const auto& [pair, voxels] : overlap)
    warnings.push_back({WarningCode::overlap, quoted(labels[pair.second]),
                        "masks " + quoted(labels[pair.first]) + " and " + quoted(labels[pair.second]) + " overlap in " +
                            std::to_string(voxels) + (voxels == 1 ? " voxel" : " voxels") + ", which went to " +
                            quoted(labels[pair.first])});

  // Structures without a voxel keep their number for themselves but leave the palette.
  std::vector<std::uint16_t> target(labels.size(), 0);
  std::vector<LabelInfo> kept = {labels[0]};
  for (std::size_t k = 1; k < labels.size(); ++k) {
    if (own[k] == 0) {
      warnings.push_back({WarningCode::left_out, quoted(labels[k]),
                          "mask " + quoted(labels[k]) + " has no voxel of its own and is left out"});
      continue;
    }
    target[k] = static_cast<std::uint16_t>(kept.size());
    kept.push_back(labels[k]);
  }
  if (kept.size() != labels.size())
    for (std::uint16_t& v : all.voxels) v = target[v];
  all.labels = std::move(kept);
  all.warnings = std::move(warnings);
  all.kind = "masks";
  return all;
}

}  // namespace stackmesh
