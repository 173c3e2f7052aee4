#pragma once
// Runs the program, CalculiX and Python scripts in a folder of the test's own.
#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/wait.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "base/atomic_file.h"
#include "meshio/write_mesh.h"

namespace solver {

class SolverTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = (std::filesystem::temp_directory_path() / "stackmesh_fem_XXXXXX").string();
    ASSERT_NE(::mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override {
    std::error_code ignored;
    if (!HasFailure()) std::filesystem::remove_all(folder_, ignored);
  }
  std::string at(const std::string& name) const { return folder_ + "/" + name; }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(at(name), std::ios::binary) << text;
    return at(name);
  }
  std::string read(const std::string& name) const {
    std::ifstream file(at(name), std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
  }
  /// A law file of constant materials, in the units that every law file must state.
  std::string law(const std::string& labels, const std::string& load_case, const std::string& more = "") const {
    return write(
        "law.json",
        R"({"schema": "stackmesh-law-1", "units": {"length": "mm", "force": "N", "stress": "MPa"}, "labels": {)" +
            labels + "}, " + more + R"("load_case": )" + load_case + "}");
  }
  /// A shell command in the folder; its output goes to NAME.log.
  int run(const std::string& command, const std::string& name = "run") const {
    std::fflush(nullptr);
    const int status = std::system(("cd '" + folder_ + "' && " + command + " >" + name + ".log 2>&1").c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  void fem(const std::string& arguments) const {
    ASSERT_EQ(run("'" STACKMESH_PROGRAM "' fem " + arguments, "fem"), 0) << arguments << "\n" << read("fem.log");
  }
  /// The program must refuse with that exit code and one line holding every part, and leave no file of the outputs'
  /// name.
  void refuses(int code, const std::string& arguments, const std::vector<std::string>& parts) const {
    EXPECT_EQ(run("'" STACKMESH_PROGRAM "' fem " + arguments + " -o refused.inp", "fem"), code) << arguments << "\n"
                                                                                                << read("fem.log");
    const std::string text = read("fem.log");
    EXPECT_EQ(text.rfind("stackmesh: error: ", 0), 0u) << text;
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1) << text;
    for (const std::string& p : parts)
      EXPECT_NE(text.find(p), std::string::npos) << "'" << p << "' is not in: " << text;
    EXPECT_FALSE(std::filesystem::exists(at("refused.inp")));
  }
  static bool has_ccx() { return std::system("command -v ccx >/dev/null 2>&1") == 0; }
  void solve(const std::string& deck) const {
    ASSERT_EQ(run("OMP_NUM_THREADS=1 ccx -i " + deck, "ccx"), 0) << read("ccx.log");
    ASSERT_EQ(read("ccx.log").find("*ERROR"), std::string::npos) << read("ccx.log");
    ASSERT_TRUE(std::filesystem::exists(at(deck + ".frd")));
  }
  void expect_answer(const std::string& arguments) const {
    EXPECT_EQ(run("/usr/bin/python3 '" STACKMESH_SOURCE_DIR "/tests/python/fem_answers.py' " + arguments, "answer"), 0)
        << read("answer.log");
  }
  void write_mesh(const std::string& name, const stackmesh::TetMesh& mesh) const {
    stackmesh::AtomicFiles files;
    stackmesh::write_volume(files, at(name), mesh, {});
    files.commit();
  }
  nlohmann::json report(const std::string& name = "r.json") const { return nlohmann::json::parse(read(name)); }
  /// The places of the report's warnings of that code.
  std::vector<std::string> places_of(const std::string& code) const {
    std::vector<std::string> places;
    const nlohmann::json r = report();
    for (const auto& w : r["warning_details"])
      if (w["code"] == code) places.push_back(w["where"]);
    return places;
  }
  std::string folder_;
};

#define NEEDS_CCX() \
  if (!has_ccx()) GTEST_SKIP() << "NOT TESTED: CalculiX (calculix-ccx) is not installed"

}  // namespace solver
