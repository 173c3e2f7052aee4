// What no file may do: crash a reader, or bring a patient's name into an output.
#include <filesystem>
#include <fstream>
#include <random>

#include "base/error.h"
#include "inputs.h"
#include "run/input.h"

namespace {

using namespace inputs;

class Robustness : public InputTest {
 protected:
  /// Reads `count` copies of a file with some bytes changed, cut off or doubled: labels, or one clear line.
  void mutate(const std::string& path, int count, std::uint32_t seed, const std::string& read_path = "") {
    const std::string bytes = program::read_file(path);
    ASSERT_GT(bytes.size(), 100u);
    std::mt19937 random(seed);
    const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
    int refused = 0;
    for (int i = 0; i < count; ++i) {
      std::string changed = bytes;
      const std::size_t kind = below(8);
      for (std::size_t k = 0; k <= below(6); ++k) changed[below(changed.size())] = static_cast<char>(random());
      if (kind == 0) changed.resize(below(changed.size()));
      if (kind == 1) changed.insert(below(changed.size()), changed.substr(below(changed.size()), below(64)));
      if (kind == 2) changed.erase(below(changed.size()), below(64));
      { std::ofstream(path, std::ios::binary) << changed; }
      stackmesh::InputOptions options;
      options.paths = {read_path.empty() ? path : read_path};
      testing::internal::CaptureStderr();
      testing::internal::CaptureStdout();
      std::string message;
      try {
        stackmesh::read_input(options);
      } catch (const stackmesh::Error& e) {
        message = e.what();
        ++refused;
        EXPECT_EQ(static_cast<int>(e.kind()), static_cast<int>(stackmesh::ErrorKind::input)) << message;
      }
      EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << "seed " << seed << ", copy " << i;
      EXPECT_EQ(testing::internal::GetCapturedStdout(), "") << "seed " << seed << ", copy " << i;
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
      EXPECT_EQ(message.find("PLANTED"), std::string::npos) << message;
      if (!message.empty()) {
        EXPECT_NE(message.find("; "), std::string::npos) << "no way to mend: " << message;
      }
    }
    EXPECT_GT(refused, 0);
    std::ofstream(path, std::ios::binary) << bytes;
  }
};

TEST_F(Robustness, ChangedBytesGiveLabelsOrOneClearLine) {
  written_by("write_rtstruct.py", {"keyhole", "implicit"});
  if (IsSkipped() || HasFatalFailure()) return;
  mutate(in("keyhole.dcm"), 150, 1);
  mutate(in("implicit.dcm"), 150, 2);
  written_by("write_segmentations.py", {"seg_overlap", "seg_rle", "series", "nrrd_layers"});
  if (IsSkipped() || HasFatalFailure()) return;
  mutate(in("seg_overlap.dcm"), 150, 3);
  mutate(in("seg_rle.dcm"), 150, 4);
  mutate(in("nrrd_layers.seg.nrrd"), 150, 5);
  mutate(in("series") + "/s2.dcm", 100, 6, in("series"));
}

TEST_F(Robustness, NoIdentifyingFieldReachesAnOutputOrMessage) {
  written_by("write_rtstruct.py", {"box", "overlap", "crossing", "none"});
  if (IsSkipped() || HasFatalFailure()) return;
  written_by("write_segmentations.py", {"seg_overlap", "seg_mixed", "series", "series_ct", "series_two"});
  if (IsSkipped() || HasFatalFailure()) return;
  const std::string head = program::read_file(in("box.dcm"));
  ASSERT_NE(head.find("PLANTED"), std::string::npos);  // it is there to be found
  std::string told;
  const auto run = [&](std::vector<std::string> arguments) {
    const Ended r = program::stackmesh(std::move(arguments));
    told += r.out + r.err;
    return r.code;
  };
  int n = 0;
  for (const char* name : {"box.dcm", "overlap.dcm", "seg_overlap.dcm", "series"}) {
    std::vector<std::string> arguments = {"mesh",      in(name),   "--no-enhance",
                                          "--verbose", "--report", out(std::to_string(n) + ".json")};
    for (const char* end : {"vtu", "msh", "inp", "vtk", "mesh", "stl", "ply", "obj", "off", "vtp"}) {
      arguments.push_back("-o");
      arguments.push_back(out(std::to_string(n) + "." + end));
    }
    EXPECT_EQ(run(arguments), 0) << told;
    EXPECT_EQ(run({"info", in(name)}), 0);
    EXPECT_EQ(run({"info", in(name), "--json"}), 0);
    for (const char* end : {"c.json", "c.svg", "c.cnt"})
      EXPECT_EQ(run({"contours", in(name), "-o", out(std::to_string(n) + end)}), 0);
    ++n;
  }
  for (const char* name : {"crossing.dcm", "none.dcm", "seg_mixed.dcm", "series_ct", "series_two"})
    EXPECT_EQ(run({"mesh", in(name), "-o", out("no.vtu")}), 3);
  write("cut.dcm", head.substr(0, head.size() / 2));
  EXPECT_EQ(run({"info", in("cut.dcm")}), 3);
  const auto is_clean = [](const std::string& text) {
    return text.find("PLANTED") == std::string::npos && text.find("19010203") == std::string::npos &&
           text.find("DOCTOR") == std::string::npos;
  };
  EXPECT_TRUE(is_clean(told)) << told;
  EXPECT_GE(written().size(), 40u);
  for (const std::string& name : written()) EXPECT_TRUE(is_clean(program::read_file(out(name)))) << name;
}

}  // namespace
