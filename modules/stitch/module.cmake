# Sections to the closed complex of label interfaces: snap rounding, one constrained triangulation a slab.
stackmesh_module(stitch
  SOURCES edge_grid.cpp snap_rounding.cpp merge_tolerance.cpp polygons.cpp planar.cpp slab.cpp stitch.cpp
  HEADERS stitch.h polygons.h snap_rounding.h edge_grid.h
  USES base model
  PRIVATE CGAL::CGAL)
