#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace stackmesh {

/// Bytes that hold whole numbers in as few of them as they need (LEB128; signed ones zigzag).
class Bytes {
 public:
  void byte(std::uint8_t value) { text.push_back(static_cast<char>(value)); }
  void number(std::uint64_t value) {
    for (; value >= 0x80; value >>= 7) byte(static_cast<std::uint8_t>(value | 0x80));
    byte(static_cast<std::uint8_t>(value));
  }
  void signed_number(std::int64_t value) {
    number((static_cast<std::uint64_t>(value) << 1) ^ static_cast<std::uint64_t>(value >> 63));
  }
  std::string text;
};

/// A zlib stream of the bytes. @throws Error(internal)
std::string deflated(const std::string& bytes);

std::string base64(const std::string& bytes);

/// Several zlib streams, one after the other: the page unpacks each when it needs it.
class Blob {
 public:
  explicit Blob(std::string name) : name_(std::move(name)) {}
  /// Adds raw chunks, deflated in parallel, in their order; the number of the first.
  std::size_t add(const std::vector<std::string>& raw, int threads);
  const std::string& name() const { return name_; }
  const std::string& bytes() const { return bytes_; }
  const std::vector<std::size_t>& offsets() const { return offsets_; }  ///< of the chunks, and the end

 private:
  std::string name_, bytes_;
  std::vector<std::size_t> offsets_ = {0};
};

}  // namespace stackmesh
