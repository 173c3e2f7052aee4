#include <png.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <csetjmp>
#include <cstring>
#include <new>

#include "base/error.h"
#include "base/memory.h"
#include "image/slice_image.h"

namespace stackmesh {
namespace {

constexpr png_uint_32 kLargestSide = 1000000;

[[noreturn]] void damaged(const std::string& what, const std::string& path) {
  fail_input("the PNG file is " + what, path, "copy or export the file again");
}

/// What is wrong with the chunks of a file that libpng refuses; "": nothing.
std::string fault_of_chunks(const std::vector<unsigned char>& bytes) {
  for (std::size_t at = 8;;) {
    if (bytes.size() - at < 12) return "truncated";
    const std::size_t length = png_get_uint_32(&bytes[at]);
    if (bytes.size() - at - 12 < length) return "truncated";
    const unsigned char* type = &bytes[at + 4];
    if (::crc32(0, type, static_cast<uInt>(length + 4)) != png_get_uint_32(type + 4 + length))
      return "damaged (check sum)";
    if (at == 8 && (length != 13 || std::memcmp(type, "IHDR", 4) != 0)) return "damaged (no header)";
    if (std::memcmp(type, "IEND", 4) == 0) return "";
    at += 12 + length;
  }
}

/// What libpng's functions share with ours. It is plain data, because an error leaves them by longjmp, which destroys
/// no objects.
struct PngState {
  const unsigned char* next;
  std::size_t left;
  unsigned char* pixels = nullptr;  ///< the first row, while rows are read
  std::size_t row_bytes = 0;
  bool bad_header = false;
  bool too_few = false;  ///< the pixel stream ends before the last row
  bool bad_end = false;  ///< the pixel stream is damaged behind the last row
};

PngState& state_of(png_structp png) {
  return *static_cast<PngState*>(png_get_error_ptr(png));
}

void give_bytes(png_structp png, png_bytep out, std::size_t count) {
  PngState& state = state_of(png);
  if (count > state.left) png_error(png, "the file ends");
  std::memcpy(out, state.next, count);
  state.next += count;
  state.left -= count;
}

/// Every error ends the decoding. Its text only chooses what our message says of the damage.
[[noreturn]] void on_error(png_structp png, png_const_charp text) {
  PngState& state = state_of(png);
  const auto says = [&](const char* part) { return std::strstr(text, part) != nullptr; };
  state.bad_header = says("Invalid IHDR data");
  state.too_few = says("Not enough image data") || says("IEND: out of place");
  png_longjmp(png, 1);
}

/// libpng only warns where the pixel stream is damaged behind the last row, which is where its check sum is. More data
/// than the rows need is no damage.
void on_warning(png_structp png, png_const_charp text) {
  PngState& state = state_of(png);
  if (state.pixels != nullptr && std::strstr(text, "Too much image data") == nullptr &&
      std::strstr(text, "Extra compressed data") == nullptr)
    state.bad_end = true;
}

/// Reads up to the pixels. All check sums must be right; what chunks of profiles, texts and times hold is not looked
/// at.
void read_header(png_structp png, png_infop info) {
  png_set_user_limits(png, kLargestSide, kLargestSide);
  png_set_benign_errors(png, 1);
  png_set_crc_action(png, PNG_CRC_ERROR_QUIT, PNG_CRC_ERROR_QUIT);
  png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_NEVER, nullptr, -1);
  png_set_option(png, PNG_MAXIMUM_INFLATE_WINDOW, PNG_OPTION_ON);  // some files declare a smaller one than they need
  png_read_info(png, info);
}

/// Chooses numbers as they are stored: those of fewer than 8 bits as a byte each, not stretched, and those of 16 bits
/// in this machine's byte order.
void choose_numbers(png_structp png, png_infop info) {
  png_set_packing(png);
  if (!is_big_endian_machine()) png_set_swap(png);
  png_set_interlace_handling(png);
  png_read_update_info(png, info);
}

/// Reads all rows, and the chunks behind them.
void read_pixels(png_structp png, png_infop info) {
  PngState& state = state_of(png);
  const int passes = png_get_interlace_type(png, info) == PNG_INTERLACE_ADAM7 ? PNG_INTERLACE_ADAM7_PASSES : 1;
  const png_uint_32 height = png_get_image_height(png, info);
  for (int pass = 0; pass < passes; ++pass)
    for (png_uint_32 y = 0; y < height; ++y) png_read_row(png, state.pixels + y * state.row_bytes, nullptr);
  state.pixels = nullptr;
  png_read_end(png, nullptr);
}

/// Runs one of the three functions above. This is the one place that libpng's longjmp comes back to: neither it nor
/// they hold an object that needs destruction. false: libpng called on_error.
bool succeeds(void (*step)(png_structp, png_infop), png_structp png, png_infop info) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  step(png, info);
  return true;
}

