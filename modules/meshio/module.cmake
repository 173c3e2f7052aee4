# Surface and volume mesh files. Uses base, model; no third party.
stackmesh_module(meshio
  SOURCES write_mesh.cpp write_sections.cpp prepared_mesh.cpp surface_formats.cpp vtk_formats.cpp gmsh_format.cpp
          deck_formats.cpp deck_sets.cpp febio_format.cpp nastran_format.cpp
  HEADERS write_mesh.h write_sections.h
  USES base model)
