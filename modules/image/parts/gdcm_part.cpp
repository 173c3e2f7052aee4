// The part stackmesh-gdcm: pixels of one DICOM file by GDCM through ITK. GDCM's dictionaries alone take 15 ms to load.
#include <itkGDCMImageIO.h>
#include <itkObject.h>

#include <cstddef>
#include <exception>
#include <stdexcept>
#include <vector>

#include "base/part.h"

STACKMESH_PART_VERSION_IS(STACKMESH_PART_VERSION)

namespace {

template <class T>
void copy(const std::vector<char>& bytes, std::size_t count, double* values) {
  if (bytes.size() < count * sizeof(T)) throw std::length_error("too few bytes");
  const T* p = reinterpret_cast<const T*>(bytes.data());
  for (std::size_t i = 0; i < count; ++i) values[i] = static_cast<double>(p[i]);
}

void decode(const char* path, std::size_t count, double* values) {
  itk::Object::GlobalWarningDisplayOff();
  const auto io = itk::GDCMImageIO::New();
  io->SetFileName(path);
  io->ReadImageInformation();
  if (io->GetNumberOfComponents() != 1 || io->GetImageSizeInPixels() != static_cast<itk::ImageIOBase::SizeType>(count))
    throw std::length_error("another size than the header's");
  std::vector<char> bytes(io->GetImageSizeInBytes());
  itk::ImageIORegion region(io->GetNumberOfDimensions());
  for (unsigned d = 0; d < io->GetNumberOfDimensions(); ++d) region.SetSize(d, io->GetDimensions(d));
  io->SetIORegion(region);
  io->Read(bytes.data());
  using Type = itk::IOComponentEnum;
  switch (io->GetComponentType()) {
    case Type::UCHAR:
      return copy<unsigned char>(bytes, count, values);
    case Type::CHAR:
      return copy<signed char>(bytes, count, values);
    case Type::USHORT:
      return copy<unsigned short>(bytes, count, values);
    case Type::SHORT:
      return copy<short>(bytes, count, values);
    case Type::UINT:
      return copy<unsigned int>(bytes, count, values);
    case Type::INT:
      return copy<int>(bytes, count, values);
    default:
      throw std::invalid_argument("voxel type");
  }
}

}  // namespace

/// The stored values of an image of one component and `count` pixels. 0: done; 1: it cannot be decoded.
STACKMESH_OF_PART int stackmesh_decode_with_gdcm(const char* path, std::size_t count, double* values) {
  try {
    decode(path, count, values);
    return 0;
  } catch (const std::exception&) {  // GDCM's texts hold source lines, nothing for users
    return 1;
  }
}
