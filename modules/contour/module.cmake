# Label slices to sections: exact crack contours (OpenCV), shared arcs, simplification.
stackmesh_module(contour
  SOURCES components.cpp trace.cpp simplify.cpp untangle.cpp layer_sections.cpp extract.cpp
  HEADERS extract.h layer_sections.h
  USES base model
  PRIVATE opencv_core opencv_imgproc)
