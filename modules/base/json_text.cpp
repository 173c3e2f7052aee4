#include "base/json_text.h"

#include <sys/stat.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>

#include "base/error.h"

namespace stackmesh {
namespace {

constexpr int kDeepest = 64;

bool begins_number(char c) {
  return c == '-' || (c >= '0' && c <= '9');
}
bool is_in_number(char c) {
  return begins_number(c) || c == '+' || c == '.' || c == 'e' || c == 'E';
}

}  // namespace

std::string read_json_text(const std::string& path, const std::string& what, const std::string& mend) {
  struct stat info;
  if (::stat(path.c_str(), &info) == 0 && !S_ISREG(info.st_mode))
    fail_input(what + " is no regular file", path, "give a file");
  std::ifstream file(path, std::ios::binary);
  if (!file) fail_input(what + " cannot be read", path, mend);
  std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  int depth = 0, line = 1;
  const auto where = [&] { return path + ", line " + std::to_string(line); };
  for (std::size_t i = 0; i < text.size();) {
    const char c = text[i];
    if (c == '\n') ++line;
    if (c == '"') {
      for (++i; i < text.size() && text[i] != '"'; ++i)
        if (text[i] == '\\') ++i;
      ++i;
    } else if (begins_number(c)) {
      const std::size_t begin = i;
      while (i < text.size() && is_in_number(text[i])) ++i;
      const std::string number = text.substr(begin, i - begin);
      if (!std::isfinite(std::strtod(number.c_str(), nullptr)))
        fail_input("the number '" + number.substr(0, 40) + "' is too large", where(), "write numbers below 1e308");
    } else {
      if (c == '[' || c == '{') ++depth;
      if (c == ']' || c == '}') --depth;
      if (depth > kDeepest)
        fail_input(what + " is nested more than " + std::to_string(kDeepest) + " deep", where(), mend);
      ++i;
    }
  }
  return text;
}

}  // namespace stackmesh
