#include "image/deflate_check.h"

#include <zlib.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <vector>

namespace stackmesh {

std::string check_deflate(const std::string& path, std::uint64_t offset, std::uint64_t size,
                          std::uint64_t needed) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), &std::fclose);
  if (!file || fseeko(file.get(), static_cast<off_t>(offset), SEEK_SET) != 0) return "cannot be opened";
  z_stream stream{};
  if (inflateInit2(&stream, 15 + 32) != Z_OK) return "cannot be decompressed: out of memory";
  const std::unique_ptr<z_stream, int (*)(z_stream*)> guard(&stream, &inflateEnd);

  std::vector<unsigned char> in(1 << 16), out(1 << 18);
  std::uint64_t produced = 0;
  bool complete = false;
  while (true) {
    if (stream.avail_in == 0) {
      stream.next_in = in.data();
      const std::size_t want = static_cast<std::size_t>(std::min<std::uint64_t>(in.size(), size));
      stream.avail_in = static_cast<uInt>(std::fread(in.data(), 1, want, file.get()));
      size -= stream.avail_in;
      if (stream.avail_in == 0) break;
    }
    if (complete) {
      // Another gzip member follows, or padding that readers ignore.
      if (stream.next_in[0] != 0x1f) break;
      inflateReset(&stream);
      complete = false;
    }
    stream.next_out = out.data();
    stream.avail_out = static_cast<uInt>(out.size());
    const int code = inflate(&stream, Z_NO_FLUSH);
    produced += out.size() - stream.avail_out;
    if (code == Z_STREAM_END)
      complete = true;
    else if (code != Z_OK && code != Z_BUF_ERROR)
      return "its compressed data are damaged";
  }
  if (!complete) return "it is truncated: the compressed data end too early";
  if (produced < needed)
    return "it is truncated: " + std::to_string(produced) + " bytes where its header needs " +
           std::to_string(needed);
  return "";
}

}  // namespace stackmesh
