#include <tiffio.h>

#include <cmath>
#include <cstring>
#include <memory>

#include "base/error.h"
#include "base/memory.h"
#include "base/warning.h"
#include "image/slice_image.h"

namespace stackmesh {
namespace {

constexpr const char* again = "copy or export the file again";

/// Silences libtiff, whose handlers are global.
class SilentTiff {
 public:
  SilentTiff() : error_(TIFFSetErrorHandler(nullptr)), warning_(TIFFSetWarningHandler(nullptr)) {}
  ~SilentTiff() {
    TIFFSetErrorHandler(error_);
    TIFFSetWarningHandler(warning_);
  }
  SilentTiff(const SilentTiff&) = delete;
  SilentTiff& operator=(const SilentTiff&) = delete;

 private:
  TIFFErrorHandler error_, warning_;
};

/// The most that a compression can shrink data.
double ratio_of(int compression) {
  switch (compression) {
    case COMPRESSION_NONE:
      return 1;
    case COMPRESSION_PACKBITS:
      return 70;
    case COMPRESSION_DEFLATE:
    case COMPRESSION_ADOBE_DEFLATE:
      return 1040;
    case COMPRESSION_LZW:
      return 4096;
    default:
      return 100000;
  }
}

class TiffPage {
 public:
  TiffPage(TIFF* file, double file_size, const std::string& name) : file_(file), name_(name) {
    TIFFGetField(file_, TIFFTAG_IMAGEWIDTH, &width_);
    TIFFGetField(file_, TIFFTAG_IMAGELENGTH, &height_);
    TIFFGetFieldDefaulted(file_, TIFFTAG_BITSPERSAMPLE, &bits_);
    TIFFGetFieldDefaulted(file_, TIFFTAG_SAMPLESPERPIXEL, &samples_);
    TIFFGetFieldDefaulted(file_, TIFFTAG_SAMPLEFORMAT, &format_);
    TIFFGetFieldDefaulted(file_, TIFFTAG_PLANARCONFIG, &planar_);
    TIFFGetFieldDefaulted(file_, TIFFTAG_COMPRESSION, &compression_);
    if (TIFFGetField(file_, TIFFTAG_PHOTOMETRIC, &photometric_) != 1) photometric_ = PHOTOMETRIC_MINISBLACK;
    if (width_ == 0 || height_ == 0 || width_ > 1000000 || height_ > 1000000) damaged();
    choose_type();
    const double need = std::ceil(double(width_) * samples_ * bits_ / 8) * height_;
    if (need > ratio_of(compression_) * file_size + 65536) damaged();
    if (TIFFIsCODECConfigured(compression_) == 0)
      fail_input("the TIFF's compression (number " + std::to_string(compression_) + ") is not supported", name_,
                 "save it with LZW, deflate or no compression");
    require_memory(static_cast<std::uint64_t>(need) + std::uint64_t{width_} * height_ * bytes_of(image_.type),
                   "a slice of " + std::to_string(width_) + " x " + std::to_string(height_) + " pixels", name_,
                   "crop it");
  }

  SliceImage run() {
    image_.width = width_;
    image_.height = height_;
    image_.values.resize(std::size_t{width_} * height_ * bytes_of(image_.type));
    if (TIFFIsTiled(file_)) read_tiles();
    else read_rows();
    return std::move(image_);
  }

 private:
  [[noreturn]] void damaged() const { fail_input("the TIFF file is damaged or truncated", name_, again); }