class PngReader {
 public:
  PngReader(const std::vector<unsigned char>& bytes, const std::string& path)
      : bytes_(bytes), path_(path), state_{bytes.data(), bytes.size()} {
    png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, &state_, on_error, on_warning);
    if (png_ != nullptr) info_ = png_create_info_struct(png_);
    if (info_ == nullptr) {
      png_destroy_read_struct(&png_, nullptr, nullptr);
      throw std::bad_alloc();
    }
    png_set_read_fn(png_, nullptr, give_bytes);
  }
  ~PngReader() { png_destroy_read_struct(&png_, &info_, nullptr); }
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;

  SliceImage run() {
    const bool read = succeeds(read_header, png_, info_);
    if (png_get_color_type(png_, info_) == PNG_COLOR_TYPE_PALETTE)
      fail_input("the PNG has a colour palette, so its pixels are colours and not label numbers", path_,
                 "save it as 8- or 16-bit greyscale with the label as grey value");
    const png_uint_32 width = png_get_image_width(png_, info_), height = png_get_image_height(png_, info_);
    if (state_.bad_header && (width > kLargestSide || height > kLargestSide || width == 0 || height == 0))
      damaged("damaged (size in its header)", path_);
    if (state_.bad_header) damaged("damaged (header)", path_);
    if (!read) refuse("damaged (header)");
    image_.width = width;
    image_.height = height;
    number_bytes_ = png_get_bit_depth(png_, info_) == 16 ? 2 : 1;
    image_.type = number_bytes_ == 2 ? VoxelType::u16 : VoxelType::u8;
    samples_ = png_get_channels(png_, info_);
    // Deflate cannot shrink data more than about 1032 times.
    const double row = std::ceil(static_cast<double>(image_.width) * samples_ * png_get_bit_depth(png_, info_) / 8);
    if (row * static_cast<double>(image_.height) > 1040.0 * static_cast<double>(bytes_.size()) + 4096)
      refuse("damaged or truncated (too few pixels)");
    if (!succeeds(choose_numbers, png_, info_)) damaged("damaged (header)", path_);
    decode();
    return std::move(image_);
  }

 private:
  /// @param what is said where the chunks are whole
  [[noreturn]] void refuse(const std::string& what) const {
    const std::string chunks = fault_of_chunks(bytes_);
    damaged(!chunks.empty() ? chunks : state_.too_few ? "damaged or truncated (too few pixels)" : what, path_);
  }

  void decode() {
    const std::size_t count = image_.width * image_.height;
    state_.row_bytes = image_.width * static_cast<std::size_t>(samples_) * number_bytes_;
    const std::size_t all = state_.row_bytes * image_.height, grey = count * number_bytes_;
    require_memory(samples_ == 1 ? grey : all + grey,
                   "a slice of " + std::to_string(image_.width) + " x " + std::to_string(image_.height) + " pixels",
                   path_, "crop it");
    image_.values.resize(grey);
    std::vector<unsigned char> colours(samples_ == 1 ? 0 : all);
    unsigned char* const pixels = samples_ == 1 ? image_.values.data() : colours.data();
    state_.pixels = pixels;
    const bool read = succeeds(read_pixels, png_, info_);
    if (!read || state_.bad_end) refuse("damaged (pixels)");
    if (samples_ == 1) return;
    for (std::uint64_t y = 0; y < image_.height; ++y)
      take_grey(pixels + y * state_.row_bytes, image_.width, samples_, samples_ == 2 ? 1 : 3, number_bytes_, y,
                image_.values.data() + y * image_.width * number_bytes_, path_);
  }

  const std::vector<unsigned char>& bytes_;
  const std::string& path_;
  PngState state_;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
  SliceImage image_;
  int samples_ = 1;
  std::size_t number_bytes_ = 1;
};

}  // namespace

void take_grey(const unsigned char* pixels, std::uint64_t count, int samples, int colours, std::size_t bytes,
               std::uint64_t row, unsigned char* out, const std::string& where) {
  const std::size_t pixel = static_cast<std::size_t>(samples) * bytes;
  for (std::uint64_t x = 0; x < count; ++x) {
    const unsigned char* p = pixels + x * pixel;
    for (int c = 1; c < colours; ++c)
      if (std::memcmp(p, p + static_cast<std::size_t>(c) * bytes, bytes) != 0)
        fail_input("the slice is a colour image",
                   where + ", pixel (" + std::to_string(x) + ", " + std::to_string(row) + ")",
                   "save it as 8- or 16-bit greyscale with the label as grey value");
    std::memcpy(out + x * bytes, p, bytes);
  }
}

SliceImage read_png(const std::vector<unsigned char>& bytes, const std::string& path) {
  if (bytes.size() > 3 && bytes[0] == 0xff && bytes[1] == 0xd8 && bytes[2] == 0xff)
    fail_input("this is a JPEG file, whose compression changes label numbers", path,
               "export the labels as PNG or TIFF");
  if (bytes.size() < 8 || png_sig_cmp(bytes.data(), 0, 8) != 0)
    fail_input("this is no PNG file, or it is damaged", path, "copy or export the file again");
  return PngReader(bytes, path).run();
}

}  // namespace stackmesh
