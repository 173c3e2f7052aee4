#pragma once
#include <cstddef>
#include <string>
#include <vector>

namespace stackmesh {

/// A table of text as it stands in a CSV or TSV file.
struct Table {
  /// A line of the file, or several where a quoted cell holds line ends.
  struct Row {
    std::size_t line = 0;            ///< where it begins in the file, from 1
    std::vector<std::string> cells;  ///< as many as there are columns
  };
  std::vector<std::string> columns;  ///< cells of the head line, one a column; names are not checked
  std::vector<Row> rows;             ///< below the head line, in the file's order, without empty ones
};

/// Reads a table with a head line: tabs separate the cells when the name ends in .tsv or the head line holds a tab,
/// else commas. Cells may be in double quotes (RFC 4180), which then may hold separators, line ends and doubled quotes.
/// Empty lines are left out; a byte order mark and CR LF are accepted.
/// @throws Error(input) for a file that cannot be read, has no head, a row of another length, an unclosed quote or a
/// NUL byte
Table read_table(const std::string& path);

/// A cell of a CSV file, quoted where it has to be.
std::string csv_cell(const std::string& text);

}  // namespace stackmesh
