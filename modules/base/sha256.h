#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace stackmesh {

/// SHA-256 (FIPS 180-4), fed piece by piece.
class Sha256 {
 public:
  void add(std::string_view bytes);
  /// The digest as 64 hexadecimal digits; ends the feeding.
  std::string hex();

 private:
  void block(const unsigned char* bytes);
  std::array<std::uint32_t, 8> state_ = {0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a, 0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  unsigned char rest_[64] = {};
  std::size_t used_ = 0;
  std::uint64_t length_ = 0;
};

/// Digest of a file; "" when it cannot be read.
std::string sha256_of_file(const std::string& path);

}  // namespace stackmesh
