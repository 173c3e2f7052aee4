#include "base/memory.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <limits>

#include "base/error.h"
#include "base/text.h"

namespace stackmesh {
namespace {

std::atomic<std::uint64_t> asked{0};

/// A file that holds one number; `none` where it does not ("max").
std::uint64_t number_in(const std::string& path, std::uint64_t none) {
  std::ifstream file(path);
  std::uint64_t value = 0;
  return file >> value ? value : none;
}

std::uint64_t machine_memory() {
  const long pages = ::sysconf(_SC_PHYS_PAGES), size = ::sysconf(_SC_PAGESIZE);
  return pages > 0 && size > 0 ? static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(size)
                               : std::numeric_limits<std::uint64_t>::max();
}

/// The smallest bound of the control groups that this process is in (version 2, then 1).
std::uint64_t group_memory() {
  constexpr std::uint64_t none = std::numeric_limits<std::uint64_t>::max();
  std::uint64_t least = std::min(number_in("/sys/fs/cgroup/memory.max", none),
                                 number_in("/sys/fs/cgroup/memory/memory.limit_in_bytes", none));
  std::ifstream groups("/proc/self/cgroup");
  for (std::string line; std::getline(groups, line);) {
    if (line.compare(0, 3, "0::") != 0) continue;
    for (std::string path = line.substr(3); path.size() > 1; path.resize(path.find_last_of('/')))
      least = std::min(least, number_in("/sys/fs/cgroup" + path + "/memory.max", none));
  }
  return least;
}

/// What whoever started the process lets it take (ulimit -v, -d), as it was at the first call.
std::uint64_t process_memory() {
  static const std::uint64_t least = [] {
    std::uint64_t bytes = std::numeric_limits<std::uint64_t>::max();
    rlimit limit{};
    for (const auto which : {RLIMIT_AS, RLIMIT_DATA})
      if (::getrlimit(which, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
        bytes = std::min<std::uint64_t>(bytes, limit.rlim_cur);
    return bytes;
  }();
  return least;
}

}  // namespace

std::uint64_t memory_limit() {
  static const std::uint64_t there = std::min({machine_memory(), group_memory(), process_memory()});
  const std::uint64_t bytes = asked.load();
  return bytes > 0 ? std::min(bytes, process_memory()) : there;
}

void set_memory_limit(std::uint64_t bytes) {
  asked = bytes;
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  return;  // the terabytes of a sanitizer's shadow would count
#endif
  rlimit limit{};
  if (::getrlimit(RLIMIT_DATA, &limit) != 0) return;
  limit.rlim_cur = static_cast<rlim_t>(std::min<std::uint64_t>(memory_limit(), limit.rlim_max));
  ::setrlimit(RLIMIT_DATA, &limit);
}

std::uint64_t memory_in_use() {
  std::ifstream file("/proc/self/statm");
  std::uint64_t size = 0, resident = 0, shared = 0;
  if (!(file >> size >> resident >> shared)) return 0;
  return (resident - std::min(shared, resident)) * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

std::string memory_text(std::uint64_t bytes) {
  char text[40];
  const double mb = static_cast<double>(bytes) / (1 << 20);
  if (mb < 1000) std::snprintf(text, sizeof text, "%.0f MB", mb);
  else std::snprintf(text, sizeof text, "%.3g GB", mb / 1024);
  return text;
}

void require_memory(std::uint64_t bytes, const std::string& what, const std::string& where, const std::string& mend) {
  const std::uint64_t used = memory_in_use(), limit = memory_limit();
  if (bytes <= limit && used <= limit - bytes) return;
  throw Error(ErrorKind::no_result,
              what + " need " + memory_text(bytes) +
                  (used > (64u << 20) ? " beside the " + memory_text(used) + " in use" : "") + ", of " +
                  memory_text(limit) + " that may be taken",
              where, mend + ", or give more memory" + (asked.load() > 0 ? " with --max-memory" : ""));
}

std::uint64_t parse_memory(const std::string& text, const std::string& option) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  std::string unit = lower_case(end);
  unit.erase(std::remove(unit.begin(), unit.end(), ' '), unit.end());
  const double factor = unit.empty() || unit == "b"                    ? 1
                        : unit == "k" || unit == "kb" || unit == "kib" ? 1024.0
                        : unit == "m" || unit == "mb" || unit == "mib" ? 1048576.0
                        : unit == "g" || unit == "gb" || unit == "gib" ? 1073741824.0
                        : unit == "t" || unit == "tb" || unit == "tib" ? 1099511627776.0
                                                                       : 0;
  const double bytes = value * factor;
  if (end == text.c_str() || !(bytes >= 1 << 26) || !(bytes < 1e18))
    fail_usage("'" + text + "' is no amount of memory of at least 64 MB", option, "write --max-memory 4GB");
  return static_cast<std::uint64_t>(bytes);
}

}  // namespace stackmesh
