# The independent judge of surfaces and tetrahedra: closure, exact intersections, quality, fidelity to the labels.
stackmesh_module(validate
  SOURCES check_surface.cpp check_volume.cpp check_wedges.cpp check_fidelity.cpp match_components.cpp exact.cpp triangle_contact.cpp box_tree.cpp
          self_intersections.cpp label_agreement.cpp boundaries.cpp label_runs.cpp grid_walk.cpp verdict.cpp overlap.cpp defects.cpp check_thickness.cpp
          face_rectangles.cpp vertex_distances.cpp check_topology.cpp band.cpp check_bends.cpp
  HEADERS check_surface.h check_volume.h check_fidelity.h verdict.h overlap.h defects.h check_thickness.h check_topology.h check_bends.h vertex_distances.h
  USES base model
  PRIVATE CGAL::CGAL)
