#include "image/volume_file.h"

#include <itkGiplImageIO.h>
#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>
#include <nifti1_io.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <memory>
#include <sstream>

#include "base/error.h"
#include "base/parallel.h"
#include "base/text.h"
#include "image/deflate_check.h"
#include "image/palette.h"
#include "image/segments.h"
#include "image/quiet.h"
#include "image/volume_header.h"

namespace stackmesh {
namespace {

constexpr const char* again = "copy or export the file again";

/// Asked for x.nii.gz, niftilib takes the voxels of an x.nii or x.img that lies beside it. Where there is
/// one, the file is read through a link in a folder of its own.
class AloneNifti {
 public:
  explicit AloneNifti(const std::string& path) : path_(path) {
    const std::string name = lower_case(path);
    const std::string base = path.substr(0, path.size() - (name.back() == 'z' ? 7 : 4));
    const bool crowded = [&] {
      for (const char* ending : {".nii", ".nii.gz", ".hdr", ".hdr.gz", ".img", ".img.gz", ".nia"}) {
        std::string upper = ending;
        for (char& c : upper) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
        for (const std::string& other : {base + ending, base + upper})
          if (other != path && std::filesystem::exists(other)) return true;
      }
      return false;
    }();
    if (!crowded) return;
    std::string folder = (std::filesystem::temp_directory_path() / "stackmesh-XXXXXX").string();
    if (::mkdtemp(folder.data()) == nullptr)
      fail_input("no temporary folder can be made, which reading this file beside others of its name needs",
                 path, "rename the file, or set TMPDIR to a folder that you may write to");
    folder_ = folder;
    path_ = folder + (name.back() == 'z' ? "/volume.nii.gz" : "/volume.nii");
    std::filesystem::create_symlink(std::filesystem::absolute(path), path_);
  }
  ~AloneNifti() {
    std::error_code ignored;
    if (!folder_.empty()) std::filesystem::remove_all(folder_, ignored);
  }
  AloneNifti(const AloneNifti&) = delete;
  AloneNifti& operator=(const AloneNifti&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_, folder_;
};

itk::ImageIOBase::Pointer make_reader(FileFormat format) {
  switch (format) {
    case FileFormat::nifti:
      return itk::NiftiImageIO::New().GetPointer();
    case FileFormat::nrrd:
      return itk::NrrdImageIO::New().GetPointer();
    case FileFormat::gipl:
      return itk::GiplImageIO::New().GetPointer();
    default:
      return itk::MetaImageIO::New().GetPointer();
  }
}

const char* kind_of(FileFormat format) {
  switch (format) {
    case FileFormat::nifti:
      return "nifti";
    case FileFormat::nrrd:
      return "nrrd";
    case FileFormat::gipl:
      return "gipl";
    default:
      return "metaimage";
  }
}

/// The nearest orthonormal axes to nearly orthonormal ones (headers carry rounded cosines).
/// @throws Error(input) where they are off by more than 1e-4.
std::array<Vec3, 3> orthonormal(std::array<Vec3, 3> a, const std::string& path) {
  double worst = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j <= i; ++j) {
      const double error = std::abs(dot(a[i], a[j]) - (i == j ? 1 : 0));
      worst = error <= worst ? worst : error;  // keeps a NaN
    }
  if (!(worst <= 2e-4))
    fail_input("the voxel grid is sheared: its directions are not at right angles or not of unit length",
               path, "resample the labels to a rectangular grid with nearest neighbour");
  for (int pass = 0; worst > 1e-15 && pass < 3; ++pass) {
    // One step of the polar decomposition treats all axes alike: A <- A (3 I - A^T A) / 2.
    const std::array<Vec3, 3> b = a;
    for (int i = 0; i < 3; ++i) {
      a[i] = 1.5 * b[i];
      for (int j = 0; j < 3; ++j) a[i] = a[i] - 0.5 * dot(b[j], b[i]) * b[j];
    }
  }
  for (Vec3& v : a) v = v + Vec3{0, 0, 0};  // -0 becomes 0
  return a;
}

/// What NIfTI leaves open: two orientations that may disagree, none at all, units.
void settle_nifti(const HeaderFacts& facts, LabelVolume& volume, const std::string& path) {
  if (!facts.has_forms)
    volume.warnings.push_back(path +
                              ": carries no orientation; its axes are taken as left, posterior, superior");
  // ITK 5.2 scales the voxel size to mm, but not the origin.
  if (facts.unit_mm != 1 && !facts.raw_origin.empty() &&
      norm(volume.origin_mm - facts.raw_origin[0]) <= 1e-6 * norm(facts.raw_origin[0]))
    volume.origin_mm = facts.unit_mm * volume.origin_mm;
  if (facts.sform.empty()) return;
  double apart = 0;
  for (int corner = 0; corner < 8; ++corner) {
    double index[3];
    for (int d = 0; d < 3; ++d) index[d] = corner >> d & 1 ? volume.size[d] - 1 : 0;
    Vec3 p = facts.sform[3];
    for (int d = 0; d < 3; ++d) p = p + index[d] * facts.sform[d];
    apart = std::max(apart, norm(facts.unit_mm * p - volume.world(index[0], index[1], index[2])));
  }
  if (apart > 0.1 * *std::min_element(volume.spacing_mm.begin(), volume.spacing_mm.end())) {
    std::ostringstream text;
    text << path << ": its header gives voxel positions up to " << apart
         << " mm apart (pixdim, qform, sform); as ITK does, pixdim is the voxel size, and the qform holds "
            "unless the "
            "sform's code is 1";
    volume.warnings.push_back(text.str());
  }
}

void take_grid(const itk::ImageIOBase& io, LabelVolume& volume, int layers, const std::string& path) {
  const unsigned dims = io.GetNumberOfDimensions();
  if (dims < 2) fail_input("the image has one dimension only", path, "give a three-dimensional label volume");
  double origin[3] = {0, 0, 0};
  std::array<std::array<double, 3>, 3> axis = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  volume.size = {1, 1, 1};
  for (unsigned d = 0; d < dims; ++d) {
    const std::uint64_t n = io.GetDimensions(d);
    if (d >= 3) {
      if (n > 1)
        fail_input("the image has more than three dimensions", path,
                   "give one three-dimensional label volume");
      continue;
    }
    if (n < 1 || n > 2147483647u)
      fail_input("the image has a dimension of " + std::to_string(n), path, again);
    volume.size[d] = static_cast<int>(n);
    volume.spacing_mm[d] = io.GetSpacing(d);
    origin[d] = io.GetOrigin(d) + 0.0;  // -0 becomes 0
    const std::vector<double> direction = io.GetDirection(d);
    for (unsigned c = 0; c < 3; ++c) axis[d][c] = c < direction.size() ? direction[c] : 0;
  }
  if (io.GetNumberOfComponents() != static_cast<unsigned>(layers))
    fail_input("the image has several values a voxel (colour or vectors)", path, "give one label volume");
  require_spacing(volume.spacing_mm.data(), 3, path);
  volume.origin_mm = {origin[0], origin[1], origin[2]};
  if (!std::isfinite(norm(volume.origin_mm))) fail_input("the origin is not finite", path, again);
  for (int d = 0; d < 3; ++d) volume.axes[d] = {axis[d][0], axis[d][1], axis[d][2]};
  volume.axes = orthonormal(volume.axes, path);
}

using Type = itk::IOComponentEnum;

/// Reads and converts the voxels. Values of one or two bytes are read straight into the result's own memory.
template <class T>
void read_as(itk::ImageIOBase& io, const Palette::Where& where, Palette& palette, LabelVolume& volume,
             const std::function<void(void*)>& read) {
  const std::size_t count = static_cast<std::size_t>(volume.size[0]) * volume.size[1] * volume.size[2];
  if (io.GetComponentSize() != sizeof(T)) fail_internal("unexpected voxel size", "image module");
  if constexpr (sizeof(T) <= 2) {
    volume.voxels.resize(count);
    char* memory = reinterpret_cast<char*>(volume.voxels.data());
    T* raw = reinterpret_cast<T*>(memory + count * (2 - sizeof(T)));
    read(raw);
    palette.convert(raw, volume.voxels.data(), count, where);
  } else {
    const std::unique_ptr<T[]> raw(new T[count]);
    read(raw.get());
    volume.voxels.resize(count);
    palette.convert(raw.get(), volume.voxels.data(), count, where);
  }
}

/// Reads all voxels into memory of the image's own type.
void read_raw(itk::ImageIOBase& io, const std::string& path, const HeaderFacts& facts, void* memory) {
  itk::ImageIORegion region(io.GetNumberOfDimensions());
  for (unsigned d = 0; d < io.GetNumberOfDimensions(); ++d) region.SetSize(d, io.GetDimensions(d));
  io.SetIORegion(region);
  std::string damage;
  std::exception_ptr failure;
  // ITK overlooks broken check sums and short streams, so the stream is checked beside the reading.
  parallel_for(facts.compressed ? 2 : 1, 0, [&](std::size_t task) {
    if (task == 1) {
      damage = check_deflate(facts.data_path, facts.data_offset, facts.data_size, facts.needed_bytes);
      return;
    }
    try {
      io.Read(memory);
    } catch (...) {
      failure = std::current_exception();
    }
  });
  if (!damage.empty()) fail_input("cannot read the voxels: " + damage, path, again);
  if (failure) std::rethrow_exception(failure);
}

void read_voxels(itk::ImageIOBase& io, const std::string& path, const HeaderFacts& facts,
                 LabelVolume& volume) {
  const Palette::Where where = [&](std::size_t i) {
    const std::size_t x = i % volume.size[0], y = i / volume.size[0] % volume.size[1];
    const std::size_t z = i / volume.size[0] / volume.size[1];
    return std::pair<std::string, std::string>(
        path, "voxel (" + std::to_string(x) + ", " + std::to_string(y) + ", " + std::to_string(z) + ")");
  };
  const auto read = [&](void* memory) { read_raw(io, path, facts, memory); };

  Palette palette;
  switch (io.GetComponentType()) {
    case Type::UCHAR:
      read_as<unsigned char>(io, where, palette, volume, read);
      break;
    case Type::CHAR:
      read_as<signed char>(io, where, palette, volume, read);
      break;
    case Type::USHORT:
      read_as<unsigned short>(io, where, palette, volume, read);
      break;
    case Type::SHORT:
      read_as<short>(io, where, palette, volume, read);
      break;
    case Type::UINT:
      read_as<unsigned int>(io, where, palette, volume, read);
      break;
    case Type::INT:
      read_as<int>(io, where, palette, volume, read);
      break;
    case Type::ULONG:
      read_as<unsigned long>(io, where, palette, volume, read);
      break;
    case Type::LONG:
      read_as<long>(io, where, palette, volume, read);
      break;
    case Type::ULONGLONG:
      read_as<unsigned long long>(io, where, palette, volume, read);
      break;
    case Type::LONGLONG:
      read_as<long long>(io, where, palette, volume, read);
      break;
    case Type::FLOAT:
      read_as<float>(io, where, palette, volume, read);
      break;
    case Type::DOUBLE:
      read_as<double>(io, where, palette, volume, read);
      break;
    default:
      fail_input("its voxel type is not read", path, "store the labels as whole numbers");
  }
  palette.finish(volume);
}

/// Reads the voxels of a segmentation whose segments may overlap: a value for every layer.
template <class T>
void read_layers_as(itk::ImageIOBase& io, const std::string& path, const HeaderFacts& facts, const std::string& labels, LabelVolume& volume) {
  if (io.GetComponentSize() != sizeof(T)) fail_internal("unexpected voxel size", "image module");
  const auto layers = static_cast<std::size_t>(facts.layers), pixels = static_cast<std::size_t>(volume.size[0]) * volume.size[1];
  const std::unique_ptr<T[]> raw(new T[pixels * volume.size[2] * layers]);
  read_raw(io, path, facts, raw.get());
  std::vector<LabelInfo> segments;
  for (const SlicerSegment& s : facts.segmentation.segments) segments.push_back(s.label);
  join_segments(
      segments,
      [&](int k) {
        std::vector<std::vector<std::uint16_t>> out(layers, std::vector<std::uint16_t>(pixels, 0));
        for (std::size_t l = 0; l < layers; ++l)
          for (std::size_t i = 0; i < pixels; ++i) {
            const T value = raw[(pixels * k + i) * layers + l];
            if (value == 0) continue;
            for (std::size_t s = 0; s < segments.size() && out[l][i] == 0; ++s) {
              const SlicerSegment& segment = facts.segmentation.segments[s];
              if (segment.layer == static_cast<int>(l) && static_cast<T>(segment.value) == value) out[l][i] = static_cast<std::uint16_t>(s + 1);
            }
          }
        return out;
      },
      labels, path, volume);
}

void read_layers(itk::ImageIOBase& io, const std::string& path, const HeaderFacts& facts, const std::string& labels, LabelVolume& volume) {
  switch (io.GetComponentType()) {
    case Type::UCHAR: return read_layers_as<unsigned char>(io, path, facts, labels, volume);
    case Type::CHAR: return read_layers_as<signed char>(io, path, facts, labels, volume);
    case Type::USHORT: return read_layers_as<unsigned short>(io, path, facts, labels, volume);
    case Type::SHORT: return read_layers_as<short>(io, path, facts, labels, volume);
    case Type::UINT: return read_layers_as<unsigned int>(io, path, facts, labels, volume);
    case Type::INT: return read_layers_as<int>(io, path, facts, labels, volume);
    default: fail_input("the voxel type of the segmentation's layers is not read", path, "store them as whole numbers of 8 to 32 bits");
  }
}

/// Opens the file, takes its grid, and lets `voxels` read on.
template <class Voxels>
void read_file(const std::string& path, FileFormat format, const HeaderFacts& facts, LabelVolume& grid, const char* smaller,
               Voxels voxels) {
  try {
    const Quiet quiet;
    itk::Object::GlobalWarningDisplayOff();
    nifti_set_debug_level(0);
    const itk::ImageIOBase::Pointer io = make_reader(format);
    std::unique_ptr<const AloneNifti> alone;
    if (format == FileFormat::nifti) alone = std::make_unique<const AloneNifti>(path);
    io->SetFileName(alone ? alone->path() : path);
    io->ReadImageInformation();
    take_grid(*io, grid, facts.layers, path);
    if (format == FileFormat::nifti) settle_nifti(facts, grid, path);
    voxels(*io);
  } catch (const Error&) {
    throw;
  } catch (const itk::ExceptionObject&) {  // its text holds addresses and source lines, nothing for users
    fail_input("the file is damaged or truncated: its voxels or header cannot be decoded", path, again);
  } catch (const std::bad_alloc&) {
    fail_input("the image does not fit into memory", path, smaller);
  } catch (const std::exception& e) {
    fail_input(std::string("the file cannot be read (") + e.what() + ")", path, again);
  }
}

/// Reads the voxels as T and keeps them as float.
template <class T>
void read_floats(itk::ImageIOBase& io, const std::string& path, const HeaderFacts& facts, std::vector<float>& values) {
  if (io.GetComponentSize() != sizeof(T)) fail_internal("unexpected voxel size", "image module");
  if constexpr (std::is_same_v<T, float>) {
    read_raw(io, path, facts, values.data());
  } else {
    const std::unique_ptr<T[]> raw(new T[values.size()]);
    read_raw(io, path, facts, raw.get());
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(raw[i]);
  }
}

void read_intensities(itk::ImageIOBase& io, const std::string& path, const HeaderFacts& facts, std::vector<float>& values) {
  switch (io.GetComponentType()) {
    case Type::UCHAR: return read_floats<unsigned char>(io, path, facts, values);
    case Type::CHAR: return read_floats<signed char>(io, path, facts, values);
    case Type::USHORT: return read_floats<unsigned short>(io, path, facts, values);
    case Type::SHORT: return read_floats<short>(io, path, facts, values);
    case Type::UINT: return read_floats<unsigned int>(io, path, facts, values);
    case Type::INT: return read_floats<int>(io, path, facts, values);
    case Type::ULONG: return read_floats<unsigned long>(io, path, facts, values);
    case Type::LONG: return read_floats<long>(io, path, facts, values);
    case Type::ULONGLONG: return read_floats<unsigned long long>(io, path, facts, values);
    case Type::LONGLONG: return read_floats<long long>(io, path, facts, values);
    case Type::FLOAT: return read_floats<float>(io, path, facts, values);
    case Type::DOUBLE: return read_floats<double>(io, path, facts, values);
    default: fail_input("its voxel type is not read", path, "store the image as numbers of up to 64 bits");
  }
}

}  // namespace

LabelVolume read_volume_file(const std::string& path, FileFormat format, const std::string& labels) {
  const HeaderFacts facts = check_volume_header(path, format);
  LabelVolume volume;
  volume.kind = kind_of(format);
  volume.warnings = facts.warnings;
  read_file(path, format, facts, volume, "crop it, or store it as 8- or 16-bit whole numbers",
            [&](itk::ImageIOBase& io) {
              if (facts.layers > 1) read_layers(io, path, facts, labels, volume);
              else read_voxels(io, path, facts, volume);
            });
  const SlicerSegmentation& segmentation = facts.segmentation;
  if (segmentation.segments.empty()) return volume;
  volume.kind = "seg.nrrd";
  volume.goes_on_low = segmentation.goes_on_low;
  volume.goes_on_high = segmentation.goes_on_high;
  if (facts.layers == 1)
    for (LabelInfo& label : volume.labels)
      for (const SlicerSegment& s : segmentation.segments)
        if (s.label.number == label.number && label.number != 0) label = s.label;
  return volume;
}

IntensityVolume read_intensity_file(const std::string& path, FileFormat format) {
  const HeaderFacts facts = check_volume_header(path, format);
  if (facts.layers > 1) fail_input("the image has more than three dimensions or several values a voxel", path, "give an image, not a segmentation");
  LabelVolume grid;
  grid.warnings = facts.warnings;
  IntensityVolume image;
  read_file(path, format, facts, grid, "crop it", [&](itk::ImageIOBase& io) {
    image.values.resize(static_cast<std::size_t>(grid.size[0]) * grid.size[1] * grid.size[2]);
    read_intensities(io, path, facts, image.values);
  });
  image.kind = kind_of(format);
  image.warnings = std::move(grid.warnings);
  image.size = grid.size;
  image.spacing_mm = grid.spacing_mm;
  image.origin_mm = grid.origin_mm;
  image.axes = grid.axes;
  return image;
}

}  // namespace stackmesh
