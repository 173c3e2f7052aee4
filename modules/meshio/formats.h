#pragma once
#include <cstdio>

#include "meshio/prepared_mesh.h"

// One function a format; each writes to a stream that AtomicFiles checks.
namespace stackmesh {

void write_stl(std::FILE* file, const PreparedMesh& mesh);
void write_ply(std::FILE* file, const PreparedMesh& mesh);
void write_obj(std::FILE* file, const PreparedMesh& mesh);
void write_off(std::FILE* file, const PreparedMesh& mesh);
void write_vtp(std::FILE* file, const PreparedMesh& mesh);

void write_vtu(std::FILE* file, const PreparedMesh& mesh);
void write_vtk(std::FILE* file, const PreparedMesh& mesh);
void write_msh4(std::FILE* file, const PreparedMesh& mesh);
void write_msh2(std::FILE* file, const PreparedMesh& mesh);
void write_inp(std::FILE* file, const PreparedMesh& mesh);
void write_feb(std::FILE* file, const PreparedMesh& mesh);
void write_bdf(std::FILE* file, const PreparedMesh& mesh);
void write_medit(std::FILE* file, const PreparedMesh& mesh);
void write_cdb(std::FILE* file, const PreparedMesh& mesh);
void write_dyna(std::FILE* file, const PreparedMesh& mesh);
void write_med(std::FILE* file, const PreparedMesh& mesh);

// By a library that opens the file itself. @throws Error(output)
void write_exodus(const std::string& path, const PreparedMesh& mesh);

// @throws Error(no_result) where the part that writes .exo and .med is not installed
void require_hdf5_writers();

}  // namespace stackmesh
