# Virtual slices between far slices of a label volume: signed distances (OpenCV), a spline across the slices.
stackmesh_module(interpolate
  SOURCES virtual_slices.cpp virtual_layers.cpp section_raster.cpp fill_gap.cpp nested_gap.cpp group_field.cpp slice_fields.cpp islands.cpp keep_components.cpp
  HEADERS virtual_slices.h virtual_layers.h
  USES base model
  PRIVATE opencv_core opencv_imgproc)
