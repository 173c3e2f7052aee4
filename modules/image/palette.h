#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <type_traits>
#include <unordered_map>
#include <vector>

#include "base/warning.h"
#include "model/label_volume.h"

namespace stackmesh {

/// Turns raw pixel values into palette indices, and refuses what is no label image.
class Palette {
 public:
  /// Says where the value at an offset is, for an error: {file, "voxel (1, 2, 3)"}.
  using Where = std::function<std::pair<std::string, std::string>(std::size_t)>;

  Palette() : narrow_(65536, unseen) { narrow_[0] = 0; }

  /// Converts `count` values. The output may overlay the input where out[i] lies at or before in[i] in
  /// memory, or beyond it only over values already read (8-bit values in the second half of the output).
  template <class T>
  void convert(const T* in, std::uint16_t* out, std::size_t count, const Where& where) {
    if constexpr (sizeof(T) <= 2) {
      for (std::size_t i = 0; i < count; ++i) {
        const T value = in[i];
        const auto slot = static_cast<std::make_unsigned_t<T>>(value);
        if constexpr (std::is_signed_v<T>)
          if (value < 0) fail_negative(value, where(i));
        std::int32_t index = narrow_[slot];
        if (index == unseen) narrow_[slot] = index = add(value, i, where);
        out[i] = static_cast<std::uint16_t>(index);
      }
    } else {
      T last = 0;
      std::uint16_t last_index = 0;
      for (std::size_t i = 0; i < count; ++i) {
        const T value = in[i];
        if (!(value == last)) {
          if constexpr (std::is_floating_point_v<T>) {
            if (!std::isfinite(value) || value != std::nearbyint(value)) fail_fraction(value, where(i));
            if (value < 0) fail_negative(value, where(i));
            if (value > 2147483647.0) fail_large(value, where(i));
          } else {
            if constexpr (std::is_signed_v<T>)
              if (value < 0) fail_negative(static_cast<double>(value), where(i));
            if (value > static_cast<T>(2147483647)) fail_large(static_cast<double>(value), where(i));
          }
          last = value;
          last_index = static_cast<std::uint16_t>(add(static_cast<std::int64_t>(value), i, where));
        }
        out[i] = last_index;
      }
    }
  }

  /// Sorts the palette, renumbers the voxels and fills volume.labels. More than a thousand labels must look like
  /// parcels: then neighbouring voxels are mostly of one label, which those of an intensity image are not.
  /// @throws Error(input) naming `path` where they do not
  void finish(LabelVolume& volume, const std::string& path) const;

 private:
  static constexpr std::int32_t unseen = -1;
  std::int32_t add(std::int64_t value, std::size_t offset, const Where& where);
  [[noreturn]] static void fail_negative(double value, const std::pair<std::string, std::string>& where);
  [[noreturn]] static void fail_fraction(double value, const std::pair<std::string, std::string>& where);
  [[noreturn]] static void fail_large(double value, const std::pair<std::string, std::string>& where);

  std::vector<std::int32_t> narrow_;  // index by 8- or 16-bit value
  std::unordered_map<std::int64_t, std::int32_t> index_ = {{0, 0}};
  std::vector<std::int64_t> values_ = {0};  // in order of appearance
};

/// Labels that are stored with a slope: what it makes is near whole numbers, but not whole.
class LabelRounding {
 public:
  LabelRounding(double slope, double intercept)
      : slope_(slope), intercept_(intercept), near_(std::min(0.05, std::max(1e-3, 0.51 * std::abs(slope)))) {}
  /// The value that a stored one stands for, whole where it is near a whole number.
  double round(double stored) {
    const double value = slope_ * stored + intercept_, whole = std::nearbyint(value), off = std::abs(value - whole);
    if (!(off <= near_)) return value;
    worst_ = std::max(worst_, off);
    return whole + 0.0;  // -0 becomes 0
  }
  /// The largest distance from a whole number that was rounded away.
  double worst() const { return worst_; }

 private:
  double slope_, intercept_, near_, worst_ = 0;
};

/// Says that values were rounded, if any was.
void warn_of_rounded_labels(double worst, const std::string& path, std::vector<Warning>& warnings);

}  // namespace stackmesh
