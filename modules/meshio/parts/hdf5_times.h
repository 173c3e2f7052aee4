#pragma once
#include <cstddef>

namespace stackmesh {

/// Sets the times in the object headers of an HDF5 file in memory to zero, so that the same mesh gives the same bytes;
/// the headers' checksums follow. Only headers of version 2 whose checksum is right are touched (HDF5 file format
/// specification, IV.A.1.b).
/// @return how many headers had times
std::size_t clear_hdf5_times(unsigned char* bytes, std::size_t size);

}  // namespace stackmesh
