// A libFuzzer target for the readers of one module: STACKMESH_FUZZ_ENDINGS names the endings, of which the first byte
// of an input chooses one. Whatever a file holds, a reader returns or throws Error with a line; anything else is a
// finding, and so is a label volume that is not as its declaration says. Where the first byte is 128 or more, the check
// sums of a PNG are put right, because nothing behind a wrong one would be reached.
#include <sys/mman.h>
#include <unistd.h>
#include <zlib.h>

#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include "base/error.h"
#if defined(STACKMESH_FUZZ_IMAGE)
#include "image/read_contours.h"
#include "image/read_labels.h"
#include "image/read_structure_set.h"
#include "model/label_volume.h"
#elif defined(STACKMESH_FUZZ_MESHIO)
#include "meshio/read_mesh.h"
#else
#include "fem/material_law.h"
#endif

namespace {

using namespace stackmesh;

/// A folder of this process in memory, so that nothing is written to a disk.
std::string folder() {
  static const std::string made = [] {
    std::string name = "/dev/shm/stackmesh_fuzz_XXXXXX";
    if (::mkdtemp(name.data()) == nullptr) std::abort();
    return name;
  }();
  return made;
}

#if defined(STACKMESH_FUZZ_IMAGE)
void read(const std::string& path, const std::string& ending) {
  if (ending == ".cnt") read_contour_file(path);
  else if (ending == ".rt") read_structure_set(path, "");
  else {
    const LabelVolume volume = read_label_volume(path);
    try {
      check_label_volume(volume, path);
    } catch (const Error&) {
      std::abort();
    }
  }
}
#elif defined(STACKMESH_FUZZ_MESHIO)
void read(const std::string& path, const std::string&) {
  read_mesh(path);
}
#else
void read(const std::string& path, const std::string&) {
  read_law(path);
}
#endif

void put_check_sums_right(std::string& png) {
  const auto number = [&](std::size_t at) {
    std::uint32_t value = 0;
    for (int i = 0; i < 4; ++i) value = value << 8 | static_cast<unsigned char>(png[at + static_cast<std::size_t>(i)]);
    return value;
  };
  for (std::size_t at = 8; at + 12 <= png.size();) {
    const std::size_t length = number(at);
    if (length > png.size() - at - 12) return;
    auto sum = ::crc32(0, reinterpret_cast<const Bytef*>(png.data()) + at + 4, static_cast<uInt>(length + 4));
    at += 12 + length;
    for (std::size_t i = 1; i <= 4; ++i, sum >>= 8) png[at - i] = static_cast<char>(sum & 0xff);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::vector<std::string> endings = {STACKMESH_FUZZ_ENDINGS};
  if (size < 1) return 0;
  const std::string ending = endings[data[0] % endings.size()], path = folder() + "/input" + ending;
  std::string bytes(reinterpret_cast<const char*>(data + 1), size - 1);
  if (ending == ".png" && data[0] >= 128) put_check_sums_right(bytes);
  std::ofstream(path, std::ios::binary) << bytes;
  try {
    read(path, ending);
  } catch (const Error& e) {
    const std::string line = e.what();
    if (line.find('\n') != std::string::npos || line.find("; ") == std::string::npos || e.kind() == ErrorKind::internal)
      std::abort();
  } catch (const std::bad_alloc&) {  // the bound on memory
  }
  return 0;
}
