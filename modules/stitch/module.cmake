# Sections to the closed complex of label interfaces: one constrained triangulation a slab.
stackmesh_module(stitch
  SOURCES merge_tolerance.cpp sheet_layers.cpp slab.cpp slab_heights.cpp slab_sheets.cpp stitch.cpp
  HEADERS stitch.h
  USES base model planar
  PRIVATE CGAL::CGAL)
