#include "cohort/manifest.h"

#include <fnmatch.h>
#include <glob.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

#include "base/error.h"
#include "base/text.h"
#include "cohort/table.h"

namespace stackmesh {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> parts;
  std::string part;
  for (const char c : text + at) {
    if (c != at) {
      part += c;
      continue;
    }
    part.erase(0, part.find_first_not_of(' '));
    part.erase(part.find_last_not_of(' ') + 1);
    if (!part.empty()) parts.push_back(part);
    part.clear();
  }
  return parts;
}

bool is_glob(const std::string& path) {
  return path.find_first_of("*?[") != std::string::npos;
}

std::vector<std::string> glob_files(const std::string& pattern) {
  std::vector<std::string> found;
  glob_t names;
  if (::glob(pattern.c_str(), 0, nullptr, &names) == 0)
    for (std::size_t i = 0; i < names.gl_pathc; ++i) found.emplace_back(names.gl_pathv[i]);
  ::globfree(&names);
  return found;
}

/// The path as seen from the working folder. A leading dash would be an option.
std::string relative_to(const fs::path& folder, const std::string& path) {
  if (path.empty() || path[0] == '/') return path;
  const std::string joined = folder.empty() ? path : (folder / path).string();
  return joined[0] == '-' ? "./" + joined : joined;
}

/// FILE, or the file of LABEL=FILE, relative to the folder.
std::string input_path(const fs::path& folder, const std::string& cell) {
  const std::size_t equal = cell.find('=');
  std::error_code ignored;
  if (equal == std::string::npos || cell.find('/') < equal || fs::exists(relative_to(folder, cell), ignored))
    return relative_to(folder, cell);
  return cell.substr(0, equal + 1) + relative_to(folder, cell.substr(equal + 1));
}

bool is_there(const std::string& input) {
  std::error_code ignored;
  if (fs::exists(input, ignored)) return true;
  if (is_glob(input) && !glob_files(input).empty()) return true;
  const std::size_t equal = input.find('=');
  return equal != std::string::npos && fs::exists(input.substr(equal + 1), ignored);
}

std::string without_ending(const std::string& path) {
  std::string name = fs::path(path).filename().string();
  for (const char* ending : {".seg.nrrd", ".nii.gz", ".gipl.gz"})
    if (ends_with(lower_case(name), ending)) return name.substr(0, name.size() - std::string(ending).size());
  const std::size_t dot = name.rfind('.');
  return dot == std::string::npos || dot == 0 ? name : name.substr(0, dot);
}

/// Checks that every call would be understood; equal calls are checked once.
class CallCheck {
 public:
  explicit CallCheck(const CaseCommand& command) : command_(command) {}
  void operator()(const CohortCase& c, const std::string& where) {
    const std::vector<std::string> words = words_of(c.options);
    if (!command_.check || !known_.insert(words).second) return;
    try {
      command_.check(words);
    } catch (const Error& e) {
      if (where.empty()) throw;
      fail_input("case '" + c.id + "' has an option that " + command_.name + " does not take", where,
                 std::string(e.what()));
    }
  }

 private:
  const CaseCommand& command_;
  std::set<std::vector<std::string>> known_;
};

/// Turns the rows of a manifest into cases.
class ManifestReader {
 public:
  ManifestReader(const std::string& path, const CaseCommand& command, const std::vector<OptionValue>& of_all)
      : path_(path),
        folder_(fs::path(path).parent_path()),
        command_(command),
        of_all_(of_all),
        check_(command),
        table_(read_table(path)) {}

  std::vector<CohortCase> read() {
    look_at_columns();
    if (table_.rows.empty()) fail_input("the manifest has no case", path_, "write a line for each case under its head");
    std::map<std::string, std::size_t> line_of;
    std::vector<CohortCase> cases;
    for (const Table::Row& row : table_.rows) {
      const std::string where = path_ + ", line " + std::to_string(row.line);
      CohortCase c = case_of(row, where);
      const auto [at, is_new] = line_of.emplace(c.id, row.line);
      if (!is_new)
        fail_input("the id '" + c.id + "' stands twice",
                   path_ + ", lines " + std::to_string(at->second) + " and " + std::to_string(row.line),
                   "give each case an id of its own");
      check_(c, where);
      cases.push_back(std::move(c));
    }
    return cases;
  }

