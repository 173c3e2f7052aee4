#include "meshio/read_frd.h"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <unordered_map>

#include "base/error.h"
#include "base/text.h"

namespace stackmesh {
namespace {

/// Records of fixed columns: a key of three characters, a node's number of ten, values of twelve.
class FrdReader {
 public:
  explicit FrdReader(const std::string& path) : path_(path), stream_(path, std::ios::binary) {
    if (!stream_) fail_input("the result file cannot be opened", path, "check the name and the rights");
  }

  FrdResult read() {
    bool ended = false;
    while (next()) {
      const std::string key = trimmed(line_.substr(0, 6));
      if (key == "2C") nodes();
      else if (line_.rfind(" -4", 0) == 0) field();
      else if (key == "9999") ended = true;
    }
    if (out_.numbers.empty() || !ended) fail("is cut off, or no result file of CalculiX");
    return std::move(out_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    fail_input("the result file " + what, path_ + ", line " + std::to_string(number_),
               "let CalculiX write it again, as text (*NODE FILE, *EL FILE)");
  }
  bool next() {
    ++number_;
    return static_cast<bool>(std::getline(stream_, line_));
  }
  static std::string trimmed(std::string text) {
    text.erase(0, text.find_first_not_of(' ') == std::string::npos ? text.size() : text.find_first_not_of(' '));
    while (!text.empty() && (text.back() == ' ' || text.back() == '\r')) text.pop_back();
    return text;
  }
  double value(std::size_t at) const {
    if (line_.size() < at + 12) fail("has a line that is too short");
    const std::string text = line_.substr(at, 12);
    char* end = nullptr;
    const double v = std::strtod(text.c_str(), &end);
    if (end == text.c_str()) fail("holds '" + printable(text) + "' where a number stands");
    return v;
  }
  std::int64_t node() const {
    if (line_.size() < 13) fail("has a line that is too short");
    return std::strtoll(line_.substr(3, 10).c_str(), nullptr, 10);
  }

  void nodes() {
    out_.numbers.clear();
    out_.points.clear();
    while (next() && line_.rfind(" -1", 0) == 0) {
      out_.numbers.push_back(node());
      out_.points.push_back({value(13), value(25), value(37)});
    }
    place_.clear();
    for (std::size_t i = 0; i < out_.numbers.size(); ++i) place_[out_.numbers[i]] = i;
  }

  void field() {
    const std::string name = trimmed(line_.substr(5, 8));
    std::vector<std::array<double, 6>> values(out_.numbers.size(), std::array<double, 6>{});
    while (next() && line_.rfind(" -3", 0) != 0) {
      if (line_.rfind(" -1", 0) != 0) continue;  // names of components
      const auto at = place_.find(node());
      if (at == place_.end()) fail("has a value at a node that is not there");
      const std::size_t components = std::min<std::size_t>(6, (line_.size() - 13) / 12);
      for (std::size_t c = 0; c < components; ++c) values[at->second][c] = value(13 + 12 * c);
    }
    out_.fields[name] = std::move(values);
  }

  std::string path_, line_;
  std::ifstream stream_;
  std::size_t number_ = 0;
  std::unordered_map<std::int64_t, std::size_t> place_;
  FrdResult out_;
};

}  // namespace

FrdResult read_frd(const std::string& path) {
  return FrdReader(path).read();
}

}  // namespace stackmesh
