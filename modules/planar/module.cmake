# Partitions of a plane, exactly: snap rounding of their edges, constrained triangulation, regions by flooding.
stackmesh_module(planar
  SOURCES snap_rounding.cpp planar.cpp
  USES base model
  PRIVATE CGAL::CGAL)
