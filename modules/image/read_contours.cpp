#include "image/read_contours.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>
#include <string_view>

#include "base/error.h"
#include "base/text.h"
#include "base/warning.h"
#include "image/file_names.h"

namespace stackmesh {
namespace {

constexpr const char* form = "expected 'S <sections>', then per section 'v <vertices> z <height>' and polygons in { }";

struct Token {
  std::string_view text;
  std::size_t line = 0;
  bool end() const { return text.empty(); }
};

/// Words, with every brace a word of its own.
class Tokens {
 public:
  explicit Tokens(std::string_view text) : text_(text) {
    if (text_.substr(0, 3) == "\xEF\xBB\xBF") at_ = 3;
  }
  Token next() {
    while (at_ < text_.size() && is_space(text_[at_])) {
      if (text_[at_] == '\n') ++line_;
      ++at_;
    }
    const std::size_t begin = at_;
    if (at_ < text_.size() && is_brace(text_[at_])) ++at_;
    else
      while (at_ < text_.size() && !is_space(text_[at_]) && !is_brace(text_[at_])) ++at_;
    return {text_.substr(begin, at_ - begin), line_};
  }
  Token peek() {
    const std::size_t at = at_, line = line_;
    const Token token = next();
    at_ = at;
    line_ = line;
    return token;
  }

 private:
  static bool is_space(char c) { return c == ' ' || c == '\n' || c == '\r' || c == '\t' || c == '\f' || c == '\v'; }
  static bool is_brace(char c) { return c == '{' || c == '}'; }
  std::string_view text_;
  std::size_t at_ = 0, line_ = 1;
};

std::string format(double value) {
  std::ostringstream text;
  text.precision(12);
  text << value;
  return text.str();
}

class Parser {
 public:
  Parser(const std::string& path, std::string_view text) : path_(path), tokens_(text) {}

  void run(LabelContours& file) {
    keyword("s");
    const std::int64_t announced = count("sections");
    while (!tokens_.peek().end()) read_section(file);
    if (static_cast<std::int64_t>(file.sections.size()) < announced)
      fail_input("the file is truncated: " + std::to_string(file.sections.size()) + " sections where its header says " +
                     std::to_string(announced),
                 path_, "write the file again");
    if (static_cast<std::int64_t>(file.sections.size()) > announced)
      file.warnings.push_back(warning_at(WarningCode::header, path_,
                                         "holds " + std::to_string(file.sections.size()) +
                                             " sections where its header says " + std::to_string(announced) +
                                             "; all are read"));
    if (repeats_ > 0)
      file.warnings.push_back(warning_at(WarningCode::repeated, path_,
                                         std::to_string(repeats_) +
                                             (repeats_ == 1 ? " repeated point" : " repeated points") + " removed (" +
                                             repeats_where_ + (repeat_sections_ > 8 ? ", ..." : "") + ")"));
    if (empty_ > 0)
      file.warnings.push_back(
          warning_at(WarningCode::left_out, path_, std::to_string(empty_) + " contours without points left out"));
  }

 private:
  [[noreturn]] void fail(const Token& token, const std::string& expected) const {
    if (token.end())
      fail_input("the file is truncated: " + expected + " is missing at its end",
                 path_ + ", line " + std::to_string(token.line), "write the file again");
    fail_input("'" + std::string(token.text.substr(0, 40)) + "' where " + expected + " belongs",
               path_ + ", line " + std::to_string(token.line), form);
  }

  void keyword(const char* word) {
    const Token token = tokens_.next();
    if (lower_case(std::string(token.text)) != word) fail(token, std::string("'") + word + "'");
  }

  std::int64_t count(const char* what) {
    const Token token = tokens_.next();
    std::int64_t value = -1;
    const auto [end, error] = std::from_chars(token.text.data(), token.text.data() + token.text.size(), value);
    if (token.end() || error != std::errc() || end != token.text.data() + token.text.size() || value < 0)
      fail(token, std::string("the number of ") + what);
    return value;
  }

  double number(const Token& token, const char* what) const {
    double value = 0;
    std::string_view text = token.text;
    if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
      fail(token, std::string("a finite ") + what);
    if (std::abs(value) > 1e12)
      fail_input("'" + std::string(text.substr(0, 40)) + "' is farther away than 1e12 mm",
                 path_ + ", line " + std::to_string(token.line), "give coordinates in mm");
    return value;
  }

