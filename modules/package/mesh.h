#pragma once
/// Labels or contours in memory to a checked surface or tetrahedral mesh in memory (component core).
#include <stackmesh/mesh/mesh.h>
#include <stackmesh/version.h>
