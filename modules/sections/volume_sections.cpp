#include "sections/volume_sections.h"

#include <array>
#include <string>
#include <utility>

#include "base/error.h"
#include "base/warning.h"
#include "fair/fair_labels.h"
#include "sections/gap_pieces.h"
#include "sections/virtual_slices.h"

namespace stackmesh {
namespace {

constexpr double kSimplifyFaired_px = 0.05, kSimplifyCracks_px = 0.5;

VolumeSections extract_faired(const LabelVolume& volume, int axis, int virtual_per_gap, const SectionOptions& options,
                              Monitor& progress) {
  ContourOptions contours = options.contours;
  // the spacing of a dense volume would choose anew
  contours.axis = std::array{StackAxis::x, StackAxis::y, StackAxis::z}[axis];
  contours.virtual_per_gap = virtual_per_gap;
  const bool faired = options.band_px > 0;
  contours.simplify_px = options.simplify_px.value_or(faired ? kSimplifyFaired_px : kSimplifyCracks_px);
  if (!faired) return {extract_sections(volume, contours, progress), {}, {}};
  FairOptions fairing;
  fairing.band_px = options.band_px;
  fairing.virtual_per_gap = virtual_per_gap;
  fairing.threads = contours.threads;
  fairing.surface = options.faired_surface;
  FairedLabels places = fair_labels(volume, axis, fairing, progress);
  VolumeSections out;
  out.contours = extract_sections(volume, contours, progress, &places);
  const int period = virtual_per_gap + 1;
  const std::vector<int> other = gaps_with_other_pieces(volume, axis, period, out.contours.stack, contours.threads);
  if (!other.empty()) {
    for (int gap : other)
      for (int k = gap * period + 1; k < (gap + 1) * period; ++k) places.free[k] = 0;
    out.contours = extract_sections(volume, contours, progress, &places);
    const std::string slices =
        "slices " + std::to_string(other.front() + 1) + " and " + std::to_string(other.front() + 2);
    out.warnings.push_back({WarningCode::held_to_slices, slices,
                            "between " + slices +
                                (other.size() > 1 ? " and in " + std::to_string(other.size() - 1) + " more gaps" : "") +
                                " smooth sections would join or split pieces of a label: they keep closer to the "
                                "interpolated slices there"});
  }
  out.faired = std::move(places.surface);
  return out;
}

}  // namespace

void check_slices(const LabelVolume& volume, StackAxis axis, const std::string& name) {
  const int a = stacking_axis(volume, axis);
  if (volume.size[a] < 2)
    fail_input(std::string("only one slice along the stacking axis ") + "xyz"[a], name,
               "give a stack of at least two slices, or choose another --axis");
}

VolumeSections volume_sections(const LabelVolume& volume, const SectionOptions& options, Monitor& progress) {
  const int axis = stacking_axis(volume, options.contours.axis);
  InterpolateOptions between;
  between.per_gap = options.virtual_sections;
  between.threads = options.contours.threads;
  if (virtual_slices_per_gap(volume, axis, between) == 0) return extract_faired(volume, axis, 0, options, progress);
  const InterpolatedVolume dense = add_virtual_slices(volume, axis, between);
  return extract_faired(dense.volume, axis, dense.per_gap, options, progress);
}

}  // namespace stackmesh
