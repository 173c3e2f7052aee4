# The only place that orders stages.
stackmesh_module(pipeline
  SOURCES input.cpp virtual_sections.cpp mesh_run.cpp stage_clock.cpp
  HEADERS input.h virtual_sections.h mesh_run.h
  USES base model image contour interpolate stitch enhance volume fem meshio validate report)
