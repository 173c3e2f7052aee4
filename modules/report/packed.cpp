#include "report/packed.h"

#include <zlib.h>

#include "base/error.h"
#include "base/parallel.h"

namespace stackmesh {

std::string deflated(const std::string& bytes) {
  uLongf length = compressBound(static_cast<uLong>(bytes.size()));
  std::string out(length, '\0');
  if (compress2(reinterpret_cast<Bytef*>(out.data()), &length, reinterpret_cast<const Bytef*>(bytes.data()),
                static_cast<uLong>(bytes.size()), 5) != Z_OK)
    fail_internal("zlib cannot compress", "HTML report");
  out.resize(length);
  return out;
}

std::string base64(const std::string& bytes) {
  static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (i + k < bytes.size() ? static_cast<std::uint8_t>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) out.push_back(i + k <= bytes.size() ? digits[group >> (18 - 6 * k) & 63] : '=');
  }
  return out;
}

std::size_t Blob::add(const std::vector<std::string>& raw, int threads) {
  std::vector<std::string> packed(raw.size());
  parallel_for(raw.size(), threads, [&](std::size_t i) { packed[i] = deflated(raw[i]); });
  const std::size_t first = offsets_.size() - 1;
  for (const std::string& chunk : packed) {
    bytes_ += chunk;
    offsets_.push_back(bytes_.size());
  }
  return first;
}

}  // namespace stackmesh
