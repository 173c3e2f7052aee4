#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <new>
#include <system_error>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/text.h"
#include "commands.h"
#include "slicer_module.h"

namespace {

int report(const std::string& text, stackmesh::ErrorKind kind) {
  std::fprintf(stderr, "stackmesh: error: %s\n", stackmesh::printable(text).c_str());
  return static_cast<int>(kind);
}

int report_memory() {
  return report(
      "the memory that may be taken, " + stackmesh::memory_text(stackmesh::memory_limit()) +
          ", is not enough, this machine, ulimit or --max-memory; mesh fewer labels or a smaller volume at once",
      stackmesh::ErrorKind::no_result);
}

/// What was printed must have arrived.
int finish(int code) {
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return code;
  const int why = errno;
  return code != 0 ? code
                   : report("cannot write: " + std::string(std::strerror(why != 0 ? why : EIO)) +
                                ", standard output; free some space or redirect it elsewhere",
                            stackmesh::ErrorKind::output);
}

/// The last resort: an exception where none may be, such as want of memory in a destructor.
[[noreturn]] void on_terminate() {
  int code = 70;
  try {
    if (std::current_exception()) std::rethrow_exception(std::current_exception());
  } catch (const std::bad_alloc&) {
    code = report_memory();
  } catch (const std::exception& e) {
    report(std::string(e.what()) + "; this is a bug of stackmesh: please report it with the input",
           stackmesh::ErrorKind::internal);
  } catch (...) {
  }
  stackmesh::remove_unfinished_files();
  std::_Exit(code);
}

/// CLI11 would say only that a command is missing.
void check_command(int argc, char** argv, const CLI::App& program) {
  const std::string word = argc > 1 ? argv[1] : "";
  std::string known;
  for (const CLI::App* command : program.get_subcommands([](const CLI::App*) { return true; })) {
    if (word == command->get_name()) return;
    known += (known.empty() ? "" : ", ") + command->get_name();
  }
  if (word.rfind('-', 0) == 0) return;
  stackmesh::fail_usage(argc > 1 ? "unknown command '" + word + "'" : "no command", "command line",
                        "choose one of " + known + "; see stackmesh --help");
}

/// For an option that the command does not know the one that it is the most like: " (did you mean --edge-length?)".
std::string meant(const CLI::App& program, const std::string& complaint) {
  const std::vector<CLI::App*> commands = program.get_subcommands();
  const std::size_t at = complaint.find("--");
  if (commands.empty() || at == std::string::npos || complaint.find("not expected") == std::string::npos) return "";
  const std::string word = complaint.substr(at + 2, complaint.find_first_of(" =,", at) - at - 2);
  std::vector<std::string> known;
  for (const CLI::Option* option : commands[0]->get_options())
    if (!option->get_group().empty())  // those without a group are hidden
      for (const std::string& name : option->get_lnames()) known.push_back(name);
  const std::string nearest = stackmesh::nearest_names(word, known, 1);
  return nearest.empty() ? "" : " (did you mean --" + nearest + "?)";
}

int run(int argc, char** argv) {
  CLI::App program{
      "Label slices of CT and MRI to conforming surfaces and tetrahedral meshes, closed and free of intersections."};
  program.name("stackmesh");
  program.set_version_flag("--version", "stackmesh " STACKMESH_VERSION);
  program.require_subcommand(1);
  program.add_flag("--xml", "the description of mesh as a module of 3D Slicer");
  program.footer("stackmesh COMMAND --help tells a command's options.\nLicence: AGPL-3.0-or-later.");
  stackmesh::app::add_mesh_command(program);
  stackmesh::app::add_surface_command(program);
  stackmesh::app::add_fem_command(program);
  stackmesh::app::add_contours_command(program);
  stackmesh::app::add_info_command(program);
  stackmesh::app::add_validate_command(program);
  std::vector<std::string> arguments(argv + 1, argv + argc);
  const std::vector<std::string> case_words = stackmesh::app::take_case_words(arguments);
  stackmesh::app::add_batch_command(program, case_words);
  stackmesh::app::add_collect_command(program);
  if (arguments == std::vector<std::string>{"--xml"}) {
    std::fputs(stackmesh::app::slicer_description().c_str(), stdout);
    return 0;
  }
  if (stackmesh::app::is_slicer_call(argc, argv)) arguments = stackmesh::app::translate_slicer_call(argc, argv);
  else check_command(argc, argv, program);
  try {
    std::reverse(arguments.begin(), arguments.end());  // as CLI11 takes a vector
    program.parse(arguments);
  } catch (const CLI::Success& e) {  // --help, --version
    return program.exit(e);
  } catch (const CLI::ParseError& e) {
    return report(std::string(e.what()) + meant(program, e.what()) + ", command line; see stackmesh --help",
                  stackmesh::ErrorKind::usage);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  std::set_terminate(on_terminate);
  stackmesh::end_on_signals();
  stackmesh::set_memory_limit(0);
  try {
    return finish(run(argc, argv));
  } catch (const stackmesh::Error& e) {
    std::fflush(stdout);
    return report(e.what(), e.kind());
  } catch (const std::bad_alloc&) {
    return report_memory();
  } catch (const std::filesystem::filesystem_error& e) {
    return report(
        "cannot be read: " + e.code().message() + ", " + e.path1().string() + "; check its folder and your rights",
        stackmesh::ErrorKind::input);
  } catch (const std::system_error& e) {  // threads and processes that the system does not give
    return report("the system does not give what is needed: " + std::string(e.what()) +
                      ", this machine; allow more processes (ulimit -u) or give fewer --threads",
                  stackmesh::ErrorKind::no_result);
  } catch (const std::exception& e) {
    return report(std::string(e.what()) + "; this is a bug of stackmesh: please report it with the input",
                  stackmesh::ErrorKind::internal);
  }
}
