#include "case_options.h"

#include <algorithm>
#include <set>

#include "base/error.h"
#include "base/memory.h"
#include "base/text.h"
#include "commands.h"
#include "options.h"

namespace stackmesh::app {
namespace {

/// Files that batch names itself.
const std::set<std::string> kOwnNames = {"output", "report", "help"};
const std::set<std::string> kPaths = {"names", "image", "materials", "result"};

/// A program with one command that checks its options and does nothing.
class CheckedCommand {
 public:
  explicit CheckedCommand(const std::string& name) : name_(name) {
    if (name == "surface") add_surface_command(program_, Purpose::check);
    else if (name == "fem") add_fem_command(program_, Purpose::check);
    else add_mesh_command(program_, Purpose::check);
    command_ = program_.get_subcommand(name);
    command_->remove_option(command_->get_option("INPUT"));
    for (const char* own : {"--output", "--report", "--max-memory"}) command_->remove_option(command_->get_option(own));
    // The real one takes effect when it is read.
    command_->add_option_function<std::string>("--max-memory",
                                               [](const std::string& text) { parse_memory(text, "--max-memory"); });
  }

  CLI::App& command() { return *command_; }

  void parse(const std::vector<std::string>& words) {
    for (const std::string& word : words) {
      const std::string name = word.substr(0, word.find('='));
      if (name == "--output" || name == "--report" || word.rfind("-o", 0) == 0)
        fail_usage("batch names the files of a case itself", name,
                   "leave it out; --format chooses what is written, such as --format vtu,stl");
    }
    std::vector<std::string> arguments(words.rbegin(), words.rend());  // as CLI11 takes a vector
    arguments.push_back(name_);
    try {
      program_.parse(arguments);
    } catch (const CLI::ParseError& e) {
      fail_usage(std::string(e.what()), "options of " + name_, "see stackmesh " + name_ + " --help");
    }
  }

 private:
  std::string name_;
  CLI::App program_;
  CLI::App* command_ = nullptr;
};

bool is_for_cases(const CLI::Option& option) {
  return !option.get_group().empty() && !option.get_lnames().empty() && kOwnNames.count(option.get_lnames()[0]) == 0;
}

}  // namespace

CaseCommand case_command(const std::string& name, const std::vector<std::string>& formats) {
  CaseCommand c;
  c.name = name;
  c.version = STACKMESH_VERSION;
  c.formats = formats;
  CheckedCommand checked(name);
  for (const CLI::Option* o : checked.command().get_options()) {
    if (!is_for_cases(*o)) continue;
    for (const std::string& long_name : o->get_lnames())
      c.options.push_back(
          {long_name, o->get_items_expected_max() == 0, o->get_items_expected_max() > 1, kPaths.count(long_name) > 0});
  }
  c.check = [name](const std::vector<std::string>& words) { CheckedCommand(name).parse(words); };
  return c;
}

std::vector<OptionValue> read_case_options(const std::string& name, const std::vector<std::string>& words) {
  CheckedCommand checked(name);
  checked.parse(words);
  std::vector<OptionValue> values;
  for (const CLI::Option* o : checked.command().get_options()) {
    if (o->count() == 0 || !is_for_cases(*o)) continue;
    OptionValue value{o->get_lnames()[0], {}};
    if (o->get_items_expected_max() > 0)
      for (const std::string& text : o->results())
        if (!text.empty()) value.values.push_back(text);
    if (value.name == "names")
      for (const std::string& path : value.values)
        if (ends_with(lower_case(path), ".json"))
          fail_usage("every case would write the same file", "--names " + path,
                     "leave it out: the label names are in each report.json");
    values.push_back(value);
  }
  return merged(values, {});
}

}  // namespace stackmesh::app
