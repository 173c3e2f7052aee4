# The stitched complex to one fit for simulation: guarded smoothing, sizing, remeshing; nothing that was valid is lost.
stackmesh_module(enhance
  SOURCES complex_mesh.cpp complex_edits.cpp expected_tets.cpp blocks.cpp guard.cpp smoothing.cpp separate.cpp surface_distance.cpp ridges.cpp sizing.cpp reference.cpp local_operations.cpp unfold.cpp remesh.cpp
          enhance.cpp
  HEADERS enhance.h
  USES base model
  PRIVATE CGAL::CGAL)
