# Errors that carry evidence, progress, parallel loops, atomic files, digests, text, sets that join. Uses nothing.
stackmesh_module(base
  SOURCES error.cpp warning.cpp parallel.cpp monitor.cpp cancel.cpp stage_clock.cpp beside.cpp atomic_file.cpp installed_part.cpp memory.cpp json_text.cpp sha256.cpp text.cpp
  HEADERS error.h warning.h parallel.h monitor.h cancel.h stage_clock.h stage_time.h beside.h atomic_file.h installed_part.h memory.h json_text.h sha256.h text.h disjoint_sets.h
  PRIVATE TBB::tbb crypto ${CMAKE_DL_LIBS})  # libcrypto, by name
target_compile_definitions(stackmesh_base PRIVATE STACKMESH_LIBEXEC="${CMAKE_INSTALL_FULL_LIBEXECDIR}/stackmesh" STACKMESH_PART_VERSION="${PROJECT_VERSION}")
