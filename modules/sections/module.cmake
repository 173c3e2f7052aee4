# Everything that makes a stack of sections: label slices or drawn contours, faired and traced, with virtual ones between those that lie far apart.
stackmesh_module(sections
  SOURCES volume_sections.cpp virtual_sections.cpp gap_pieces.cpp far_sections.cpp
          components.cpp trace.cpp simplify.cpp untangle.cpp layer_sections.cpp extract.cpp
          virtual_slices.cpp virtual_layers.cpp section_edges.cpp section_raster.cpp fill_gap.cpp nested_gap.cpp group_field.cpp slice_fields.cpp islands.cpp keep_components.cpp
          polygons.cpp contour_copies.cpp contour_crossings.cpp drawn_detail.cpp drawn_ends.cpp missing_contours.cpp openings.cpp contour_names.cpp
          masked_section.cpp mend_crossings.cpp drawn_warnings.cpp
  HEADERS volume_sections.h virtual_sections.h far_sections.h extract.h layer_sections.h virtual_slices.h virtual_layers.h polygons.h drawn_detail.h
  USES base model fair planar stitch
  PRIVATE opencv_core opencv_imgproc)