 private:
  void look_at_columns() {
    std::vector<std::string> names = {"id", "input"};
    for (const KnownOption& o : command_.options) names.push_back(o.name);
    std::set<std::string> seen;
    for (const std::string& column : table_.columns) {
      if (!seen.insert(column).second)
        fail_input("the column '" + column + "' stands twice", path_ + ", line 1", "keep one of them");
      if (std::find(names.begin(), names.end(), column) == names.end()) {
        const std::string nearest = nearest_names(column, names, 3);
        fail_input("unknown column '" + column + "'", path_ + ", line 1",
                   "columns are id, input and the long options of " + command_.name +
                       (nearest.empty() ? "" : "; like it are " + nearest));
      }
    }
    for (const char* needed : {"id", "input"})
      if (seen.count(needed) == 0)
        fail_input(std::string("there is no column '") + needed + "'", path_ + ", line 1",
                   "the head line needs id and input");
  }

  const KnownOption& option(const std::string& name) const {
    return *std::find_if(command_.options.begin(), command_.options.end(),
                         [&](const KnownOption& o) { return o.name == name; });
  }

  CohortCase case_of(const Table::Row& row, const std::string& where) const {
    CohortCase c;
    std::vector<OptionValue> own;
    std::set<std::string> off;
    for (std::size_t i = 0; i < row.cells.size(); ++i) {
      const std::string &column = table_.columns[i], &cell = row.cells[i];
      if (column == "id") c.id = cell;
      else if (column == "input") c.inputs = split(cell, ';');
      else if (!cell.empty()) own_option(option(column), cell, where, own, off);
    }
    const std::string fault = fault_of_id(c.id);
    if (!fault.empty())
      fail_input("the id '" + c.id + "' " + fault, where,
                 "it names the case's folder: give it letters, digits, '-' and '_'");
    if (c.inputs.empty()) fail_input("case '" + c.id + "' has no input", where, "name its file");
    for (std::string& input : c.inputs) {
      input = input_path(folder_, input);
      if (!is_there(input))
        fail_input("the input of case '" + c.id + "' is not there: '" + input + "'", where,
                   "check the name; paths are relative to the manifest's folder");
    }
    std::vector<OptionValue> others;
    for (const OptionValue& o : of_all_)
      if (off.count(o.name) == 0) others.push_back(o);
    c.options = merged(others, own);
    return c;
  }

  void own_option(const KnownOption& known, const std::string& cell, const std::string& where,
                  std::vector<OptionValue>& own, std::set<std::string>& off) const {
    OptionValue value{known.name, {}};
    if (known.is_flag) {
      const std::string word = lower_case(cell);
      const bool yes = word == "yes" || word == "true" || word == "on" || word == "1",
                 no = word == "no" || word == "false" || word == "off" || word == "0";
      if (!yes && !no)
        fail_input("'" + cell + "' in column '" + known.name + "' is neither yes nor no", where,
                   "write yes, no or nothing");
      if (yes) own.push_back(value);
      else off.insert(known.name);
      return;
    }
    value.values = known.takes_several ? split(cell, ';') : std::vector<std::string>{cell};
    if (known.is_path) {
      for (std::string& path : value.values) {
        path = relative_to(folder_, path);
        std::error_code ignored;
        if (!fs::exists(path, ignored))
          fail_input("the file of column '" + known.name + "' is not there: '" + path + "'", where,
                     "check the name; paths are relative to the manifest's folder");
      }
    }
    own.push_back(value);
  }

  const std::string path_;
  const fs::path folder_;
  const CaseCommand& command_;
  const std::vector<OptionValue>& of_all_;
  CallCheck check_;
  Table table_;
};

