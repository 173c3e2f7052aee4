#include "meshio/parts/hdf5_times.h"

#include <array>
#include <cstdint>
#include <cstring>

namespace stackmesh {
namespace {

std::uint32_t turn(std::uint32_t x, int n) {
  return x << n | x >> (32 - n);
}

/// The checksum of HDF5's metadata: Bob Jenkins's lookup3, over bytes.
std::uint32_t checksum(const unsigned char* k, std::size_t length) {
  std::uint32_t a = 0xdeadbeef + static_cast<std::uint32_t>(length), b = a, c = a;
  const auto word = [&](int at) {
    return std::uint32_t{k[at]} | std::uint32_t{k[at + 1]} << 8 | std::uint32_t{k[at + 2]} << 16 |
           std::uint32_t{k[at + 3]} << 24;
  };
  for (; length > 12; length -= 12, k += 12) {
    a += word(0), b += word(4), c += word(8);
    a -= c, a ^= turn(c, 4), c += b;
    b -= a, b ^= turn(a, 6), a += c;
    c -= b, c ^= turn(b, 8), b += a;
    a -= c, a ^= turn(c, 16), c += b;
    b -= a, b ^= turn(a, 19), a += c;
    c -= b, c ^= turn(b, 4), b += a;
  }
  if (length == 0) return c;
  std::array<std::uint32_t, 3> last{};
  for (std::size_t i = 0; i < length; ++i) last[i / 4] += std::uint32_t{k[i]} << (8 * (i % 4));
  a += last[0], b += last[1], c += last[2];
  c ^= b, c -= turn(b, 14);
  a ^= c, a -= turn(c, 11);
  b ^= a, b -= turn(a, 25);
  c ^= b, c -= turn(b, 16);
  a ^= c, a -= turn(c, 4);
  b ^= a, b -= turn(a, 14);
  c ^= b, c -= turn(b, 24);
  return c;
}

constexpr std::size_t kPrefix = 6, kTimes = 16;  // signature, version, flags; four times
constexpr unsigned char kHasTimes = 0x20, kHasPhases = 0x10;

}  // namespace

std::size_t clear_hdf5_times(unsigned char* bytes, std::size_t size) {
  std::size_t cleared = 0;
  for (std::size_t at = 0; at + kPrefix + kTimes < size; ++at) {
    unsigned char* const header = bytes + at;
    if (std::memcmp(header, "OHDR\2", 5) != 0 || !(header[5] & kHasTimes)) continue;
    const unsigned char flags = header[5];
    std::size_t prefix = kPrefix + kTimes + (flags & kHasPhases ? 4 : 0);
    const std::size_t width = std::size_t{1} << (flags & 3);
    if (at + prefix + width > size) continue;
    std::size_t length = 0;
    for (std::size_t i = 0; i < width; ++i) length |= std::size_t{header[prefix + i]} << (8 * i);
    prefix += width;
    if (length > size || at + prefix + length + 4 > size) continue;
    const std::size_t covered = prefix + length;
    std::uint32_t stored = 0;
    std::memcpy(&stored, header + covered, 4);
    if (stored != checksum(header, covered)) continue;  // bytes of something else
    std::memset(header + kPrefix, 0, kTimes);
    const std::uint32_t fresh = checksum(header, covered);
    std::memcpy(header + covered, &fresh, 4);
    ++cleared;
  }
  return cleared;
}

}  // namespace stackmesh
