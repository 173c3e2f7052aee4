# Surface and volume mesh files, out and in. Uses base, model; zlib and pugixml for VTK's XML files.
find_package(pugixml REQUIRED)
find_package(ZLIB REQUIRED)
stackmesh_module(meshio
  SOURCES write_mesh.cpp write_sections.cpp prepared_mesh.cpp surface_formats.cpp vtk_formats.cpp gmsh_format.cpp
          deck_formats.cpp abaqus_materials.cpp abaqus_steps.cpp deck_sets.cpp febio_format.cpp febio_steps.cpp nastran_format.cpp nastran_steps.cpp
          read_mesh.cpp raw_mesh.cpp read_surface_formats.cpp read_vtk_xml.cpp read_vtk_legacy.cpp read_gmsh.cpp read_decks.cpp
  HEADERS write_mesh.h write_sections.h read_mesh.h
  USES base model
  PRIVATE pugixml::pugixml ZLIB::ZLIB)
