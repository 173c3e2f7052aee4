#include "cohort/table.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

#include "base/error.h"
#include "base/text.h"

namespace stackmesh {
namespace {

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t"), last = text.find_last_not_of(" \t");
  return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

/// Takes the file apart, cell by cell.
class Reader {
 public:
  Reader(const std::string& text, char separator, const std::string& path)
      : text_(text), separator_(separator), path_(path) {}

  /// The next line that is not empty; false at the end.
  bool next(Table::Row& row) {
    while (at_ < text_.size()) {
      row.line = line_;
      row.cells = cells();
      if (row.cells.size() > 1 || !row.cells[0].empty()) return true;
    }
    return false;
  }

 private:
  std::vector<std::string> cells() {
    std::vector<std::string> found;
    for (;;) {
      found.push_back(cell());
      if (at_ >= text_.size()) return found;
      const char end = text_[at_++];
      if (end == separator_) continue;
      ++line_;
      return found;
    }
  }

  /// Up to a separator or the line's end, which is left for the caller.
  std::string cell() {
    if (at_ < text_.size() && text_[at_] == '"') return quoted();
    const std::size_t from = at_;
    while (at_ < text_.size() && text_[at_] != separator_ && text_[at_] != '\n') ++at_;
    std::string found = text_.substr(from, at_ - from);
    if (!found.empty() && found.back() == '\r') found.pop_back();
    return trimmed(found);
  }

  std::string quoted() {
    const std::size_t begun = line_;
    std::string found;
    for (++at_; at_ < text_.size(); ++at_) {
      if (text_[at_] == '\n') ++line_;
      if (text_[at_] != '"') {
        found += text_[at_];
      } else if (at_ + 1 < text_.size() && text_[at_ + 1] == '"') {
        found += text_[at_++];
      } else {
        ++at_;
        while (at_ < text_.size() && (text_[at_] == '\r' || text_[at_] == ' ')) ++at_;
        if (at_ < text_.size() && text_[at_] != separator_ && text_[at_] != '\n')
          fail_input("text behind a closing quote", path_ + ", line " + std::to_string(begun),
                     "double the quotes that are part of a cell");
        return found;
      }
    }
    fail_input("a quote is not closed", path_ + ", line " + std::to_string(begun), "close it");
  }

  const std::string& text_;
  const char separator_;
  const std::string& path_;
  std::size_t at_ = 0, line_ = 1;
};

}  // namespace

Table read_table(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream bytes;
  bytes << file.rdbuf();
  if (!file)
    fail_input(std::string("the table cannot be read: ") + std::strerror(errno != 0 ? errno : EIO), path,
               "check the name and the rights");
  std::string text = bytes.str();
  if (text.compare(0, 3, "\xef\xbb\xbf") == 0) text.erase(0, 3);
  if (text.find('\0') != std::string::npos)
    fail_input("the table holds a NUL byte, it is no text", path, "save it as CSV or TSV in UTF-8");
  const std::string head = text.substr(0, text.find('\n'));
  const bool tabs = ends_with(lower_case(path), ".tsv") || head.find('\t') != std::string::npos;

  Reader reader(text, tabs ? '\t' : ',', path);
  Table table;
  Table::Row row;
  if (!reader.next(row))
    fail_input("the table is empty", path, "write a head line such as id,input and a line for each case");
  table.columns = row.cells;
  while (reader.next(row)) {
    if (row.cells.size() != table.columns.size())
      fail_input("a row of " + std::to_string(row.cells.size()) + " cells under " +
                     std::to_string(table.columns.size()) + " columns",
                 path + ", line " + std::to_string(row.line),
                 "give it a cell for each column, in quotes where it holds a separator");
    table.rows.push_back(row);
  }
  return table;
}

std::string csv_cell(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

}  // namespace stackmesh
