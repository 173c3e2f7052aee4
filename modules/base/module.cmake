# Errors that carry evidence, progress, parallel loops, atomic files. Uses nothing.
stackmesh_module(base
  SOURCES error.cpp parallel.cpp progress.cpp atomic_file.cpp
  HEADERS error.h parallel.h progress.h atomic_file.h
  PRIVATE TBB::tbb)
