#pragma once
#include <cstdint>
#include <string>

namespace stackmesh {

/// Decompresses a gzip or zlib stream that begins at `offset` of a file, to its very end, and throws the data
/// away. The check sums tell what the image libraries pass over in silence: a file that was cut or has a
/// flipped bit.
/// @return "" when it is whole and yields at least `needed` bytes, else what is wrong with it.
std::string check_deflate(const std::string& path, std::uint64_t offset, std::uint64_t size,
                          std::uint64_t needed);

}  // namespace stackmesh
