# The product as a function: labels in memory to a checked mesh in memory. Orders the stages; knows no files, no options' texts, no reports.
stackmesh_module(mesh
  SOURCES mesh.cpp surface_stage.cpp tet_stage.cpp judge.cpp keep_pieces.cpp voids.cpp layers.cpp
  HEADERS mesh.h keep_pieces.h voids.h
  USES base model fair sections stitch enhance volume validate)
