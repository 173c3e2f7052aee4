# Errors that carry evidence, progress, parallel loops, atomic files, digests, text, sets that join. Uses nothing.
stackmesh_module(base
  SOURCES error.cpp warning.cpp parallel.cpp monitor.cpp cancel.cpp stage_clock.cpp beside.cpp atomic_file.cpp memory.cpp json_text.cpp sha256.cpp text.cpp
  HEADERS error.h warning.h parallel.h monitor.h cancel.h stage_clock.h stage_time.h beside.h atomic_file.h memory.h json_text.h sha256.h text.h disjoint_sets.h
  PRIVATE TBB::tbb crypto)  # libcrypto, by name
