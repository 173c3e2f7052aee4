#pragma once

/// The files of modules/report/page, and three.js and Chart.js, as the build found them.
namespace stackmesh::page {
extern const char *const html, *const css, *const data_js, *const tables_js, *const sections_js, *const solid_js,
                                                                                                     *const main_js;
extern const char *const three_js, *const orbit_js, *const chart_js;
}  // namespace stackmesh::page
