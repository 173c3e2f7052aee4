#pragma once
#include <string>
#include <vector>

#include "report/html_report.h"

namespace stackmesh {

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