  void read_section(LabelContours& file) {
    keyword("v");
    const std::int64_t announced = count("vertices");
    keyword("z");
    ContourSection section;
    section.z_mm = number(tokens_.next(), "height");
    const std::string where =
        "section " + std::to_string(file.sections.size() + 1) + " (z " + format(section.z_mm) + " mm)";
    std::int64_t vertices = 0;
    std::size_t removed = 0;
    for (std::size_t contour = 1; tokens_.peek().text == "{"; ++contour) {
      ContourPolygon polygon = read_polygon(vertices);
      if (polygon.points.empty()) {
        ++empty_;
        continue;
      }
      removed += clean(polygon);
      if (std::set<std::array<double, 2>>(polygon.points.begin(), polygon.points.end()).size() < 3)
        fail_input("a contour needs three different points",
                   path_ + ", " + where + ", contour " + std::to_string(contour), "remove or redraw it");
      section.polygons.push_back(std::move(polygon));
    }
    if (vertices < announced && tokens_.peek().end())
      fail_input("the file is truncated: " + std::to_string(vertices) + " vertices where " + std::to_string(announced) +
                     " are announced",
                 path_ + ", " + where, "write the file again");
    if (vertices != announced)
      file.warnings.push_back({WarningCode::header, path_ + ", " + where,
                               path_ + ", " + where + ": " + std::to_string(vertices) + " vertices where " +
                                   std::to_string(announced) + " are announced; all are read"});
    if (removed > 0) {
      repeats_ += removed;
      if (++repeat_sections_ <= 8)
        repeats_where_ += (repeats_where_.empty() ? "" : ", ") + where + ": " + std::to_string(removed);
    }
    file.sections.push_back(std::move(section));
  }

  ContourPolygon read_polygon(std::int64_t& vertices) {
    tokens_.next();  // the brace
    ContourPolygon polygon;
    while (true) {
      const Token x = tokens_.next();
      if (x.text == "}") return polygon;
      const double px = number(x, "coordinate or '}'");
      const Token y = tokens_.next();
      if (!y.end() && y.line != x.line)
        fail_input("a point needs x and y", path_ + ", line " + std::to_string(x.line), "write one 'x y' a line");
      polygon.points.push_back({px, number(y, "coordinate")});
      ++vertices;
    }
  }

  /// Removes points that repeat the one before (cyclically). @return how many
  static std::size_t clean(ContourPolygon& polygon) {
    auto& p = polygon.points;
    const std::size_t before = p.size();
    p.erase(std::unique(p.begin(), p.end()), p.end());
    while (p.size() > 1 && p.back() == p.front()) p.pop_back();
    return before - p.size();
  }

  const std::string& path_;
  Tokens tokens_;
  std::size_t repeats_ = 0, repeat_sections_ = 0, empty_ = 0;
  std::string repeats_where_;
};

void sort_sections(LabelContours& file) {
  std::vector<std::size_t> order(file.sections.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return file.sections[a].z_mm < file.sections[b].z_mm; });
  for (std::size_t i = 1; i < order.size(); ++i)
    if (file.sections[order[i]].z_mm - file.sections[order[i - 1]].z_mm <= 1e-9)
      fail_input("two sections have the same height " + format(file.sections[order[i]].z_mm) + " mm",
                 file.path + ", sections " + std::to_string(std::min(order[i - 1], order[i]) + 1) + " and " +
                     std::to_string(std::max(order[i - 1], order[i]) + 1),
                 "put the contours of one height into one section");
  std::vector<ContourSection> sorted;
  for (std::size_t i : order) sorted.push_back(std::move(file.sections[i]));
  file.sections = std::move(sorted);
}

/// Splits "LABEL=FILE"; a '=' in a folder's or an existing file's name is no separator.
void split_pair(const std::string& text, LabelContours& file) {
  file.path = text;
  const std::size_t equal = text.find('=');
  std::error_code ignored;
  if (equal == std::string::npos || text.find('/') < equal || std::filesystem::exists(text, ignored)) return;
  const std::string label = text.substr(0, equal);
  file.path = text.substr(equal + 1);
  const char* const how = "write 3=FILE.cnt or NAME=FILE.cnt";
  if (label.empty()) fail_usage("a contour file without a label before '='", "'" + text + "'", how);
  if (label.find_first_not_of("0123456789") != std::string::npos &&
      !(label[0] == '-' && label.size() > 1 && label.find_first_not_of("0123456789", 1) == std::string::npos)) {
    file.label = 0;
    file.name = label;
    return;
  }
  const auto [end, error] = std::from_chars(label.data(), label.data() + label.size(), file.label);
  (void)end;
  if (error != std::errc() || file.label < 1)
    fail_usage("label '" + label + "' is not between 1 and 2147483647", "'" + text + "'", how);
}

}  // namespace

bool is_contour_input(const std::string& path) {
  return path.size() > 4 && lower_case(path.substr(path.size() - 4)) == ".cnt";
}

LabelContours read_contour_file(const std::string& path_or_pair) {
  LabelContours file;
  split_pair(path_or_pair, file);
  std::error_code error;
  const auto status = std::filesystem::status(file.path, error);
  if (!std::filesystem::exists(status)) fail_input("the input does not exist", file.path, "check the path");
  if (std::filesystem::is_directory(status)) fail_input("this is a folder", file.path, "give a .cnt file");
  std::ifstream stream(file.path, std::ios::binary);
  if (!stream) fail_input("cannot open the file", file.path, "check that you may read it");
  const std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  Parser(file.path, text).run(file);
  sort_sections(file);
  if (std::all_of(file.sections.begin(), file.sections.end(),
                  [](const ContourSection& s) { return s.polygons.empty(); }))
    fail_input("the file holds no contour", file.path, "give a file with at least one contour");
  return file;
}

}  // namespace stackmesh
