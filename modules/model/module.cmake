# The types in which the stages meet, and the checks of their invariants.
stackmesh_module(model
  SOURCES label_volume.cpp label_table.cpp intensity_volume.cpp stack.cpp edge_grid.cpp slices.cpp voxel_components.cpp triangle_contact.cpp tet_mesh.cpp space.cpp
  HEADERS geometry.h label_volume.h label_table.h label_layer.h intensity_volume.h contours.h stack.h edge_grid.h slices.h voxel_components.h triangle_contact.h corner_rule.h faired_labels.h complex.h tet_mesh.h space.h wedge_shape.h layers.h solver_model.h
  USES base
  PRIVATE CGAL::CGAL)
