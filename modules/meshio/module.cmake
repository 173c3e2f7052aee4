# Surface and volume mesh files, out and in. Uses base, model; zlib and pugixml for VTK's XML files, libexodusii and libmedC for their own.
find_package(pugixml REQUIRED)
find_package(ZLIB REQUIRED)
find_library(EXODUS_LIBRARY exoIIv2c REQUIRED)
find_library(MED_LIBRARY medC REQUIRED)
# Debian's MED is built upon the HDF5 of Open MPI; its header wants their types, nothing of MPI is called.
find_path(MED_HDF5_HEADERS hdf5.h PATH_SUFFIXES hdf5/openmpi REQUIRED)
find_path(MPI_HEADERS mpi.h PATH_SUFFIXES mpi REQUIRED)
stackmesh_module(meshio COMPONENT Io
  SOURCES write_mesh.cpp write_sections.cpp prepared_mesh.cpp surface_formats.cpp vtk_formats.cpp gmsh_format.cpp
          deck_formats.cpp abaqus_materials.cpp abaqus_steps.cpp deck_sets.cpp febio_format.cpp febio_steps.cpp nastran_format.cpp nastran_steps.cpp
          fixed_fields.cpp ansys_format.cpp lsdyna_format.cpp hdf5_formats.cpp
          read_mesh.cpp faces_of_tets.cpp raw_mesh.cpp read_surface_formats.cpp read_vtk_xml.cpp read_vtk_legacy.cpp read_gmsh.cpp read_decks.cpp read_frd.cpp
  HEADERS write_mesh.h write_sections.h read_mesh.h read_frd.h
  USES base model
  PRIVATE pugixml::pugixml ZLIB::ZLIB)
stackmesh_part(stackmesh-hdf5 OF meshio SOURCES parts/hdf5_part.cpp parts/exodus_format.cpp parts/med_format.cpp parts/hdf5_times.cpp prepared_mesh.cpp deck_sets.cpp
  USES base model PRIVATE ${EXODUS_LIBRARY} ${MED_LIBRARY})
set_source_files_properties(meshio/parts/med_format.cpp PROPERTIES INCLUDE_DIRECTORIES "${MED_HDF5_HEADERS};${MPI_HEADERS}")
