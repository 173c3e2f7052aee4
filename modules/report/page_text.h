#pragma once
#include <string>
#include <vector>

#include "report/html_report.h"

namespace stackmesh {

/// Text that is safe in HTML, between tags and in attributes.
std::string escaped(const std::string& text);

/// The parts of the page that need no script, as HTML.
std::string verdict_html(const RunReport& report);
std::string labels_html(const RunReport& report, const std::vector<std::string>& colours);
std::string comparison_html(const std::vector<HtmlSubject>& subjects);
std::string provenance_html(const RunReport& report);

}  // namespace stackmesh
