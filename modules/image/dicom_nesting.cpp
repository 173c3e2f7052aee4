#include "image/dicom_nesting.h"

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dctk.h>
#include <zlib.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace stackmesh {
namespace {

constexpr std::uint32_t kUndefined = 0xffffffffu;

/// Bytes one after another, of a file or of the raw deflate stream that its data set may be.
class Bytes {
 public:
  explicit Bytes(const std::string& path)
      : file_(std::fopen(path.c_str(), "rb"), [](std::FILE* f) { return f == nullptr ? 0 : std::fclose(f); }) {}
  ~Bytes() {
    if (deflated_) inflateEnd(&stream_);
  }
  Bytes(const Bytes&) = delete;
  Bytes& operator=(const Bytes&) = delete;
  bool is_open() const { return file_ != nullptr; }
  std::uint64_t position() const { return position_; }

  bool read(unsigned char* to, std::size_t count) {
    const std::size_t got = deflated_ ? inflated(to, count) : std::fread(to, 1, count, file_.get());
    position_ += got;
    return got == count;
  }
  bool skip(std::uint64_t count) {
    if (!deflated_) {
      position_ += count;
      return fseeko(file_.get(), static_cast<off_t>(std::min<std::uint64_t>(count, 1u << 31)), SEEK_CUR) == 0 &&
             count <= (1u << 31);
    }
    unsigned char rest[4096];
    for (; count > 0; count -= std::min<std::uint64_t>(count, sizeof rest))
      if (!read(rest, static_cast<std::size_t>(std::min<std::uint64_t>(count, sizeof rest)))) return false;
    return true;
  }
  /// Goes back by bytes that were read last.
  void skip_back(std::size_t count) {
    fseeko(file_.get(), -static_cast<off_t>(count), SEEK_CUR);
    position_ -= count;
  }
  /// What follows is a raw deflate stream.
  void inflate_rest() { deflated_ = inflateInit2(&stream_, -15) == Z_OK; }

 private:
  std::size_t inflated(unsigned char* to, std::size_t count) {
    stream_.next_out = to;
    stream_.avail_out = static_cast<uInt>(count);
    while (stream_.avail_out > 0) {
      if (stream_.avail_in == 0) {
        stream_.next_in = in_;
        stream_.avail_in = static_cast<uInt>(std::fread(in_, 1, sizeof in_, file_.get()));
        if (stream_.avail_in == 0) break;
      }
      if (inflate(&stream_, Z_NO_FLUSH) != Z_OK) break;
    }
    return count - stream_.avail_out;
  }

  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_;
  std::uint64_t position_ = 0;
  bool deflated_ = false;
  z_stream stream_{};
  unsigned char in_[1 << 14];
};

class NestingReader {
 public:
  explicit NestingReader(const std::string& path) : in_(path) {}

  int run() {
    if (!in_.is_open()) return 0;
    unsigned char start[132];
    const bool marked = in_.read(start, sizeof start) && std::memcmp(start + 128, "DICM", 4) == 0;
    if (!marked) return 0;  // a bare data set: see below
    if (!read_meta()) return 0;
    while (deepest_ <= kDeepest && read_element()) {
    }
    return deepest_;
  }

  /// A data set without preamble and meta header.
  int run_bare() {
    if (!in_.is_open()) return 0;
    guess_explicit();
    while (deepest_ <= kDeepest && read_element()) {
    }
    return deepest_;
  }

 private:
  struct Open {
    enum Kind { sequence, item, fragments } kind = sequence;
    std::uint64_t end = 0;  // all ones: at its delimiter
    bool implicit = false;
  };

  std::uint32_t number(const unsigned char* p, int bytes) const {
    std::uint32_t value = 0;
    for (int i = 0; i < bytes; ++i) value |= static_cast<std::uint32_t>(p[big_ ? bytes - 1 - i : i]) << (8 * i);
    return value;
  }

