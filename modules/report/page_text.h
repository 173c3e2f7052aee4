#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "report/html_report.h"

namespace stackmesh {

/// Text that is safe in HTML, between tags and in attributes.
std::string escaped(const std::string& text);

/// JSON that may stand in a script element: nothing in it can end the element.
std::string for_script(const std::string& json);

/// Replaces each {{name}} of a page once; what is put in is not looked at again. Precondition: `parts` has every name.
std::string filled(const std::string& page, const std::map<std::string, std::string>& parts);

/// With thousands apart: 12,345.
std::string grouped(std::uint64_t value);

/// The parts of the page that need no script, as HTML; of several meshes one after the other.
std::string verdict_html(const std::vector<HtmlSubject>& subjects);
std::string comparison_html(const std::vector<HtmlSubject>& subjects);
/// `colours` are beside the labels of the first report.
std::string labels_html(const std::vector<HtmlSubject>& subjects, const std::vector<std::string>& colours);
/// Sets, materials and loads of solver models; empty where there is none.
std::string model_html(const std::vector<HtmlSubject>& subjects);
/// Where it fails, with a button for each place that the scripts serve.
std::string defects_html(const std::vector<HtmlSubject>& subjects);
std::string provenance_html(const std::vector<HtmlSubject>& subjects);

/// A defect's place in the frame that the pictures of its mesh are in.
Vec3 place_of(const Defect& defect, const HtmlSubject& subject);

}  // namespace stackmesh
