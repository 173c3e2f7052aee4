#include "pipeline/output_files.h"

#include <filesystem>

#include "base/atomic_file.h"
#include "base/error.h"

namespace stackmesh {
namespace {

namespace fs = std::filesystem;

bool is_one_file(const std::string& a, const std::string& b) {
  std::error_code error;
  if (a.empty() || b.empty()) return false;
  if (fs::equivalent(a, b, error) && !error) return true;  // through links, too
  const auto whole = [&](const std::string& path) { return fs::weakly_canonical(fs::absolute(behind_links(path), error), error); };
  const fs::path p = whole(a), q = whole(b);
  return !error && p == q;
}

/// The file of "LABEL=FILE", unless a file of the whole name is there.
std::string file_of(const std::string& input) {
  std::error_code ignored;
  const std::size_t equal = input.find('=');
  return equal == std::string::npos || input.find('/') < equal || fs::exists(input, ignored) ? input : input.substr(equal + 1);
}

}  // namespace

void check_output_files(const std::vector<std::string>& outputs, const std::vector<std::string>& inputs) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j)
      if (is_one_file(outputs[i], outputs[j])) fail_usage("two outputs are one file", "'" + outputs[j] + "' and '" + outputs[i] + "'", "give each a name of its own");
    for (const std::string& input : inputs)
      if (is_one_file(outputs[i], file_of(input))) fail_usage("an output would replace an input", "'" + outputs[i] + "'", "give the output a name of its own");
  }
  for (const std::string& path : outputs) AtomicFiles::check(path);
}

}  // namespace stackmesh
