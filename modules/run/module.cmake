# Paths and option texts become values, figures become reports and files; mesh orders the stages.
stackmesh_module(run COMPONENT Io
  SOURCES input.cpp layers.cpp mesh_run.cpp mesh_product.cpp fem_run.cpp fem_summary.cpp given_mesh.cpp provenance.cpp complete_report.cpp turn_as_a_whole.cpp
          validate_run.cpp mesh_to_judge.cpp mesh_frame.cpp label_matching.cpp output_files.cpp solve_with_calculix.cpp
  HEADERS input.h layers.h mesh_run.h mesh_product.h fem_run.h validate_run.h output_files.h
  USES base model image fair sections stitch enhance volume mesh fem meshio validate report)
target_compile_definitions(stackmesh_run PRIVATE STACKMESH_BUILD_TYPE="${CMAKE_BUILD_TYPE}")
