#pragma once
#include <charconv>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string_view>

namespace stackmesh {

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "the binary formats are written in the order of the host");

/// Gathers text and bytes into large chunks. After a failed write it stays silent, so that errno and ferror()
/// still tell AtomicFiles what happened.
class OutputBuffer {
 public:
  explicit OutputBuffer(std::FILE* file) : file_(file), data_(new char[kCapacity]) {}
  OutputBuffer(const OutputBuffer&) = delete;
  OutputBuffer& operator=(const OutputBuffer&) = delete;
  ~OutputBuffer() { flush(); }

  OutputBuffer& operator<<(std::string_view text) {
    bytes(text.data(), text.size());
    return *this;
  }
  OutputBuffer& operator<<(char c) {
    reserve(1);
    data_[used_++] = c;
    return *this;
  }
  OutputBuffer& operator<<(std::int64_t value) { return print(value); }
  OutputBuffer& operator<<(std::int32_t value) { return print(value); }
  OutputBuffer& operator<<(std::size_t value) { return print(value); }
  /// The shortest text that reads back as the same double.
  OutputBuffer& operator<<(double value) { return print(value); }

  /// As <<, but at most 20 characters, the width that Abaqus and CalculiX read; digits beyond are rounded
  /// off.
  void print20(double value) {
    reserve(kNumber);
    char* const begin = data_.get() + used_;
    char* end = std::to_chars(begin, begin + kNumber, value).ptr;
    for (int digits = 16; end - begin > 20; --digits)
      end = std::to_chars(begin, begin + kNumber, value, std::chars_format::general, digits).ptr;
    used_ += static_cast<std::size_t>(end - begin);
  }

  void bytes(const void* source, std::size_t size) {
    if (size > kCapacity / 2) {  // large arrays go straight through
      flush();
      if (std::ferror(file_) == 0) std::fwrite(source, 1, size, file_);
      return;
    }
    reserve(size);
    std::memcpy(data_.get() + used_, source, size);
    used_ += size;
  }
  /// A number as it lies in memory (little endian).
  template <class T>
  void binary(T value) {
    bytes(&value, sizeof value);
  }
  /// A number with its bytes reversed (big endian).
  template <class T>
  void big_endian(T value) {
    reserve(sizeof value);
    char* const to = data_.get() + used_;
    std::memcpy(to, &value, sizeof value);
    for (std::size_t i = 0; i < sizeof value / 2; ++i) std::swap(to[i], to[sizeof value - 1 - i]);
    used_ += sizeof value;
  }

 private:
  static constexpr std::size_t kCapacity = std::size_t{1} << 20, kNumber = 48;

  template <class T>
  OutputBuffer& print(T value) {
    reserve(kNumber);
    char* const begin = data_.get() + used_;
    used_ += static_cast<std::size_t>(std::to_chars(begin, begin + kNumber, value).ptr - begin);
    return *this;
  }
  void reserve(std::size_t size) {
    if (used_ + size > kCapacity) flush();
  }
  void flush() {
    if (used_ > 0 && std::ferror(file_) == 0) std::fwrite(data_.get(), 1, used_, file_);
    used_ = 0;
  }

  std::FILE* file_;
  std::unique_ptr<char[]> data_;
  std::size_t used_ = 0;
};

}  // namespace stackmesh