/// Cases of files, whose ids follow from their names.
std::vector<CohortCase> cases_of_files(const std::vector<std::string>& files, const std::string& folder,
                                       const std::string& ending, const CaseCommand& command,
                                       const std::vector<OptionValue>& of_all) {
  std::map<std::string, int> count;
  const auto short_id = [&](const std::string& file) {
    const std::string name = without_ending(file);
    return ends_with(name, ending) ? name.substr(0, name.size() - ending.size()) : name;
  };
  for (const std::string& file : files) ++count[short_id(file)];
  std::vector<CohortCase> cases;
  std::map<std::string, std::string> file_of;
  CallCheck check(command);
  for (const std::string& file : files) {
    CohortCase c;
    c.id = short_id(file);
    if (count[c.id] > 1) {
      std::string path = fs::path(file).lexically_relative(folder.empty() ? "." : folder).string();
      if (path.empty() || path.compare(0, 2, "..") == 0) path = fs::path(file).relative_path().string();
      c.id = (fs::path(path).parent_path() / c.id).string();
      std::replace(c.id.begin(), c.id.end(), '/', '_');
    }
    const std::string fault = fault_of_id(c.id);
    if (!fault.empty())
      fail_input("the name of a file makes no id: '" + c.id + "' " + fault, file,
                 "rename it, or write a manifest with ids");
    const auto [at, is_new] = file_of.emplace(c.id, file);
    if (!is_new)
      fail_input("two files make the id '" + c.id + "'", at->second + " and " + file,
                 "rename one, or write a manifest with ids");
    c.inputs = {file[0] == '-' ? "./" + file : file};
    c.options = merged(of_all, {});
    check(c, "");
    cases.push_back(std::move(c));
  }
  return cases;
}

}  // namespace

std::vector<CohortCase> read_manifest(const std::string& path, const CaseCommand& command,
                                      const std::vector<OptionValue>& of_all) {
  return ManifestReader(path, command, of_all).read();
}

std::vector<CohortCase> read_bids_tree(const std::string& folder, const CaseCommand& command,
                                       const std::vector<OptionValue>& of_all) {
  std::vector<std::string> files;
  for (const char* levels : {"sub-*/*/*_dseg.*", "sub-*/ses-*/*/*_dseg.*"})
    for (const std::string& file : glob_files((fs::path(folder) / levels).string())) {
      const std::string name = lower_case(file);
      for (const char* ending : {".nii", ".nii.gz", ".nrrd", ".mha"})
        if (ends_with(name, std::string("_dseg") + ending)) files.push_back(file);
    }
  std::sort(files.begin(), files.end());
  files.erase(std::unique(files.begin(), files.end()), files.end());
  if (files.empty())
    fail_input("the folder holds no label maps in the layout of BIDS derivatives", folder,
               "it needs sub-*/[ses-*/]KIND/*_dseg.nii.gz; name other files with --inputs 'GLOB'");
  return cases_of_files(files, folder, "_dseg", command, of_all);
}

std::vector<CohortCase> read_glob(const std::string& pattern, const std::string& folder, const CaseCommand& command,
                                  const std::vector<OptionValue>& of_all) {
  const std::vector<std::string> files = glob_files(relative_to(folder, pattern));
  if (files.empty())
    fail_input("the pattern names no file", "--inputs '" + pattern + "'",
               "quote it, and check where it begins" + (folder.empty() ? std::string() : ": in " + folder));
  return cases_of_files(files, folder, "_dseg", command, of_all);
}

std::vector<CohortCase> selected_cases(const std::vector<CohortCase>& cases, const std::string& expression) {
  std::vector<bool> chosen(cases.size(), false);
  for (const std::string& word : split(expression, ',')) {
    bool found = false;
    for (std::size_t i = 0; i < cases.size(); ++i)
      if (word == cases[i].id || ::fnmatch(word.c_str(), cases[i].id.c_str(), 0) == 0) found = chosen[i] = true;
    if (!found) {
      std::vector<std::string> ids;
      for (const CohortCase& c : cases) ids.push_back(c.id);
      fail_usage("no case is called '" + word + "'", "--only",
                 "name ids, globs of them or failed; like it are " + nearest_names(word, ids, 3));
    }
  }
  std::vector<CohortCase> kept;
  for (std::size_t i = 0; i < cases.size(); ++i)
    if (chosen[i]) kept.push_back(cases[i]);
  return kept;
}

}  // namespace stackmesh
