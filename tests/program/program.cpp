#include "program.h"

#include <fcntl.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace program {

namespace fs = std::filesystem;

namespace {

std::string new_folder() {
  std::string name = (fs::temp_directory_path() / "stackmesh_program_XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
  return name;
}

}  // namespace

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::vector<std::string> Ended::warnings() const {
  const std::string start = "stackmesh: warning: ";
  std::vector<std::string> found;
  for (const std::string& line : lines_of(err))
    if (line.rfind(start, 0) == 0) found.push_back(line.substr(start.size()));
  return found;
}

bool Ended::warns_of(const std::string& part) const {
  for (const std::string& w : warnings())
    if (w.find(part) != std::string::npos) return true;
  return false;
}

Ended run(const std::vector<std::string>& command, const Around& around) {
  const std::string folder = new_folder();
  const std::string out = folder + "/out", err = folder + "/err";
  std::vector<char*> argv;
  for (const std::string& word : command) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  const int pid = ::fork();
  if (pid == 0) {
    const int null = ::open("/dev/null", O_RDONLY), o = ::open(out.c_str(), O_WRONLY | O_CREAT, 0600),
              e = ::open(err.c_str(), O_WRONLY | O_CREAT, 0600);
    ::dup2(null, 0);
    ::dup2(o, 1);
    ::dup2(e, 2);
    if (!around.folder.empty() && ::chdir(around.folder.c_str()) != 0) ::_exit(98);
    if (around.in_child && !around.in_child()) ::_exit(99);
    ::execv(argv[0], argv.data());
    ::_exit(127);
  }
  Ended result;
  int status = 0;
  if (around.while_running)
    while (::waitpid(pid, &status, WNOHANG) == 0) around.while_running(pid);
  else ::waitpid(pid, &status, 0);
  result.code = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  result.out = read_file(out);
  result.err = read_file(err);
  fs::remove_all(folder);
  return result;
}

Ended stackmesh(std::vector<std::string> arguments, const Around& around) {
  arguments.insert(arguments.begin(), STACKMESH_PROGRAM);
  return run(arguments, around);
}

Ended python(const std::string& script, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), {"/usr/bin/python3", STACKMESH_SOURCE_DIR "/tests/python/" + script});
  return run(arguments);
}

std::string read_file(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

std::string testdata(const std::string& name) {
  return std::string(STACKMESH_TESTDATA) + "/" + name;
}

std::string shared_data(const std::string& name) {
  const std::string path = std::string(STACKMESH_SHARED_DATA) + "/" + name;
  return fs::exists(path) ? path : "";
}

void ProgramTest::SetUp() {
  folder_ = new_folder();
  fs::create_directories(folder_ + "/in");
  fs::create_directories(folder_ + "/out");
}

void ProgramTest::TearDown() {
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

std::string ProgramTest::write(const std::string& name, const std::string& bytes) const {
  fs::create_directories(fs::path(in(name)).parent_path());
  std::ofstream(in(name), std::ios::binary) << bytes;
  return in(name);
}

std::vector<std::string> ProgramTest::written() const {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder_ + "/out")) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

Json ProgramTest::report(const std::string& name) const {
  const Json j = Json::parse(read_file(out(name)), nullptr, false);
  EXPECT_FALSE(j.is_discarded()) << name << " is no JSON";
  return j;
}

const Json& ProgramTest::row(const Json& report, int label) {
  for (const Json& r : report.at("labels"))
    if (r.at("label") == label) return r;
  throw std::runtime_error("the report has no row for label " + std::to_string(label));
}

Ended ProgramTest::succeeds(const std::vector<std::string>& arguments) {
  Ended r = stackmesh(arguments);
  std::string command;
  for (const std::string& a : arguments) command += " " + a;
  EXPECT_EQ(r.code, 0) << "stackmesh" << command << "\n" << r.err;
  return r;
}

void ProgramTest::fails(int code, const std::vector<std::string>& arguments, const std::vector<std::string>& parts,
                        const std::vector<std::string>& left, const Around& around) const {
  std::string command = "stackmesh";
  for (const std::string& a : arguments) command += " " + a;
  SCOPED_TRACE(command);
  const Ended r = stackmesh(arguments, around);
  EXPECT_EQ(r.code, code) << r.err;
  EXPECT_EQ(r.out, "");
  EXPECT_EQ(r.err.rfind("stackmesh: error: ", 0), 0u) << r.err;
  EXPECT_EQ(std::count(r.err.begin(), r.err.end(), '\n'), 1) << r.err;
  EXPECT_TRUE(!r.err.empty() && r.err.back() == '\n') << r.err;
  const std::size_t mend = r.err.find("; ");
  EXPECT_NE(mend, std::string::npos) << "no way to mend: " << r.err;
  EXPECT_NE(r.err.rfind(", ", mend), std::string::npos) << "no place: " << r.err;
  for (const std::string& part : parts)
    EXPECT_NE(r.err.find(part), std::string::npos) << "'" << part << "' is not in: " << r.err;
  EXPECT_EQ(written(), left);
}

void ProgramTest::refuses(const std::string& input, std::vector<std::string> parts,
                          std::vector<std::string> more) const {
  std::vector<std::string> arguments = {"mesh", input,        "-o",       out("a.vtu"),
                                        "-o",   out("a.stl"), "--report", out("R.json")};
  arguments.insert(arguments.end(), more.begin(), more.end());
  parts.push_back(input);
  fails(3, arguments, parts);
}

}  // namespace program
