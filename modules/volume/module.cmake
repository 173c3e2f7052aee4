# A closed complex to tetrahedra. TetGen (AGPL) runs in a worker process, a small program of its own that this library finds beside itself.
stackmesh_module(volume
  SOURCES best_place.cpp compact.cpp estimate_tets.cpp fill_volume.cpp find_worker.cpp grow_layers.cpp layer_columns.cpp layer_levels.cpp improve_mesh.cpp improve_moves.cpp improve_pieces.cpp improve_tets.cpp label_tets.cpp orientation.cpp raise_order.cpp refine_tets.cpp relax_surface.cpp surface_curves.cpp tetgen_call.cpp tetgen_words.cpp worker_process.cpp
  HEADERS fill_volume.h grow_layers.h raise_order.h refine_tets.h
  USES base model
  PRIVATE CGAL::CGAL)
add_library(stackmesh_tetgen STATIC volume/worker/tetgen_worker.cpp)
target_include_directories(stackmesh_tetgen PUBLIC ${CMAKE_CURRENT_SOURCE_DIR} PRIVATE ${TETGEN_INCLUDE})
target_link_libraries(stackmesh_tetgen PUBLIC stackmesh_model PRIVATE ${TETGEN_LIBRARY})
target_compile_definitions(stackmesh_tetgen PRIVATE TETLIBRARY)
add_executable(stackmesh-tetgen volume/worker/main.cpp)
target_link_libraries(stackmesh-tetgen PRIVATE stackmesh_tetgen)
install(TARGETS stackmesh-tetgen RUNTIME DESTINATION ${CMAKE_INSTALL_LIBEXECDIR}/stackmesh COMPONENT program)