  /// The meta header, explicit and little-endian, tells how the rest is stored.
  bool read_meta() {
    std::string syntax;
    while (true) {
      unsigned char head[8], more[4];
      if (!peek(head)) return false;
      if (number(head, 2) != 2) break;
      pending_ = 0;
      std::uint32_t length = number(head + 6, 2);
      if (is_long(head + 4)) {
        if (!in_.read(more, 4)) return false;
        length = number(more, 4);
      }
      if (length > (1u << 20)) return false;
      std::string value(length, '\0');
      if (!in_.read(reinterpret_cast<unsigned char*>(value.data()), length)) return false;
      if (number(head + 2, 2) == 0x10) syntax = value.c_str();
    }
    while (!syntax.empty() && syntax.back() == ' ') syntax.pop_back();
    implicit_ = syntax == "1.2.840.10008.1.2";
    big_ = syntax == "1.2.840.10008.1.2.2";
    if (syntax == "1.2.840.10008.1.2.1.99") {  // deflated: the bytes that were looked at belong to the stream
      in_.skip_back(pending_);
      pending_ = 0;
      in_.inflate_rest();
    }
    return true;
  }

  /// Eight bytes that are read once and taken by the next read_bytes().
  bool peek(unsigned char* head) {
    if (pending_ == 0) {
      if (!in_.read(kept_, 8)) return false;
      pending_ = 8;
    }
    std::memcpy(head, kept_, 8);
    return true;
  }
  void guess_explicit() {
    unsigned char head[8];
    implicit_ = !peek(head) || !std::isupper(head[4]) || !std::isupper(head[5]);
  }

  static bool is_long(const unsigned char* vr) {
    static const char* const longs[] = {"OB", "OW", "OF", "OD", "OL", "OV", "UN", "UT", "UC", "UR", "SQ", "SV", "UV"};
    static const char* const shorts[] = {"AE", "AS", "AT", "CS", "DA", "DS", "DT", "FL", "FD", "IS", "LO",
                                         "LT", "PN", "SH", "SL", "SS", "ST", "TM", "UI", "UL", "US"};
    const auto is = [&](const char* name) { return vr[0] == name[0] && vr[1] == name[1]; };
    if (std::any_of(std::begin(longs), std::end(longs), is)) return true;
    return std::isupper(vr[0]) && std::isupper(vr[1]) && !std::any_of(std::begin(shorts), std::end(shorts), is);
  }

  bool open(Open::Kind kind, std::uint32_t length, bool implicit) {
    open_.push_back(
        {kind, length == kUndefined ? std::numeric_limits<std::uint64_t>::max() : in_.position() + length, implicit});
    if (kind == Open::sequence) deepest_ = std::max(deepest_, ++sequences_);
    return true;
  }
  void close() {
    if (open_.empty()) return;
    if (open_.back().kind == Open::sequence) --sequences_;
    open_.pop_back();
  }

  bool read_element() {
    while (!open_.empty() && in_.position() - pending_ >= open_.back().end) close();
    unsigned char head[8];
    if (!peek(head)) return false;
    pending_ = 0;
    const auto group = static_cast<std::uint16_t>(number(head, 2)),
               element = static_cast<std::uint16_t>(number(head + 2, 2));
    if (group == 0xfffe) {
      const std::uint32_t length = number(head + 4, 4);
      if (element == 0xe000) {
        if (!open_.empty() && open_.back().kind == Open::fragments) return length != kUndefined && in_.skip(length);
        return open(Open::item, length, open_.empty() ? implicit_ : open_.back().implicit);
      }
      close();
      return true;
    }
    const bool implicit = open_.empty() ? implicit_ : open_.back().implicit;
    std::uint32_t length = number(head + 4, 4);
    std::string vr;
    if (!implicit) {
      vr.assign(reinterpret_cast<const char*>(head + 4), 2);
      length = number(head + 6, 2);
      unsigned char more[4];
      if (is_long(head + 4)) {
        if (!in_.read(more, 4)) return false;
        length = number(more, 4);
      }
    }
    if (group == 0x7fe0 && element == 0x10 && length == kUndefined) return open(Open::fragments, length, implicit);
    const bool by_dictionary = (implicit || vr == "UN") && DcmTag(group, element).getEVR() == EVR_SQ;
    if (vr == "SQ" || length == kUndefined || by_dictionary)
      return open(Open::sequence, length, implicit || vr == "UN");
    return in_.skip(length);
  }

  Bytes in_;
  bool implicit_ = false, big_ = false;
  unsigned char kept_[8] = {};
  std::size_t pending_ = 0;
  std::vector<Open> open_;
  int sequences_ = 0, deepest_ = 0;
};

}  // namespace

int dicom_nesting(const std::string& path) {
  const int depth = NestingReader(path).run();
  return depth > 0 ? depth : NestingReader(path).run_bare();
}

}  // namespace stackmesh
