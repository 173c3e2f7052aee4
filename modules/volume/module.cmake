# A closed complex to tetrahedra. TetGen (AGPL) stays in here, and runs in a worker process only.
stackmesh_module(volume
  SOURCES best_place.cpp compact.cpp fill_volume.cpp grow_layers.cpp improve_mesh.cpp improve_moves.cpp improve_pieces.cpp improve_tets.cpp label_tets.cpp layer_columns.cpp layer_levels.cpp raise_order.cpp refine_tets.cpp relax_surface.cpp tetgen_worker.cpp worker_process.cpp
  HEADERS fill_volume.h grow_layers.h raise_order.h refine_tets.h tetgen_worker.h
  USES base model
  PRIVATE ${TETGEN_LIBRARY})
target_include_directories(stackmesh_volume PRIVATE ${TETGEN_INCLUDE})
target_compile_definitions(stackmesh_volume PRIVATE TETLIBRARY)