  void choose_type() {
    const bool grey = photometric_ == PHOTOMETRIC_MINISBLACK || photometric_ == PHOTOMETRIC_MINISWHITE ||
                      photometric_ == PHOTOMETRIC_PALETTE;
    if (!grey && photometric_ != PHOTOMETRIC_RGB)
      fail_input("the slice is a colour image (photometric tag " + std::to_string(photometric_) + ")", name_,
                 "save it as 8- or 16-bit greyscale with the label as grey value");
    if (samples_ < 1 || samples_ > 16) damaged();
    colours_ = photometric_ == PHOTOMETRIC_RGB ? std::min<int>(samples_, 3) : 1;
    const bool whole = format_ == SAMPLEFORMAT_UINT || format_ == SAMPLEFORMAT_INT || format_ == SAMPLEFORMAT_VOID,
               real = format_ == SAMPLEFORMAT_IEEEFP, is_signed = format_ == SAMPLEFORMAT_INT;
    if (whole && bits_ >= 1 && bits_ < 8 && !is_signed) image_.type = VoxelType::u8;
    else if (whole && bits_ == 8) image_.type = is_signed ? VoxelType::i8 : VoxelType::u8;
    else if (whole && bits_ > 8 && bits_ < 16 && !is_signed) image_.type = VoxelType::u16;
    else if (whole && bits_ == 16) image_.type = is_signed ? VoxelType::i16 : VoxelType::u16;
    else if (whole && bits_ == 32) image_.type = is_signed ? VoxelType::i32 : VoxelType::u32;
    else if (whole && bits_ == 64) image_.type = is_signed ? VoxelType::i64 : VoxelType::u64;
    else if (real && bits_ == 32) image_.type = VoxelType::f32;
    else if (real && bits_ == 64) image_.type = VoxelType::f64;
    else
      fail_input("pixels of " + std::to_string(bits_) + " bits as " +
                     (real        ? "floating point"
                      : is_signed ? "signed whole"
                      : whole     ? "whole"
                                  : "complex") +
                     " numbers are not read from TIFF",
                 name_, "save it with 8, 16 or 32 bits a pixel");
    if (bits_ % 8 != 0 && samples_ != 1)
      fail_input("the slice is a colour image of " + std::to_string(bits_) + " bits", name_,
                 "save it as 8- or 16-bit greyscale with the label as grey value");
  }

  /// Puts `count` pixels of a decoded row to (x, y). `row` holds every sample, or one plane.
  void put(const unsigned char* row, std::uint32_t x, std::uint32_t y, std::uint32_t count, int plane) {
    const std::size_t bytes = bytes_of(image_.type);
    unsigned char* out = image_.values.data() + (std::size_t{y} * width_ + x) * bytes;
    if (bits_ % 8 != 0) {  // packed, the highest bit first
      for (std::uint32_t i = 0; i < count; ++i) {
        std::uint32_t value = 0;
        for (std::uint64_t bit = std::uint64_t{i} * bits_, end = bit + bits_; bit < end; ++bit)
          value = value << 1 | (row[bit / 8] >> (7 - bit % 8) & 1u);
        const auto two = static_cast<std::uint16_t>(value);
        if (bytes == 1) out[i] = static_cast<unsigned char>(value);
        else std::memcpy(out + 2 * std::size_t{i}, &two, 2);
      }
    } else if (planar_ == PLANARCONFIG_CONTIG && samples_ > 1) {
      take_grey(row, count, samples_, colours_, bytes, y, out, name_);
    } else if (plane == 0) {
      std::memcpy(out, row, std::size_t{count} * bytes);
    } else if (plane < colours_) {
      for (std::uint32_t i = 0; i < count; ++i)
        if (std::memcmp(out + i * bytes, row + i * bytes, bytes) != 0)
          fail_input("the slice is a colour image",
                     name_ + ", pixel (" + std::to_string(x + i) + ", " + std::to_string(y) + ")",
                     "save it as 8- or 16-bit greyscale with the label as grey value");
    }
  }

  int planes() const { return planar_ == PLANARCONFIG_SEPARATE ? colours_ : 1; }
  std::size_t row_bytes(std::uint32_t columns) const {
    return (std::size_t{columns} * (planar_ == PLANARCONFIG_SEPARATE ? 1u : samples_) * bits_ + 7) / 8;
  }

