// Reports against docs/report.schema.json, by a JSON Schema library of another project.
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>
#include <vector>

#include "program.h"

namespace {

class ReportSchema : public program::ProgramTest {
 protected:
  /// The script's exit code: how many reports are invalid.
  int invalid(const std::vector<std::string>& reports) {
    std::string line = "/usr/bin/python3 '" STACKMESH_SOURCE_DIR
                       "/tests/python/report_schema.py' '" STACKMESH_SOURCE_DIR "/docs/report.schema.json'";
    for (const std::string& r : reports) line += " '" + r + "'";
    const int status = std::system((line + " >'" + out("schema.log") + "' 2>&1").c_str());
    return WEXITSTATUS(status);
  }
};

TEST_F(ReportSchema, HoldsForEveryKindOfReport) {
  const std::string femur = program::testdata("femur.nii.gz"), names = program::testdata("femur_names.ctbl");
  ASSERT_EQ(program::stackmesh({"mesh", femur, "-o", out("a.vtu"), "--report", out("mesh.json"), "--quiet"}).code, 0);
  ASSERT_EQ(program::stackmesh({"surface", program::testdata("tube.cnt"), "-o", out("b.vtp"), "--report",
                                out("contours.json"), "--quiet"})
                .code,
            0);
  ASSERT_EQ(program::stackmesh({"fem", femur, "--names", names, "--caps", "flat", "--materials",
                                program::testdata("femur_law.json"), "-o", out("c.inp"), "--report", out("fem.json"),
                                "--quiet"})
                .code,
            0);
  program::stackmesh({"validate", out("a.vtu"), "--against", femur, "--report", out("validate.json")});
  program::stackmesh({"validate", out("a.vtu"), out("b.vtp"), "--report", out("several.json")});
  const std::vector<std::string> reports = {out("mesh.json"), out("contours.json"), out("fem.json"),
                                            out("validate.json"), out("several.json")};
  EXPECT_EQ(invalid(reports), 0) << program::read_file(out("schema.log"));

  // The schema is no rubber stamp: a missing field, an unknown one and a wrong type are found.
  const std::string good = program::read_file(out("mesh.json"));
  std::vector<std::string> bad;
  for (const auto& [from, to] : {std::pair{"\"peak_rss_mb\"", "\"peak\""}, std::pair{"\"schema\": 1", "\"schema\": 2"},
                                 std::pair{"\"triangles\": ", "\"triangles\": -"}}) {
    std::string text = good;
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    text.replace(at, std::string(from).size(), to);
    bad.push_back(write("bad" + std::to_string(bad.size()) + ".json", text));
  }
  EXPECT_EQ(invalid(bad), 3) << program::read_file(out("schema.log"));
}

}  // namespace
