#pragma once

/// The files of modules/cohort/page, as the build found them.
namespace stackmesh::page {
extern const char *const cohort_html, *const cohort_css, *const cohort_js;
}  // namespace stackmesh::page
