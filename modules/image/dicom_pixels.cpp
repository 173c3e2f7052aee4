#include "image/dicom_pixels.h"

#include <stdlib.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <optional>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/installed_part.h"
#include "base/memory.h"
#include "image/dicom_dataset.h"
#include "image/quiet.h"

namespace stackmesh {
namespace {

constexpr const char* again = "copy or export the series again";
constexpr double kMostShrunk = 20000;  // pixels a byte, of an image of one value

/// How the stored bits of a pixel make a number.
struct PixelFormat {
  int allocated = 16, stored = 16, high = 15;
  bool is_signed = false;

  double value(std::uint32_t bits) const {
    bits >>= high + 1 - stored;
    const std::uint64_t range = std::uint64_t{1} << stored;
    const std::uint64_t low = bits & (range - 1);
    return is_signed && low >= range / 2 ? static_cast<double>(low) - static_cast<double>(range)
                                         : static_cast<double>(low);
  }
};

int field(DcmDataset& data, const DcmTagKey& tag, int low, int high, int fallback, const std::string& path) {
  const double n = number_of(data, tag, path).value_or(fallback);
  if (!(n >= low && n <= high) || n != std::floor(n))
    fail_input("the image's pixels are described wrongly (" + std::string(tag.toString().c_str()) + ")", path, again);
  return static_cast<int>(n);
}

PixelFormat format_of(DcmDataset& data, const std::string& path) {
  const std::string colours = text_of(data, DCM_PhotometricInterpretation);
  if (field(data, DCM_SamplesPerPixel, 1, 4, 1, path) != 1 ||
      (!colours.empty() && colours != "MONOCHROME1" && colours != "MONOCHROME2"))
    fail_input("the image is no grey image", path, "give a series of grey values");
  PixelFormat f;
  f.allocated = field(data, DCM_BitsAllocated, 8, 32, 16, path);
  if (f.allocated % 8 != 0 || f.allocated == 24)
    fail_input("the image has " + std::to_string(f.allocated) + " bits a pixel", path,
               "store it with 8, 16 or 32 bits");
  f.stored = field(data, DCM_BitsStored, 1, f.allocated, f.allocated, path);
  f.high = field(data, DCM_HighBit, f.stored - 1, f.allocated - 1, f.stored - 1, path);
  f.is_signed = field(data, DCM_PixelRepresentation, 0, 1, 0, path) == 1;
  return f;
}

std::vector<double> decode_plain(DcmDataset& data, const PixelFormat& format, std::size_t count,
                                 const std::string& path) {
  DcmElement* element = nullptr;
  if (data.findAndGetElement(DCM_PixelData, element).bad() || element == nullptr)
    fail_input("the image has no pixel data", path, again);
  const std::size_t size = static_cast<std::size_t>(format.allocated) / 8, have = element->getLength();
  if (have < count * size)
    fail_input("the image is damaged or truncated: " + std::to_string(have) +
                   " bytes of pixels where its header needs " + std::to_string(count * size),
               path, again);
  Uint8* bytes = nullptr;
  Uint16* words = nullptr;
  const unsigned char* raw = nullptr;
  if (element->getUint8Array(bytes).good() && bytes != nullptr) raw = bytes;
  else if (element->getUint16Array(words).good() && words != nullptr) raw = reinterpret_cast<unsigned char*>(words);
  else fail_input("the image's pixel data cannot be read", path, again);
  std::vector<double> values(count);
  for (std::size_t i = 0; i < count; ++i) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, raw + i * size, size);
    values[i] = format.value(bits);
  }
  return values;
}

