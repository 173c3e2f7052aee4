#pragma once
#include <algorithm>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/text.h"

namespace stackmesh {

inline bool is_html_report(const std::string& path) {
  return ends_with(path, ".html");
}

inline bool asks_for_html(const std::vector<std::string>& reports) {
  return std::any_of(reports.begin(), reports.end(), is_html_report);
}

/// @throws Error(usage) for a report of another ending than .json or .html.
inline void check_report_names(const std::vector<std::string>& reports) {
  for (const std::string& path : reports)
    if (!ends_with(path, ".json") && !is_html_report(path))
      fail_usage("unknown ending of a report", "'" + path + "'", "choose .json or .html");
}

}  // namespace stackmesh
