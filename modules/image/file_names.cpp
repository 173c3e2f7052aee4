#include "image/file_names.h"

#include <algorithm>
#include <charconv>
#include <map>

#include "base/text.h"

namespace stackmesh {
namespace {

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

const struct {
  const char* ending;
  FileFormat format;
} endings[] = {{".nii.gz", FileFormat::nifti}, {".nii", FileFormat::nifti},     {".nrrd", FileFormat::nrrd},
               {".nhdr", FileFormat::nrrd},    {".mha", FileFormat::metaimage}, {".mhd", FileFormat::metaimage},
               {".gipl.gz", FileFormat::gipl}, {".gipl", FileFormat::gipl},     {".png", FileFormat::png},
               {".tiff", FileFormat::tiff},    {".tif", FileFormat::tiff}};

}  // namespace

std::string file_name_of(const std::string& path) {
  return path.substr(path.find_last_of('/') + 1);
}

FileFormat format_of(const std::string& path) {
  const std::string name = lower_case(file_name_of(path));
  for (const auto& e : endings)
    if (name != e.ending && ends_with(name, e.ending)) return e.format;
  return FileFormat::unknown;
}

std::string stem_of(const std::string& path) {
  const std::string name = file_name_of(path), lower = lower_case(name);
  for (const auto& e : endings)
    if (lower != e.ending && ends_with(lower, e.ending))
      return name.substr(0, name.size() - std::string(e.ending).size());
  return name.substr(0, name.find_last_of('.'));
}

bool natural_less(const std::string& a, const std::string& b) {
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (!is_digit(a[i]) || !is_digit(b[j])) {
      if (a[i] != b[j]) return static_cast<unsigned char>(a[i]) < static_cast<unsigned char>(b[j]);
      ++i;
      ++j;
      continue;
    }
    while (i < a.size() && a[i] == '0') ++i;
    while (j < b.size() && b[j] == '0') ++j;
    const std::size_t p = i, q = j;
    while (i < a.size() && is_digit(a[i])) ++i;
    while (j < b.size() && is_digit(b[j])) ++j;
    if (i - p != j - q) return i - p < j - q;
    const int order = a.compare(p, i - p, b, q, j - q);
    if (order != 0) return order < 0;
  }
  if ((i < a.size()) != (j < b.size())) return j < b.size();
  return a < b;  // "01" and "1": any fixed order
}

namespace {

/// Calls visit(text before, sign or 0, begin, end) for every run of digits; the text has '#' for earlier numbers and no
/// sign.
template <class Visit>
void each_number(const std::string& name, Visit visit) {
  std::string before;
  for (std::size_t i = 0; i < name.size();) {
    if (!is_digit(name[i])) {
      before += name[i++];
      continue;
    }
    const std::size_t begin = i;
    while (i < name.size() && is_digit(name[i])) ++i;
    const char sign = !before.empty() && (before.back() == '-' || before.back() == '+') ? before.back() : '\0';
    if (sign != 0) before.pop_back();
    visit(before, sign, begin, i);
    before += '#';
  }
}

int compare_numbers(const std::string& a, const std::string& b) {
  const std::size_t i = std::min(a.find_first_not_of('0'), a.size()), j = std::min(b.find_first_not_of('0'), b.size());
  if (a.size() - i != b.size() - j) return a.size() - i < b.size() - j ? -1 : 1;
  return a.compare(i, std::string::npos, b, j, std::string::npos);
}

}  // namespace

NameOrder::NameOrder(const std::vector<std::string>& names) {
  std::map<std::string, std::set<char>> signs;
  for (const std::string& name : names)
    each_number(name,
                [&](const std::string& before, char sign, std::size_t, std::size_t) { signs[before].insert(sign); });
  for (const auto& [before, found] : signs)
    if (found.size() > 1) signed_after_.insert(before);
}

std::vector<NameOrder::Piece> NameOrder::pieces_of(const std::string& name) const {
  std::vector<Piece> pieces;
  std::size_t at = 0;
  each_number(name, [&](const std::string& before, char sign, std::size_t begin, std::size_t end) {
    if (begin < at) return;  // the digits behind the point of a signed number
    Piece number;
    number.is_number = true;
    number.is_signed = signed_after_.count(before) > 0 && end - begin <= 15;
    std::size_t from = begin;
    if (number.is_signed) {
      if (sign != 0) --from;
      std::size_t stop = end;
      if (stop + 1 < name.size() && name[stop] == '.' && is_digit(name[stop + 1])) {
        ++stop;
        while (stop < name.size() && is_digit(name[stop])) ++stop;
      }
      std::from_chars(name.data() + begin, name.data() + stop, number.value);
      if (sign == '-') number.value = -number.value;
      end = stop;
    }
    number.text = name.substr(begin, end - begin);
    if (from > at) pieces.push_back({name.substr(at, from - at)});
    pieces.push_back(std::move(number));
    at = end;
  });
  if (at < name.size()) pieces.push_back({name.substr(at)});
  return pieces;
}

bool NameOrder::less(const std::string& a, const std::string& b) const {
  if (signed_after_.empty()) return natural_less(a, b);
  const std::vector<Piece> p = pieces_of(a), q = pieces_of(b);
  for (std::size_t i = 0; i < p.size() && i < q.size(); ++i) {
    if (p[i].is_signed && q[i].is_signed) {
      if (p[i].value != q[i].value) return p[i].value < q[i].value;
    } else if (p[i].is_number && q[i].is_number) {
      if (const int order = compare_numbers(p[i].text, q[i].text); order != 0) return order < 0;
    } else if (p[i].text != q[i].text) {
      return natural_less(p[i].text, q[i].text);
    }
  }
  return p.size() != q.size() ? p.size() < q.size() : natural_less(a, b);
}

bool NameOrder::last_number(const std::string& name, std::string& before, long long& number) const {
  bool found = false;
  each_number(name, [&](const std::string& text, char sign, std::size_t begin, std::size_t end) {
    found = end - begin <= 15;
    if (!found) return;
    const bool is_signed = signed_after_.count(text) > 0;
    before = name.substr(0, begin - (is_signed && sign != 0 ? 1 : 0));
    number = std::stoll(name.substr(begin, end - begin));
    if (is_signed && sign == '-') number = -number;
  });
  return found;
}

}  // namespace stackmesh