/// A file that is removed at the end.
class TemporaryFile {
 public:
  TemporaryFile() {
    std::error_code error;
    const std::filesystem::path folder = std::filesystem::temp_directory_path(error);
    const char* const asked = std::getenv("TMPDIR");
    path_ = ((error ? std::filesystem::path(asked != nullptr ? asked : "/tmp") : folder) / "stackmesh_XXXXXX").string();
    const int handle = error ? -1 : ::mkstemp(path_.data());
    if (handle < 0)
      fail_output("no temporary file can be made", path_,
                  "free some space there, or set TMPDIR to a folder that you may write to");
    ::close(handle);
    guard_.emplace(path_);
  }
  ~TemporaryFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
  std::optional<RemovedOnSignals> guard_;
};

std::vector<double> decode_with_gdcm(const std::string& path, std::size_t count) {
  using Decode = int(const char*, std::size_t, double*);
  const auto decode = reinterpret_cast<Decode*>(
      function_of_part("stackmesh-gdcm", "stackmesh_decode_with_gdcm", "compressed DICOM images"));
  const Quiet quiet;
  std::vector<double> values(count);
  if (decode(path.c_str(), count, values.data()) != 0) throw std::runtime_error("GDCM cannot decode it");
  return values;
}

/// Compressed pixels, in a file that holds them and what describes them.
std::vector<double> decode_compressed(DcmFileFormat& file, std::size_t count, const std::string& path) {
  DcmDataset& data = *file.getDataset();
  std::error_code ignored;
  const auto there = static_cast<double>(std::filesystem::file_size(path, ignored));
  if (static_cast<double>(count) > kMostShrunk * there + (1 << 20))
    fail_input("the image is damaged or truncated: " + std::to_string(count) + " pixels in a file of " +
                   std::to_string(static_cast<std::uint64_t>(there)) + " bytes",
               path, again);
  require_memory(10 * count, "the pixels of a slice", path, "crop the series");
  const TemporaryFile alone;
  try {
    DcmFileFormat bare;
    for (const DcmTagKey& tag :
         {DCM_Rows, DCM_Columns, DCM_SamplesPerPixel, DCM_PhotometricInterpretation, DCM_BitsAllocated, DCM_BitsStored,
          DCM_HighBit, DCM_PixelRepresentation, DCM_PixelData}) {
      DcmElement* element = nullptr;
      if (data.findAndGetElement(tag, element).bad() || element == nullptr)
        throw std::invalid_argument("a field is missing");
      bare.getDataset()->insert(dynamic_cast<DcmElement*>(element->clone()), OFTrue);
    }
    bare.getDataset()->putAndInsertString(DCM_SOPClassUID, UID_SecondaryCaptureImageStorage);
    bare.getDataset()->putAndInsertString(DCM_SOPInstanceUID, "1.2.3");
    if (bare.saveFile(alone.path().c_str(), data.getOriginalXfer()).bad())
      throw std::runtime_error("cannot be written");
    return decode_with_gdcm(alone.path(), count);
  } catch (const Error&) {
    throw;
  } catch (const std::exception&) {
    fail_input(
        "the image is damaged, or its pixels are stored as " + transfer_syntax_of(file) + ", which cannot be decoded",
        path, "convert it to an uncompressed transfer syntax, with gdcmconv --raw or dcmdjpeg");
  }
}

}  // namespace

std::vector<double> DicomPixels::rescaled() {
  if (is_scaled())
    for (double& v : stored) v = v * slope + intercept;
  return std::move(stored);
}

DicomPixels read_dicom_pixels(const std::string& path, int rows, int columns) {
  const auto file = load_dicom(path);
  DcmDataset& data = *file->getDataset();
  const PixelFormat format = format_of(data, path);
  const std::size_t count = static_cast<std::size_t>(rows) * columns;
  DicomPixels pixels;
  pixels.slope = number_of(data, DCM_RescaleSlope, path).value_or(1);
  pixels.intercept = number_of(data, DCM_RescaleIntercept, path).value_or(0);
  pixels.stored = DcmXfer(data.getOriginalXfer()).isEncapsulated() ? decode_compressed(*file, count, path)
                                                                   : decode_plain(data, format, count, path);
  return pixels;
}

}  // namespace stackmesh
