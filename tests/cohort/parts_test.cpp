// The parts of the module on their own.
#include <gtest/gtest.h>
#include <png.h>

#include <cmath>
#include <random>

#include "base/error.h"
#include "cohort/child.h"
#include "cohort/look.h"
#include "cohort/manifest.h"
#include "cohort/outliers.h"
#include "cohort/png.h"
#include "cohort/slurm.h"
#include "cohort/table.h"
#include "cohort/thumbnail.h"
#include "small_cohort.h"

namespace cohort_test {
namespace {

using namespace stackmesh;

TEST_F(CohortTest, TablesKeepQuotedCellsAndLineNumbers) {
  const std::string path = write("t.csv", "\xef\xbb\xbfid,input\r\n\r\n\"a, \"\"b\"\"\",\"two\nlines\"\r\n c , d \n");
  const Table t = read_table(path);
  EXPECT_EQ(t.columns, (std::vector<std::string>{"id", "input"}));
  ASSERT_EQ(t.rows.size(), 2u);
  EXPECT_EQ(t.rows[0].cells, (std::vector<std::string>{"a, \"b\"", "two\nlines"}));
  EXPECT_EQ(t.rows[0].line, 3u);
  EXPECT_EQ(t.rows[1].cells, (std::vector<std::string>{"c", "d"}));
  EXPECT_EQ(t.rows[1].line, 5u);
  EXPECT_EQ(read_table(write("t.tsv", "id\tinput\na,b\tc\n")).rows[0].cells, (std::vector<std::string>{"a,b", "c"}));
  for (const std::string& text :
       {std::string("a,b"), std::string("say \"so\""), std::string("plain"), std::string("two\nlines")}) {
    const Table back = read_table(write("c.csv", "id,input\n" + csv_cell(text) + ",x\n"));
    EXPECT_EQ(back.rows.at(0).cells[0], text);
  }
}

TEST_F(CohortTest, TheKeyTellsWhatChangesAResult) {
  CaseCommand mesh;
  mesh.version = "1";
  mesh.formats = {"vtu"};
  CohortCase c;
  c.inputs = {write("a.nrrd", box_volume(9, 6))};
  c.options = {{"edge-length", {"2"}}, {"merge", {}}};
  const std::string key = identify_case(c, mesh).key;
  EXPECT_EQ(key.size(), 64u);
  CohortCase same = c;
  same.options = {{"edge-length", {"2"}}, {"max-memory", {"4GB"}}, {"merge", {}}, {"threads", {"3"}}};
  same.inputs = {write("copy.nrrd", box_volume(9, 6))};
  EXPECT_EQ(identify_case(same, mesh).key, key) << "threads, bounds and the input's name change nothing";
  std::set<std::string> keys = {key};
  CohortCase other = c;
  other.options[0].values = {"3"};
  keys.insert(identify_case(other, mesh).key);
  other.options = {{"edge-length", {"2"}}};
  keys.insert(identify_case(other, mesh).key);
  other = c;
  other.inputs = {write("b.nrrd", box_volume(9, 7))};
  keys.insert(identify_case(other, mesh).key);
  CaseCommand command = mesh;
  command.version = "2";
  keys.insert(identify_case(c, command).key);
  command = mesh;
  command.name = "fem";
  keys.insert(identify_case(c, command).key);
  command = mesh;
  command.formats = {"vtu", "stl"};
  keys.insert(identify_case(c, command).key);
  other = c;
  other.options.push_back({"materials", {write("law.json", "{}")}});
  keys.insert(identify_case(other, mesh).key);
  write("law.json", "{ }");
  keys.insert(identify_case(other, mesh).key);
  EXPECT_EQ(keys.size(), 9u) << "two of nine different cases have one key";
}

TEST(Outliers, APlantedValueIsFoundAndNoOtherOne) {
  std::mt19937 random(5);
  std::normal_distribution<double> spread(0, 0.1);
  Distribution d;
  for (std::size_t m = 0; m < cohort_metrics().size(); ++m)
    if (cohort_metrics()[m].id == "volume_mm3") d.metric = m;
  for (std::size_t i = 0; i < 200; ++i) {
    d.cases.push_back(i);
    d.values.push_back(1000 * std::exp(std::clamp(spread(random), -0.25, 0.25)));
  }
  d.values[17] = 3000;
  judge_distribution(d);
  for (std::size_t i = 0; i < 200; ++i) EXPECT_EQ(d.scores[i] > kOutlierScore, i == 17) << d.values[i];
  EXPECT_NEAR(d.median, 1000, 40);
  EXPECT_LT(d.q1, d.median);
  EXPECT_LE(std::log(d.high / d.q3), 1.5 * std::log(d.q3 / d.q1));
  EXPECT_LT(d.high, 3000);
}

TEST(Outliers, AGoodValueIsNoneOfAFigureThatHasAWrongSide) {
  Distribution d;
  for (std::size_t m = 0; m < cohort_metrics().size(); ++m)
    if (cohort_metrics()[m].id == "dice") d.metric = m;
  d.values = {0.90, 0.90, 0.91, 0.90, 0.91, 0.99, 0.70};
  d.cases = {0, 1, 2, 3, 4, 5, 6};
  judge_distribution(d);
  EXPECT_EQ(d.scores[5], 0);
  EXPECT_GT(d.scores[6], kOutlierScore);
  d.values.resize(5);
  d.cases.resize(5);
  d.values[4] = 0.1;
  judge_distribution(d);
  for (const double s : d.scores) EXPECT_EQ(s, 0) << "five values have no outliers";
}

TEST(SlurmArrays, SizeClassesHoldEveryCaseOnce) {
  std::vector<CohortCase> cases(250);
  std::vector<CaseLook> looks(250);
  for (std::size_t i = 0; i < cases.size(); ++i) {
    cases[i].id = std::to_string(i);
    looks[i].memory_mb = i % 3 == 0 ? 100 : i % 3 == 1 ? 900 : 5000;
    looks[i].time_s = i % 2 == 0 ? 10 : 1000;
  }
  SlurmOptions options;
  std::set<std::string> seen;
  for (const SlurmArray& a : size_classes(cases, looks, options, 20)) {
    EXPECT_LE(a.tasks, 20);
    EXPECT_EQ(static_cast<std::size_t>(a.tasks), a.ids.size());
    for (const std::string& id : a.ids) {
      EXPECT_TRUE(seen.insert(id).second) << id;
      const CaseLook& l = looks[std::stoul(id)];
      EXPECT_GE(static_cast<double>(a.memory_mb), 1.5 * l.memory_mb);
      EXPECT_LT(static_cast<double>(a.memory_mb), std::max(513.0, 3.01 * l.memory_mb));
      EXPECT_GE(60 * a.minutes, 4 * l.time_s);
    }
  }
  EXPECT_EQ(seen.size(), 250u);
  options.cases_per_task = 7;
  options.timeout_s = 90;
  std::size_t held = 0;
  for (const SlurmArray& a : size_classes(cases, looks, options, 1000)) {
    EXPECT_EQ(a.minutes, 18) << "7 cases of 90 s and a minute each";
    EXPECT_EQ(static_cast<std::size_t>(a.tasks), (a.ids.size() + 6) / 7);
    held += a.ids.size();
  }
  EXPECT_EQ(held, 250u);
}

TEST(SlurmArrays, TheScriptSurvivesTheShell) {
  SlurmArray a;
  a.name = "array-1";
  a.tasks = 3;
  a.memory_mb = 2048;
  a.minutes = 20;
  SlurmOptions o;
  o.program = "/bin/echo";
  o.timeout_s = 5;
  const CohortFolder folder("/tmp/it's a folder");
  const std::string script = slurm_script(a, folder, o);
  EXPECT_NE(script.find("#SBATCH --array=0-2\n"), std::string::npos);
  EXPECT_NE(script.find("#SBATCH --mem=2048M\n"), std::string::npos);
  EXPECT_NE(script.find("#SBATCH --time=20\n"), std::string::npos);
  const CommandOutput said = output_of({"bash", "-c", script});
  EXPECT_EQ(said.text,
            "batch --task /tmp/it's a folder/.cohort/slurm/array-1.plan.json --cases-per-task 1 -o /tmp/it's a folder "
            "--timeout 5 --case-memory 2048M\n");
}

TEST(SlurmArrays, WordsAreSplitAsAShellDoes) {
  EXPECT_EQ(shell_words("--partition=long  --comment='two words' \"\" x\"y z\""),
            (std::vector<std::string>{"--partition=long", "--comment=two words", "", "xy z"}));
  EXPECT_TRUE(shell_words(" ").empty());
  EXPECT_THROW(shell_words("--comment='open"), Error);
}

std::vector<std::uint8_t> pixels_of(const std::string& png, int& width, int& height) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  EXPECT_NE(png_image_begin_read_from_memory(&image, png.data(), png.size()), 0) << image.message;
  EXPECT_EQ(image.format, static_cast<png_uint_32>(PNG_FORMAT_RGB));
  width = static_cast<int>(image.width);
  height = static_cast<int>(image.height);
  std::vector<std::uint8_t> rgb(PNG_IMAGE_SIZE(image));
  EXPECT_NE(png_image_finish_read(&image, nullptr, rgb.data(), 0, nullptr), 0) << image.message;
  return rgb;
}

TEST(Pictures, APngHoldsItsPixels) {
  std::mt19937 random(3);
  std::vector<std::uint8_t> rgb(3 * 31 * 17);
  for (std::uint8_t& b : rgb) b = static_cast<std::uint8_t>(random());
  int width = 0, height = 0;
  EXPECT_EQ(pixels_of(png_of(rgb, 31, 17), width, height), rgb);
  EXPECT_EQ(width, 31);
  EXPECT_EQ(height, 17);
}

TEST(Pictures, TheTopOfABoxIsAboveAndItsFrontIsSeen) {
  // A box of label 1, and a smaller one of label 2 on its top (+z), in LPS.
  InterfaceComplex boxes;
  const auto add = [&](double low_z, double high_z, double half, Label label) {
    const std::int32_t first = static_cast<std::int32_t>(boxes.points.size());
    for (int i = 0; i < 8; ++i)
      boxes.points.push_back({i & 1 ? half : -half, i & 2 ? half : -half, i & 4 ? high_z : low_z});
    for (const auto& q :
         {std::array<int, 4>{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}) {
      boxes.triangles.push_back({{first + q[0], first + q[1], first + q[2]}, label, 0});
      boxes.triangles.push_back({{first + q[0], first + q[2], first + q[3]}, label, 0});
    }
  };
  add(0, 10, 10, 1);
  add(10.1, 20, 5, 2);
  CohortLabel red, blue;
  red.colour = "#ff0000";
  blue.colour = "#0000ff";
  int width = 0, height = 0;
  const std::vector<std::uint8_t> rgb = pixels_of(draw_thumbnail(boxes, {{1, red}, {2, blue}}), width, height);
  double red_y = 0, blue_y = 0, red_n = 0, blue_n = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::uint8_t* p = &rgb[3 * (static_cast<std::size_t>(y) * width + x)];
      if (p[0] > 40 && p[2] < 20) red_y += y, ++red_n;
      if (p[2] > 40 && p[0] < 20) blue_y += y, ++blue_n;
    }
  EXPECT_GT(red_n, 0.1 * width * height);
  EXPECT_GT(blue_n, 0.02 * width * height);
  EXPECT_LT(blue_y / blue_n, red_y / red_n) << "what is above in the patient is above in the picture";
  EXPECT_EQ(rgb[0], 255) << "the corner shows the ground";
}

TEST(Forecast, FollowsSizeAndOptions) {
  CaseLook look;
  look.voxels = 1000000;
  look.labels = 2;
  look.area_mm2 = 78000;
  look.volume_mm3 = 380000;
  look.pixel_mm = 1;
  CohortCase c;
  foretell(look, c);
  EXPECT_NEAR(look.memory_mb, 126, 40) << "the femur of testdata";
  EXPECT_NEAR(look.time_s, 6.3, 3);
  CaseLook finer = look;
  c.options = {{"edge-length", {"1.5"}}};
  foretell(finer, c);
  EXPECT_GT(finer.memory_mb, 1.3 * look.memory_mb);
  EXPECT_GT(finer.time_s, 1.3 * look.time_s);
}

}  // namespace
}  // namespace cohort_test
