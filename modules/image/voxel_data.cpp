#include "image/voxel_data.h"

#include <sys/stat.h>
#include <zlib.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <memory>

#include "base/error.h"
#include "base/warning.h"
#include "image/file_names.h"

namespace stackmesh {
namespace {

constexpr const char* again = "copy or export the file again";
constexpr std::uint64_t kRatio = 1040;  // deflate's largest, and a little
// decoded bytes behind the voxels that are looked at for the check sum
constexpr std::uint64_t kTail = std::uint64_t{16} << 20;

[[noreturn]] void damaged(const std::string& what, const std::string& path) {
  fail_input(what, path, again);
}

using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

File open_at(const DataPart& part) {
  File file(std::fopen(part.path.c_str(), "rb"), &std::fclose);
  if (!file || fseeko(file.get(), static_cast<off_t>(part.offset), SEEK_SET) != 0)
    fail_input("cannot open the file", part.path, "check that you may read it");
  return file;
}

/// "labels.mhd, slice4.raw" where the voxels are in another file than the header.
std::string where(const DataPart& part, const std::string& path) {
  return part.path == path ? path : path + ", data file " + file_name_of(part.path);
}

std::uint64_t bytes_there(const DataPart& part, const std::string& path) {
  const std::uint64_t size = size_of_file(part.path, where(part, path));
  return std::min(part.size, size > part.offset ? size - part.offset : 0);
}

[[noreturn]] void truncated(std::uint64_t have, std::uint64_t need, const std::string& place) {
  damaged("the file is truncated: " + std::to_string(have) + " bytes of voxels where its header needs " +
              std::to_string(need),
          place);
}

bool begins_as_gzip(const DataPart& part) {
  const File file = open_at(part);
  unsigned char start[2] = {};
  return std::fread(start, 1, 2, file.get()) == 2 && start[0] == 0x1f && start[1] == 0x8b;
}

VoxelEncoding encoding_of(const VoxelData& data, const DataPart& part) {
  if (data.encoding != VoxelEncoding::raw_or_gzip) return data.encoding;
  return begins_as_gzip(part) ? VoxelEncoding::deflate : VoxelEncoding::raw;
}

void read_raw(const DataPart& part, const std::string& path, unsigned char* out, std::uint64_t need) {
  DataPart at = part;
  const std::uint64_t have = bytes_there(part, path);
  if (have < part.skip + need) truncated(have > part.skip ? have - part.skip : 0, need, where(part, path));
  at.offset += part.at_end ? have - need : part.skip;
  const File file = open_at(at);
  if (std::fread(out, 1, need, file.get()) != need) damaged("the voxels cannot be read", where(part, path));
}

/// Decompresses a stream piece by piece, all of its gzip members.
class Inflater {
 public:
  Inflater(const DataPart& part, const std::string& path)
      : place_(where(part, path)), file_(open_at(part)), left_(part.size), in_(1 << 16) {
    if (inflateInit2(&stream_, 15 + 32) != Z_OK) throw std::bad_alloc();
  }
  ~Inflater() { inflateEnd(&stream_); }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;

  /// Up to `want` decoded bytes; fewer only at the end of the data.
  std::uint64_t read(unsigned char* out, std::uint64_t want) {
    std::uint64_t made = 0;
    while (made < want && !ended_) {
      if (stream_.avail_in == 0 && !refill()) break;
      if (complete_) {
        if (stream_.next_in[0] != 0x1f) {  // padding that readers ignore
          ended_ = true;
          break;
        }
        inflateReset(&stream_);  // another gzip member follows
        complete_ = false;
      }
      const std::uint64_t room = std::min<std::uint64_t>(want - made, 1u << 30);
      stream_.next_out = out + made;
      stream_.avail_out = static_cast<uInt>(room);
      const int code = inflate(&stream_, Z_NO_FLUSH);
      made += room - stream_.avail_out;
      if (code == Z_STREAM_END) complete_ = true;
      else if (code == Z_NEED_DICT)
        damaged("cannot read the voxels: they are compressed with a dictionary that is not in the file", place_);
      else if (code != Z_OK && code != Z_BUF_ERROR)
        damaged("cannot read the voxels: its compressed data are damaged", place_);
    }
    return made;
  }
  bool complete() const { return complete_; }

 private:
  bool refill() {
    const std::size_t want = static_cast<std::size_t>(std::min<std::uint64_t>(in_.size(), left_));
    stream_.next_in = in_.data();
    stream_.avail_in = static_cast<uInt>(std::fread(in_.data(), 1, want, file_.get()));
    left_ -= stream_.avail_in;
    ended_ = stream_.avail_in == 0;
    return !ended_;
  }

