# The only place that orders stages.
stackmesh_module(pipeline
  SOURCES input.cpp keep_pieces.cpp virtual_sections.cpp volume_sections.cpp gap_pieces.cpp layers.cpp far_sections.cpp mesh_run.cpp mesh_product.cpp voids.cpp fem_run.cpp stage_clock.cpp beside.cpp provenance.cpp complete_report.cpp turn_as_a_whole.cpp
          validate_run.cpp output_files.cpp solve_with_calculix.cpp
  HEADERS input.h keep_pieces.h layers.h virtual_sections.h volume_sections.h mesh_run.h mesh_product.h fem_run.h validate_run.h output_files.h
  USES base model image interpolate fair contour stitch enhance volume fem meshio validate report)
target_compile_definitions(stackmesh_pipeline PRIVATE STACKMESH_BUILD_TYPE="${CMAKE_BUILD_TYPE}")