  void read_rows() {
    const tmsize_t size = TIFFScanlineSize(file_);
    if (size <= 0 || static_cast<std::size_t>(size) < row_bytes(width_)) damaged();
    std::vector<unsigned char> row(static_cast<std::size_t>(size));
    for (int plane = 0; plane < planes(); ++plane)
      for (std::uint32_t y = 0; y < height_; ++y) {
        if (TIFFReadScanline(file_, row.data(), y, static_cast<std::uint16_t>(plane)) != 1) damaged();
        put(row.data(), 0, y, width_, plane);
      }
  }

  void read_tiles() {
    std::uint32_t tile_width = 0, tile_height = 0;
    TIFFGetField(file_, TIFFTAG_TILEWIDTH, &tile_width);
    TIFFGetField(file_, TIFFTAG_TILELENGTH, &tile_height);
    const tmsize_t size = TIFFTileSize(file_), row = TIFFTileRowSize(file_);
    if (tile_width == 0 || tile_height == 0 || tile_width > 65536 || tile_height > 65536 || size <= 0 || row <= 0 ||
        static_cast<std::size_t>(row) < row_bytes(tile_width) ||
        static_cast<double>(size) < static_cast<double>(row) * tile_height)
      damaged();
    require_memory(static_cast<std::uint64_t>(size), "a tile of the slice", name_, "save it with smaller tiles");
    std::vector<unsigned char> tile(static_cast<std::size_t>(size));
    for (int plane = 0; plane < planes(); ++plane)
      for (std::uint32_t y = 0; y < height_; y += tile_height)
        for (std::uint32_t x = 0; x < width_; x += tile_width) {
          if (TIFFReadTile(file_, tile.data(), x, y, 0, static_cast<std::uint16_t>(plane)) < 0) damaged();
          for (std::uint32_t r = 0; r < tile_height && y + r < height_; ++r)
            put(tile.data() + static_cast<std::size_t>(row) * r, x, y + r, std::min(tile_width, width_ - x), plane);
        }
  }

  TIFF* const file_;
  const std::string name_;
  std::uint32_t width_ = 0, height_ = 0;
  std::uint16_t bits_ = 1, samples_ = 1, format_ = SAMPLEFORMAT_UINT, planar_ = PLANARCONFIG_CONTIG,
                compression_ = COMPRESSION_NONE, photometric_ = PHOTOMETRIC_MINISBLACK;
  int colours_ = 1;
  SliceImage image_;
};

}  // namespace

void read_tiff(const std::string& path, std::vector<Warning>& warnings,
               const std::function<void(SliceImage&&, int, bool)>& page) {
  const SilentTiff silent;
  const auto size = static_cast<double>(size_of_file(path, path));
  const std::unique_ptr<TIFF, void (*)(TIFF*)> file(TIFFOpen(path.c_str(), "rm"), TIFFClose);
  if (!file) fail_input("this is no TIFF file, or it is damaged or truncated", path, again);
  bool several = TIFFLastDirectory(file.get()) == 0, reduced = false;
  for (int number = 1;; ++number) {
    const std::string name = several ? path + ", page " + std::to_string(number) : path;
    std::uint32_t kind = 0;
    TIFFGetFieldDefaulted(file.get(), TIFFTAG_SUBFILETYPE, &kind);
    if ((kind & FILETYPE_REDUCEDIMAGE) != 0 && number > 1) reduced = true;
    else page(TiffPage(file.get(), size, name).run(), number, several);
    if (TIFFLastDirectory(file.get()) != 0) break;
    if (TIFFReadDirectory(file.get()) != 1)
      fail_input("the TIFF file is damaged or truncated", path + ", page " + std::to_string(number + 1), again);
    several = true;
  }
  if (reduced)
    warnings.push_back(warning_at(WarningCode::left_out, path, "pages that are smaller copies of others are left out"));
}

}  // namespace stackmesh
