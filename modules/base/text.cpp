#include "base/text.h"

#include <algorithm>
#include <numeric>

namespace stackmesh {

std::string lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return lower;
}

std::string printable(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto c = static_cast<unsigned char>(text[i]);
    const auto after = i + 1 < text.size() ? static_cast<unsigned char>(text[i + 1]) : 0;
    if (c == 0xc2 && after >= 0x80 && after < 0xa0) {
      out += ' ';
      ++i;
      // line and paragraph separators
    } else if (c == 0xe2 && after == 0x80 && i + 2 < text.size() &&
               (static_cast<unsigned char>(text[i + 2]) & 0xfe) == 0xa8) {
      out += ' ';
      i += 2;
    } else {
      // a control character outside of UTF-8
      const bool lone = c >= 0x80 && c < 0xa0 && (i == 0 || static_cast<unsigned char>(text[i - 1]) < 0x80);
      out += c < ' ' || c == 127 || lone ? ' ' : text[i];
    }
  }
  return out;
}

std::string printable_lines(std::string_view text) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    out += printable(text.substr(at, end - at));
    if (end < text.size()) out += '\n';
    at = end + 1;
  }
  return out;
}

bool ends_with(std::string_view text, std::string_view end) {
  return text.size() >= end.size() && text.substr(text.size() - end.size()) == end;
}

namespace {

std::size_t letters_apart(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t corner = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t changed = corner + (a[i] == b[j] ? 0 : 1);
      corner = row[j + 1];
      row[j + 1] = std::min({changed, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

std::string nearest_names(std::string_view name, const std::vector<std::string>& known, std::size_t most) {
  std::vector<std::pair<std::size_t, std::size_t>> order;  // letters apart, place
  for (std::size_t i = 0; i < known.size(); ++i)
    order.push_back({letters_apart(lower_case(name), lower_case(known[i])), i});
  std::sort(order.begin(), order.end());
  std::string text;
  for (std::size_t i = 0; i < std::min(most, order.size()); ++i) text += (i > 0 ? ", " : "") + known[order[i].second];
  return text;
}

}  // namespace stackmesh
