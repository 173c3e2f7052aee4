#include "image/data_files.h"

#include <cmath>
#include <filesystem>

#include "base/error.h"

namespace stackmesh {
namespace {

namespace fs = std::filesystem;

/// "%04d" of a pattern: where it is, and its width.
struct Place {
  std::size_t begin = 0, end = 0;
  std::size_t width = 0;
  bool zeros = false;
};

Place place_in(const std::string& pattern, const std::string& header) {
  const auto refuse = [&] {
    fail_input("the pattern of its data files '" + pattern + "' has no single %d", header, "write it as NAME%03d.raw");
  };
  Place p;
  p.begin = pattern.find('%');
  if (p.begin == std::string::npos || pattern.find('%', p.begin + 1) != std::string::npos) refuse();
  p.end = p.begin + 1;
  if (p.end < pattern.size() && pattern[p.end] == '0') p.zeros = true, ++p.end;
  for (; p.end < pattern.size() && pattern[p.end] >= '0' && pattern[p.end] <= '9'; ++p.end)
    p.width = 10 * p.width + static_cast<std::size_t>(pattern[p.end] - '0');
  if (p.end < pattern.size() && pattern[p.end] == '.') {  // "%.3d": at least three digits
    p.zeros = true;
    for (++p.end; p.end < pattern.size() && pattern[p.end] >= '0' && pattern[p.end] <= '9'; ++p.end)
      p.width = 10 * p.width + static_cast<std::size_t>(pattern[p.end] - '0');
  }
  if (p.end >= pattern.size() || (pattern[p.end] != 'd' && pattern[p.end] != 'i' && pattern[p.end] != 'u') ||
      p.width > 100)
    refuse();
  ++p.end;
  return p;
}

}  // namespace

DataPart DataFiles::part(const std::string& name) const {
  const fs::path folder = fs::path(header_).parent_path(), named(name);
  const fs::path full = named.is_absolute() ? named : folder / named;
  if (!allow_outside_) {
    std::error_code ignored;
    const fs::path base = fs::absolute(folder.empty() ? fs::path(".") : folder, ignored).lexically_normal();
    const fs::path inside = fs::absolute(full, ignored).lexically_normal().lexically_relative(base / "");
    if (inside.empty() || *inside.begin() == ".." || inside.is_absolute())
      fail_input(
          "its data file '" + name + "' lies outside of the header's folder", header_,
          "put it beside the header and name it without its folder, or say --allow-outside if you trust the file");
  }
  DataPart part;
  part.path = full.string();
  std::error_code error;
  if (!fs::exists(full, error))
    fail_input("its data file '" + name + "' is missing", header_, "put it beside the header");
  if (fs::is_regular_file(full, error) && fs::file_size(full, error) == 0)
    fail_input("its data file '" + name + "' is missing or empty", header_, "put it beside the header");
  return part;
}

std::vector<DataPart> DataFiles::numbered(const std::string& pattern, double first, double last, double step) const {
  const Place place = place_in(pattern, header_);
  const auto whole = [](double v) { return std::abs(v) < 1e9 && v == std::floor(v); };
  if (!whole(first) || !whole(last) || !whole(step) || step == 0 || (last - first) / step < 0 ||
      (last - first) / step > 1e6)
    fail_input("the numbers of its data files are no range", header_, "write them as NAME%03d.raw FIRST LAST STEP");
  std::vector<DataPart> parts;
  for (double n = first; step > 0 ? n <= last : n >= last; n += step) {
    std::string digits = std::to_string(static_cast<long long>(std::abs(n)));
    const std::string sign = n < 0 ? "-" : "";
    const std::size_t length = digits.size() + sign.size();
    if (place.zeros && length < place.width) digits = std::string(place.width - length, '0') + digits;
    digits = sign + digits;
    if (digits.size() < place.width) digits = std::string(place.width - digits.size(), ' ') + digits;
    parts.push_back(part(pattern.substr(0, place.begin) + digits + pattern.substr(place.end)));
  }
  return parts;
}

}  // namespace stackmesh
