#pragma once
#include <memory>
#include <string>
#include <string_view>

namespace stackmesh {

/// SHA-256 (FIPS 180-4, by libcrypto), fed piece by piece.
class Sha256 {
 public:
  Sha256();
  ~Sha256();
  /// Goes on with these bytes.
  void add(std::string_view bytes);
  /// The digest as 64 hexadecimal digits; ends the feeding.
  std::string hex();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Digest of a file; "" when it cannot be read.
std::string sha256_of_file(const std::string& path);

}  // namespace stackmesh
