// --layer: wedges under the outer faces of labels, in every format, and what is refused.
#include "program.h"

namespace program {
namespace {

class Layers : public ProgramTest {
 protected:
  static std::size_t count(const Json& r, const char* field) { return r.at("volume").at(field); }
};

TEST_F(Layers, OfTheFemurAreWholeAndEveryFormatHoldsThem) {
  const std::vector<std::string> readable = {"f.vtu", "f.vtk", "f.msh", "f.inp"};
  std::vector<std::string> command = {"mesh",
                                      testdata("femur.nii.gz"),
                                      "--edge-length",
                                      "6",
                                      "--layer",
                                      "1=1.5,3",
                                      "--report",
                                      out("R.json"),
                                      "-o",
                                      out("f.vtp")};
  for (const std::string& name : readable) command.insert(command.end(), {"-o", out(name)});
  for (const std::string name : {"f.feb", "f.bdf", "f.exo", "f.med", "f.cdb", "f.k", "f.mesh"})
    command.insert(command.end(), {"-o", out(name)});
  succeeds(command);
  const Json r = report();
  EXPECT_EQ(count(r, "inverted"), 0u);
  ASSERT_EQ(r.at("layers").size(), 1u);
  const Json& layer = r.at("layers")[0];
  EXPECT_GT(layer.at("full_share").get<double>(), 0.95);
  EXPECT_EQ(count(r, "wedges"), layer.at("wedges").get<std::size_t>());
  EXPECT_EQ(count(r, "wedges") % 3, 0u);
  EXPECT_GT(count(r, "wedges"), 10000u);
  for (const Json& l : r.at("labels"))
    EXPECT_NEAR(l.at("tet_volume_mm3").get<double>(), l.at("surface_volume_mm3").get<double>(),
                1e-6 * l.at("surface_volume_mm3").get<double>());
  for (const std::string& name : readable) {
    succeeds({"validate", out(name), "--report", out("V.json")});
    const Json v = report("V.json");
    for (const char* field : {"tets", "wedges", "pyramids", "inverted"})
      EXPECT_EQ(v.at("volume").at(field), r.at("volume").at(field)) << name << ", " << field;
    for (const Json& verdict : v.at("verdicts"))
      if (verdict.at("id") == "conforming" || verdict.at("id") == "orientation")
        EXPECT_EQ(verdict.at("status"), "pass") << name;
  }
}

TEST_F(Layers, EndAtTheHeartsOtherLabelsAndThePlacesAreNamed) {
  for (const char* order : {"1", "2"}) {
    const Ended ended = succeeds({"mesh", testdata("heart4.nii.gz"), "--edge-length", "5", "--order", order, "--layer",
                                  "5=3,2", "--layer", "3=2,1", "-o", out("h.vtu"), "-o", out("h.msh"), "--report",
                                  out("R.json"), "--report", out("R.html")});
    EXPECT_TRUE(ended.warns_of("label 5: the layer of 3 mm is thinner on ")) << ended.err;
    EXPECT_TRUE(ended.warns_of("another label begins")) << ended.err;
    const Json r = report();
    EXPECT_EQ(count(r, "inverted"), 0u);
    EXPECT_GT(count(r, "pyramids"), 0u);
    ASSERT_EQ(r.at("layers").size(), 2u);
    for (const Json& layer : r.at("layers")) {
      EXPECT_NEAR(layer.at("full_share").get<double>() + layer.at("thinned_share").get<double>() +
                      layer.at("missing_share").get<double>(),
                  1, 1e-9);
      ASSERT_FALSE(layer.at("places").empty());
      EXPECT_FALSE(layer.at("places")[0].at("why").get<std::string>().empty());
    }
    EXPECT_NE(read_file(out("R.html")).find("Layers of wedges under outer faces"), std::string::npos);
    for (const char* name : {"h.vtu", "h.msh"}) {
      succeeds({"validate", out(name), "--report", out("V.json")});
      const Json v = report("V.json");
      for (const char* field : {"tets", "wedges", "pyramids", "inverted", "order"})
        EXPECT_EQ(v.at("volume").at(field), r.at("volume").at(field)) << name << ", " << field;
      for (const Json& verdict : v.at("verdicts"))
        if (verdict.at("id") == "conforming") EXPECT_EQ(verdict.at("status"), "pass") << name;
    }
  }
}

TEST_F(Layers, ForeignProgramsReadWedgesAndPyramids) {
  std::vector<std::string> command = {
      "mesh", testdata("heart4.nii.gz"), "--edge-length", "8", "--layer", "5=3,2", "--report", out("R.json")};
  for (const std::string name : {"h.vtu", "h.msh", "h.med", "h.bdf", "h.inp", "h.exo", "h.cdb", "h.k"})
    command.insert(command.end(), {"-o", out(name)});
  succeeds(command);
  const Ended read = python("read_wedges.py", {out("R.json"), out("h.vtu"), out("h.msh"), out("h.med"), out("h.bdf"),
                                               out("h.inp"), out("h.exo"), out("h.cdb"), out("h.k")});
  EXPECT_EQ(read.code, 0) << read.out << read.err;
}

TEST_F(Layers, WhatCannotBeIsRefusedInOneLine) {
  const std::string femur = testdata("femur.nii.gz");
  const auto refused = [&](int code, const std::string& layer, const std::vector<std::string>& parts,
                           std::vector<std::string> more = {}) {
    std::vector<std::string> command = {"mesh", femur, "--layer", layer, "-o", out("a.vtu")};
    command.insert(command.end(), more.begin(), more.end());
    fails(code, command, parts);
  };
  refused(3, "9=1.5,3", {"label '9' is not in the input"});
  refused(2, "1=0,3", {"'0' is not above 0"});
  refused(2, "1=-1,3", {"'-1' is not above 0"});
  refused(2, "1=1.5,0", {"'0' is not a whole number from 1 to 100"});
  refused(2, "1=1.5,2.5", {"whole number"});
  refused(2, "1=1.5", {"'1=1.5' is no layer", "--layer 5=1.5,3"});
  refused(2, "1.5,3", {"is no layer"});
  refused(2, "1=x,3", {"--layer"});
  refused(2, "1=1,1", {"label 1 has two layers"}, {"--layer", "1=2,1"});
  refused(2, "1=1,1", {"--refine"}, {"--refine", "1"});
  refused(2, "2=1,1", {"label 2 is a void"}, {"--void", "2"});
  fails(2, {"surface", femur, "--layer", "1=1,1", "-o", out("a.stl")}, {"--layer is for volume meshes"});
  fails(2, {"mesh", femur, "--order", "2", "--edge-length", "12", "--layer", "1=1,1", "-o", out("a.k")},
        {"second-order wedges"});
}

}  // namespace
}  // namespace program
