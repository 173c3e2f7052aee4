# Cohorts: manifests, keys, cases as processes of the program itself, Slurm arrays, and the page of all of them.
set(cohort_cpp ${CMAKE_CURRENT_BINARY_DIR}/cohort/page_files.cpp)
set(cohort_pages ${CMAKE_CURRENT_SOURCE_DIR}/cohort/page/cohort.html ${CMAKE_CURRENT_SOURCE_DIR}/cohort/page/cohort.css ${CMAKE_CURRENT_SOURCE_DIR}/cohort/page/cohort.js)
add_custom_command(OUTPUT ${cohort_cpp}
  COMMAND ${CMAKE_COMMAND} -D "OUT=${cohort_cpp}" -D "NAMES=cohort_html;cohort_css;cohort_js" -D "FILES=${cohort_pages}" -D "HEADER=cohort/page_files.h"
          -P ${CMAKE_CURRENT_SOURCE_DIR}/report/page/embed.cmake
  DEPENDS ${cohort_pages} ${CMAKE_CURRENT_SOURCE_DIR}/report/page/embed.cmake
  COMMENT "Embedding the cohort page" VERBATIM)
find_package(PNG REQUIRED)
stackmesh_module(cohort COMPONENT Io
  SOURCES table.cpp cohort_case.cpp manifest.cpp records.cpp cohort_folder.cpp look.cpp child.cpp run_cases.cpp slurm.cpp
          collect.cpp outliers.cpp cohort_files.cpp cohort_page.cpp thumbnail.cpp png.cpp
  HEADERS table.h cohort_case.h manifest.h cohort_folder.h look.h run_cases.h slurm.h collect.h outliers.h
  USES base model meshio report run
  PRIVATE nlohmann_json::nlohmann_json PNG::PNG)
target_sources(stackmesh_cohort PRIVATE ${cohort_cpp})