  const std::string place_;
  File file_;
  std::uint64_t left_;
  std::vector<unsigned char> in_;
  z_stream stream_{};
  bool complete_ = false, ended_ = false;
};

void inflate_part(const DataPart& part, const std::string& path, unsigned char* out, std::uint64_t need,
                  std::vector<Warning>& warnings) {
  Inflater stream(part, path);
  std::vector<unsigned char> rest(1 << 16);
  for (std::uint64_t left = part.skip; left > 0;) {
    const std::uint64_t got = stream.read(rest.data(), std::min<std::uint64_t>(left, rest.size()));
    if (got == 0) break;
    left -= got;
  }
  const std::uint64_t made = stream.read(out, need);
  std::uint64_t behind = 0;
  for (std::uint64_t got = 1; got > 0 && behind <= kTail; behind += got = stream.read(rest.data(), rest.size())) {
  }
  if (behind > kTail) {
    warnings.push_back(warning_at(WarningCode::left_out, where(part, path),
                                  "more data than its header says follow the voxels; they are not read, and the check "
                                  "sum at their end is not verified"));
    return;
  }
  if (!stream.complete())
    damaged("cannot read the voxels: it is truncated: the compressed data end too early", where(part, path));
  if (made < need)
    damaged("cannot read the voxels: it is truncated: " + std::to_string(made) + " bytes where its header needs " +
                std::to_string(need),
            where(part, path));
}

/// Characters of a file's stretch, one after another.
class Characters {
 public:
  explicit Characters(const DataPart& part) : file_(open_at(part)), left_(part.size) {}
  int next() {
    if (left_ == 0) return EOF;
    --left_;
    return std::getc(file_.get());
  }

 private:
  File file_;
  std::uint64_t left_;
};

template <class T>
void put(double value, const std::string& word, unsigned char* out, const std::string& place) {
  T stored{};
  if constexpr (std::is_floating_point_v<T>) {
    stored = static_cast<T>(value);
  } else {
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), stored);
    if (error != std::errc() || end != word.data() + word.size()) {  // "1.0", "1e3"
      constexpr double low = static_cast<double>(std::numeric_limits<T>::min()),
                       high = static_cast<double>(std::numeric_limits<T>::max());
      if (!(value >= low && value <= high) || value != std::floor(value) || value >= 18446744073709551616.0)
        damaged("the number '" + word.substr(0, 40) + "' does not fit the voxel type that its header names", place);
      stored = static_cast<T>(value);
    }
  }
  std::memcpy(out, &stored, sizeof stored);
}

using Put = void (*)(double, const std::string&, unsigned char*, const std::string&);

Put put_of(VoxelType type) {
  switch (type) {
    case VoxelType::u8:
      return put<std::uint8_t>;
    case VoxelType::i8:
      return put<std::int8_t>;
    case VoxelType::u16:
      return put<std::uint16_t>;
    case VoxelType::i16:
      return put<std::int16_t>;
    case VoxelType::u32:
      return put<std::uint32_t>;
    case VoxelType::i32:
      return put<std::int32_t>;
    case VoxelType::u64:
      return put<std::uint64_t>;
    case VoxelType::i64:
      return put<std::int64_t>;
    case VoxelType::f32:
      return put<float>;
    case VoxelType::f64:
      return put<double>;
  }
  fail_internal("unknown voxel type", "image module");
}

void read_text(const DataPart& part, const std::string& path, VoxelType type, unsigned char* out, std::uint64_t count) {
  const std::string place = where(part, path);
  const Put store = put_of(type);
  Characters in(part);
  std::string word;
  const auto separates = [](int c) { return c == ' ' || (c >= '\t' && c <= '\r') || c == ',' || c == EOF; };
  for (std::uint64_t i = 0; i < count; ++i) {
    word.clear();
    int c = in.next();
    while (c != EOF && separates(c)) c = in.next();
    for (; !separates(c); c = in.next())
      if (word.size() < 400) word += static_cast<char>(c);
    if (word.empty())
      damaged(
          "the file is truncated: " + std::to_string(i) + " numbers where its header needs " + std::to_string(count),
          place);
    char* end = nullptr;
    const double value = std::strtod(word.c_str(), &end);
    if (*end != '\0') damaged("'" + word.substr(0, 40) + "' where a number of the voxels belongs", place);
    store(value, word, out + i * bytes_of(type), place);
  }
}

void read_hex(const DataPart& part, const std::string& path, unsigned char* out, std::uint64_t need) {
  Characters in(part);
  for (std::uint64_t i = 0; i < 2 * need; ++i) {
    int c = in.next();
    while (c != EOF && std::isspace(c)) c = in.next();
    if (c == EOF) truncated(i / 2, need, where(part, path));
    if (!std::isxdigit(c)) damaged("a sign among the voxels is no hexadecimal digit", where(part, path));
    const int digit = c <= '9' ? c - '0' : (c | 0x20) - 'a' + 10;
    out[i / 2] = static_cast<unsigned char>(i % 2 == 0 ? digit << 4 : out[i / 2] | digit);
  }
}

void swap_bytes(unsigned char* p, std::uint64_t count, std::size_t size) {
  for (std::uint64_t i = 0; i < count; ++i, p += size) std::reverse(p, p + size);
}

std::uint64_t share_of(const VoxelData& data) {
  if (data.parts.empty() || data.count % data.parts.size() != 0)
    fail_internal("voxels in unequal parts", "image module");
  return data.count / data.parts.size();
}

}  // namespace

