#include "image/palette.h"

#include <algorithm>
#include <numeric>
#include <sstream>

#include "base/error.h"

namespace stackmesh {
namespace {

constexpr std::size_t max_labels = 1000;
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
    if (values_.size() > max_labels)
      fail_input("looks like an intensity image given by mistake: more than " + std::to_string(max_labels) +
                     " distinct values",
                 where(offset).first, mend);
    values_.push_back(value);
  }
  return entry->second;
}

void Palette::finish(LabelVolume& volume) const {
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
  fail_input("looks like an intensity image given by mistake: negative value " + number(value), at(where),
             mend);
}

void Palette::fail_fraction(double value, const std::pair<std::string, std::string>& where) {
  fail_input("looks like an intensity image or a probability map given by mistake: value " + number(value) +
                 " is not a whole number",
             at(where), mend);
}

void Palette::fail_large(double value, const std::pair<std::string, std::string>& where) {
  fail_input("label number " + number(value) + " is too large", at(where), "number labels below 2147483648");
}

}  // namespace stackmesh
