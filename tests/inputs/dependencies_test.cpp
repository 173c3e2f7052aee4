// Faults of libraries that are worked round (docs/dependencies.md): each test fails when the fault is gone, and the
// workaround may go.
#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dctk.h>
#include <dcmtk/oflog/oflog.h>
#include <nifti2_io.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "../image/image_files.h"

namespace {

using Json = nlohmann::json;

class Dependencies : public image_files::ImageTest {
 protected:
  /// The signal that ends a process with a stack of 8 MB which does this; 0 when it goes through.
  template <class Action>
  static int ended_by(Action action) {
    const pid_t pid = ::fork();
    if (pid == 0) {
      const rlimit none{0, 0}, stack{rlim_t{8} << 20, rlim_t{8} << 20};
      ::setrlimit(RLIMIT_CORE, &none);
      ::setrlimit(RLIMIT_STACK, &stack);
      action();
      ::_exit(0);
    }
    int status = 0;
    ::waitpid(pid, &status, 0);
    return WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  }
};

TEST_F(Dependencies, DcmtkReadsSequencesByRecursion) {
  using image_files::little;
  const std::string uid("1.2.840.10008.1.2.1\0", 20);
  std::string meta = std::string("\2\0\x10\0UI", 6) + little<std::uint16_t>(20) + uid;
  std::string all =
      std::string(128, '\0') + "DICM" + std::string("\2\0\0\0UL\4\0", 8) + little<std::uint32_t>(meta.size()) + meta;
  for (int i = 0; i < 50000; ++i)
    all += std::string("\x08\0\x40\x11SQ\0\0\xff\xff\xff\xff\xfe\xff\0\xe0\xff\xff\xff\xff", 20);
  const std::string file = write("nest.dcm", all);
  EXPECT_EQ(ended_by([&] {
              OFLog::configure(OFLogger::OFF_LOG_LEVEL);
              DcmFileFormat().loadFile(file.c_str());
            }),
            SIGSEGV)
      << "DCMTK reads deep sequences now: image/dicom_nesting.cpp may go";
}

TEST_F(Dependencies, Libnifti2ConvertsAnyNumberOfDimensions) {
  nifti_2_header header;
  std::memset(&header, 0, sizeof header);
  header.sizeof_hdr = sizeof header;
  std::memcpy(header.magic, "n+2\0\r\n\032\n", 8);
  header.datatype = NIFTI_TYPE_UINT8;
  for (auto& size : header.dim) size = 1;
  EXPECT_EQ(ended_by([&] { nifti_convert_n2hdr2nim(header, nullptr); }), 0);
  header.dim[0] = std::int64_t{1} << 40;
  EXPECT_EQ(ended_by([&] { nifti_convert_n2hdr2nim(header, nullptr); }), SIGSEGV)
      << "libnifti2 looks at the number of dimensions now";
}

TEST_F(Dependencies, Libnifti2MendsDamagedHeaders) {
  nifti_1_header header;
  std::memset(&header, 0, sizeof header);
  header.sizeof_hdr = sizeof header;
  std::memcpy(header.magic, "n+1", 4);
  header.datatype = NIFTI_TYPE_UINT8;
  const short sizes[] = {3, 4, -7, 0};
  std::copy(sizes, sizes + 4, header.dim);
  nifti_image* const image = nifti_convert_n1hdr2nim(header, nullptr);
  ASSERT_NE(image, nullptr) << "libnifti2 refuses damaged sizes now";
  EXPECT_EQ(image->ny, 1);
  EXPECT_EQ(image->dx, 1);  // the voxel size, which is 0
  nifti_image_free(image);
}

TEST_F(Dependencies, JsonIsCopiedByRecursion) {
  const std::string nest = std::string(200000, '[') + std::string(200000, ']');
  EXPECT_EQ(ended_by([&] {
              const Json j = Json::parse(nest);
              const Json copy = j;
              (void)copy;
            }),
            SIGSEGV)
      << "nlohmann-json copies deep values now: the depth need not be looked at in base/json_text.cpp";
}

TEST_F(Dependencies, JsonNumbersOverflowAsAnotherException) {
  EXPECT_THROW(Json::parse("[1e999]"), Json::out_of_range) << "the look at numbers in base/json_text.cpp may go";
}

}  // namespace
