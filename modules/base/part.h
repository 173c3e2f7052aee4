#pragma once
// For the sources of a part (installed_part.h): what it shows to the program that loads it.
#define STACKMESH_OF_PART extern "C" __attribute__((visibility("default")))

/// Every part says once, in one of its sources, which version it belongs to.
#define STACKMESH_PART_VERSION_IS(version)                 \
  STACKMESH_OF_PART const char* stackmesh_part_version() { \
    return version;                                        \
  }
