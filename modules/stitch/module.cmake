# Sections to the closed complex of label interfaces: snap rounding, one constrained triangulation a slab.
stackmesh_module(stitch
  SOURCES snap_rounding.cpp merge_tolerance.cpp polygons.cpp contour_copies.cpp contour_crossings.cpp drawn_detail.cpp drawn_ends.cpp missing_contours.cpp openings.cpp planar.cpp sheet_layers.cpp slab.cpp stitch.cpp
  HEADERS stitch.h polygons.h drawn_detail.h snap_rounding.h
  USES base model
  PRIVATE CGAL::CGAL)
