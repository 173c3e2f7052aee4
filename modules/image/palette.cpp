#include "image/palette.h"

#include <algorithm>
#include <numeric>
#include <sstream>

#include "base/error.h"
#include "base/warning.h"

namespace stackmesh {
namespace {

constexpr std::size_t kUsualLabels = 1000;  // above: looked at more closely
constexpr std::size_t kMostValues = 65536;  // of a voxel's two bytes, with the background
// of neighbours in a parcel atlas are alike; of an intensity image, a few percent
constexpr double kCoherent_rel = 0.3;
const char* const mend = "give the label volume (segmentation), whole numbers from 0";

std::string number(double value) {
  std::ostringstream text;
  text.precision(9);
  text << value;
  return text.str();
}

std::string at(const std::pair<std::string, std::string>& where) {
  return where.first + ", " + where.second;
}

}  // namespace

std::int32_t Palette::add(std::int64_t value, std::size_t offset, const Where& where) {
  const auto [entry, fresh] = index_.emplace(value, static_cast<std::int32_t>(values_.size()));
  if (fresh) {
    if (values_.size() >= kMostValues)
      fail_input("looks like an intensity image given by mistake: more than " + std::to_string(kMostValues - 1) +
                     " distinct values",
                 where(offset).first, mend);
    values_.push_back(value);
  }
  return entry->second;
}

namespace {

/// The share of neighbours along an axis that are of one label, where both are labelled.
double coherence(const LabelVolume& volume, int axis) {
  const std::array<std::size_t, 3> step = {1, static_cast<std::size_t>(volume.size[0]),
                                           static_cast<std::size_t>(volume.size[0]) * volume.size[1]};
  std::size_t pairs = 0, same = 0;
  for (std::size_t i = 0; i + step[axis] < volume.voxels.size(); ++i) {
    const std::uint16_t a = volume.voxels[i], b = volume.voxels[i + step[axis]];
    if (a == 0 || b == 0 || static_cast<int>(i / step[axis] % volume.size[axis]) + 1 == volume.size[axis]) continue;
    ++pairs;
    same += a == b;
  }
  return pairs == 0 ? 0 : static_cast<double>(same) / static_cast<double>(pairs);
}

}  // namespace

void Palette::finish(LabelVolume& volume, const std::string& path) const {
  if (values_.size() > kUsualLabels + 1 && std::min(coherence(volume, 0), coherence(volume, 1)) < kCoherent_rel)
    fail_input("looks like an intensity image given by mistake: more than " + std::to_string(kUsualLabels) +
                   " distinct values, and neighbouring voxels differ",
               path, mend);
  std::vector<std::size_t> order(values_.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin() + 1, order.end(), [&](auto a, auto b) { return values_[a] < values_[b]; });
  std::vector<std::uint16_t> target(order.size());
  volume.labels.clear();
  for (std::size_t i = 0; i < order.size(); ++i) {
    target[order[i]] = static_cast<std::uint16_t>(i);
    volume.labels.push_back({static_cast<Label>(values_[order[i]]), ""});
  }
  if (!std::is_sorted(target.begin(), target.end()))
    for (std::uint16_t& v : volume.voxels) v = target[v];
}

void Palette::fail_negative(double value, const std::pair<std::string, std::string>& where) {
  fail_input("looks like an intensity image given by mistake: negative value " + number(value), at(where), mend);
}

void Palette::fail_fraction(double value, const std::pair<std::string, std::string>& where) {
  fail_input("looks like an intensity image or a probability map given by mistake: value " + number(value) +
                 " is not a whole number",
             at(where), mend);
}

void Palette::fail_large(double value, const std::pair<std::string, std::string>& where) {
  fail_input("label number " + number(value) + " is too large", at(where), "number labels below 2147483648");
}

void warn_of_rounded_labels(double worst, const std::string& path, std::vector<Warning>& warnings) {
  if (worst > 0)
    warnings.push_back(warning_at(WarningCode::values_changed, path,
                                  "its labels are stored with a slope and an intercept; values up to " + number(worst) +
                                      " off whole numbers were rounded"));
}

}  // namespace stackmesh
