// A libFuzzer target for the readers of one module: STACKMESH_FUZZ_ENDINGS names the endings, of which the first byte
// of an input chooses one. Whatever a file holds, a reader returns or throws Error with a line; anything else is a
// finding.
#include <sys/mman.h>
#include <unistd.h>

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
  else read_label_volume(path);
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

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::vector<std::string> endings = {STACKMESH_FUZZ_ENDINGS};
  if (size < 1) return 0;
  const std::string ending = endings[data[0] % endings.size()], path = folder() + "/input" + ending;
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(data + 1), static_cast<std::streamsize>(size - 1));
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
