# The run's figures as a report: JSON with the fields of modules/report/README.md, and an HTML page with pictures.
find_package(OpenMesh REQUIRED CONFIG)
find_path(THREE_JS three.min.js PATHS /usr/share/javascript/three REQUIRED)
find_path(CHART_JS chart.min.js PATHS /usr/share/javascript/chart.js REQUIRED)
set(page_names html css data_js tables_js sections_js solid_js main_js three_js orbit_js chart_js)
set(page_own page.html page.css data.js tables.js sections.js solid.js main.js)
list(TRANSFORM page_own PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/report/page/)
set(page_paths ${page_own} ${THREE_JS}/three.min.js ${THREE_JS}/examples/js/controls/OrbitControls.js ${CHART_JS}/chart.min.js)
set(page_cpp ${CMAKE_CURRENT_BINARY_DIR}/report/page_files.cpp)
add_custom_command(OUTPUT ${page_cpp}
  COMMAND ${CMAKE_COMMAND} -D "OUT=${page_cpp}" -D "NAMES=${page_names}" -D "FILES=${page_paths}" -P ${CMAKE_CURRENT_SOURCE_DIR}/report/page/embed.cmake
  DEPENDS ${page_paths} ${CMAKE_CURRENT_SOURCE_DIR}/report/page/embed.cmake
  COMMENT "Embedding the report page" VERBATIM)
stackmesh_module(report COMPONENT Io
  SOURCES run_report.cpp comparison.cpp html_report.cpp draw_pictures.cpp page_text.cpp page_labels.cpp page_model.cpp
          html_text.cpp section_cuts.cpp polylines.cpp display_mesh.cpp decimate.cpp join_cells.cpp
          histograms.cpp worst_places.cpp label_colours.cpp packed.cpp surface_values.cpp
  HEADERS run_report.h comparison.h html_report.h surface_values.h
  USES base model validate fem
  PRIVATE nlohmann_json::nlohmann_json ZLIB::ZLIB OpenMeshTools OpenMeshCore)
target_sources(stackmesh_report PRIVATE ${page_cpp})
# OpenMesh's vectors are made without values; GCC tells so of its headers.
set_source_files_properties(report/decimate.cpp PROPERTIES COMPILE_OPTIONS "$<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>")
