#pragma once
/// Labels and contours from files, meshes to files and back (component io).
#include <stackmesh/image/read_contours.h>
#include <stackmesh/image/read_labels.h>
#include <stackmesh/meshio/read_mesh.h>
#include <stackmesh/meshio/write_mesh.h>
#include <stackmesh/version.h>
