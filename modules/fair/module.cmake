# Label interfaces at sub-voxel places: a net with one vertex a cell, bent as little as the voxel centres allow.
stackmesh_module(fair
  SOURCES net.cpp bend.cpp net_volume.cpp fair_labels.cpp true_grid.cpp
  HEADERS fair_labels.h true_grid.h
  USES base model)