bool is_big_endian_machine() {
  const std::uint16_t one = 1;
  unsigned char first = 0;
  std::memcpy(&first, &one, 1);
  return first == 0;
}

std::size_t bytes_of(VoxelType type) {
  switch (type) {
    case VoxelType::u8:
    case VoxelType::i8:
      return 1;
    case VoxelType::u16:
    case VoxelType::i16:
      return 2;
    case VoxelType::u64:
    case VoxelType::i64:
    case VoxelType::f64:
      return 8;
    default:
      return 4;
  }
}

std::uint64_t size_of_file(const std::string& path, const std::string& what) {
  struct stat info;
  if (::stat(path.c_str(), &info) != 0)
    fail_input("a file is missing or cannot be read", what, "put it beside its header, and check that you may read it");
  if (!S_ISREG(info.st_mode)) fail_input("this is no regular file", what, "give a file");
  return static_cast<std::uint64_t>(info.st_size);
}

std::vector<unsigned char> read_start(const std::string& path, unsigned count, bool& compressed) {
  size_of_file(path, path);
  const gzFile file = gzopen(path.c_str(), "rb");
  if (file == nullptr) fail_input("cannot open the file", path, "check that you may read it");
  std::vector<unsigned char> bytes(count);
  const int got = gzread(file, bytes.data(), count);
  compressed = gzdirect(file) == 0;
  int code = Z_OK;
  gzerror(file, &code);
  gzclose(file);
  if (got < 0 && code == Z_DATA_ERROR) damaged("the file's compressed data are damaged", path);
  bytes.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
  return bytes;
}

namespace {

constexpr std::uint64_t kLarge = std::uint64_t{256} << 20;

/// A small stream that claims much is decoded once without keeping anything, before memory for all of it is taken.
void require_inflated(const DataPart& part, const std::string& path, std::uint64_t need) {
  Inflater stream(part, path);
  std::vector<unsigned char> piece(1 << 18);
  std::uint64_t made = 0;
  for (std::uint64_t got = 1; got > 0 && made < need; made += got = stream.read(piece.data(), piece.size())) {
  }
  if (made < need)
    damaged("cannot read the voxels: it is truncated: " + std::to_string(made) + " bytes where its header needs " +
                std::to_string(need),
            where(part, path));
}

}  // namespace

void check_voxel_data(const VoxelData& data, const std::string& path, std::vector<Warning>& warnings) {
  const std::uint64_t share = share_of(data), need = share * bytes_of(data.type);
  for (const DataPart& part : data.parts) {
    const std::uint64_t have = bytes_there(part, path);
    switch (encoding_of(data, part)) {
      case VoxelEncoding::deflate:
        if (have * kRatio + 4096 < part.skip + need)
          damaged("the file is truncated or its header is wrong: " + std::to_string(have) +
                      " compressed bytes cannot hold the " + std::to_string(part.skip + need) + " its header needs",
                  where(part, path));
        if (need > kLarge && need / 20 > have) require_inflated(part, path, part.skip + need);
        break;
      case VoxelEncoding::text:
        if (have < 2 * share - 1)
          damaged("the file is truncated: " + std::to_string(have) + " characters cannot hold the " +
                      std::to_string(share) + " numbers its header needs",
                  where(part, path));
        break;
      case VoxelEncoding::hex:
        if (have < 2 * need) truncated(have / 2, need, where(part, path));
        break;
      default:
        if (have < part.skip + need) truncated(have > part.skip ? have - part.skip : 0, need, where(part, path));
        if (part.path == path || part.at_end || have == part.skip + need) break;
        const std::string longer =
            "holds " + std::to_string(have) + " bytes where its header needs " + std::to_string(part.skip + need);
        if (data.parts.size() > 1)
          fail_input("a data file " + longer, where(part, path),
                     "correct the sizes and the type in the header, or give the length of what is in front "
                     "(HeaderSize, byte skip)");
        warnings.push_back(warning_at(WarningCode::left_out, where(part, path), longer + "; the rest is not read"));
    }
  }
}

void read_voxel_data(const VoxelData& data, const std::string& path, void* memory, std::vector<Warning>& warnings) {
  const std::uint64_t share = share_of(data), size = bytes_of(data.type);
  auto* out = static_cast<unsigned char*>(memory);
  for (const DataPart& part : data.parts) {
    const VoxelEncoding encoding = encoding_of(data, part);
    switch (encoding) {
      case VoxelEncoding::deflate:
        inflate_part(part, path, out, share * size, warnings);
        break;
      case VoxelEncoding::text:
        read_text(part, path, data.type, out, share);
        break;
      case VoxelEncoding::hex:
        read_hex(part, path, out, share * size);
        break;
      default:
        read_raw(part, path, out, share * size);
    }
    if (size > 1 && encoding != VoxelEncoding::text && data.big_endian != is_big_endian_machine())
      swap_bytes(out, share, size);
    out += share * size;
  }
}

}  // namespace stackmesh
