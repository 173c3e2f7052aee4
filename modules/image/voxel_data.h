#pragma once
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "base/warning.h"

namespace stackmesh {

/// The number types in which volume files store a voxel.
enum class VoxelType { u8, i8, u16, i16, u32, i32, u64, i64, f32, f64 };
std::size_t bytes_of(VoxelType type);

bool is_big_endian_machine();

/// How the numbers are stored. `deflate` is a gzip or zlib stream; `raw_or_gzip` is gzip where the file begins as one.
enum class VoxelEncoding { raw, raw_or_gzip, deflate, text, hex };

/// A stretch of a file that holds voxels.
struct DataPart {
  std::string path;
  std::uint64_t offset = 0;                                        ///< bytes of the file before it
  std::uint64_t size = std::numeric_limits<std::uint64_t>::max();  ///< at most so many bytes of the file
  std::uint64_t skip = 0;                                          ///< decoded bytes before the voxels
  /// the voxels are the last bytes of the file (of what is decoded)
  bool at_end = false;
};

/// Where the voxels of a volume are: the parts hold equal shares, in order.
struct VoxelData {
  VoxelType type = VoxelType::u8;
  bool big_endian = false;
  VoxelEncoding encoding = VoxelEncoding::raw;
  std::uint64_t count = 0;  ///< values in all parts
  std::vector<DataPart> parts;

  std::uint64_t bytes() const { return count * bytes_of(type); }
};

/// Compares what is needed with the bytes that the files have, before any memory is taken. A compressed stream is
/// looked at by its size (deflate cannot shrink data more than about 1032 times), and decoded without being kept where
/// it claims hundreds of megabytes. A data file that is longer than what is read of it is a warning; of several files
/// it is an error, as what is too much may be a header in front.
/// @throws Error(input) naming the file that is missing, no regular file, or too short
void check_voxel_data(const VoxelData& data, const std::string& path, std::vector<Warning>& warnings);

/// Reads all values into `memory` of data.bytes() bytes, in this machine's byte order. Check sums of compressed streams
/// are verified; bytes behind the voxels are not read beyond 16 MB, with a warning. @throws Error(input) naming the
/// file
void read_voxel_data(const VoxelData& data, const std::string& path, void* memory, std::vector<Warning>& warnings);

/// The size of a regular file in bytes. @throws Error(input) when it is missing or is no regular file
std::uint64_t size_of_file(const std::string& path, const std::string& what);

/// The first bytes of a file, decompressed if it is gzipped; `compressed` says so.
std::vector<unsigned char> read_start(const std::string& path, unsigned count, bool& compressed);

}  // namespace stackmesh
