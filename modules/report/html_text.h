#pragma once
// Pieces of HTML of which the page is made: internal to the module.
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace stackmesh {

/// Text that is safe in HTML, between tags and in attributes.
std::string escaped(const std::string& text);

/// JSON that may stand in a script element: nothing in it can end the element.
std::string for_script(const std::string& json);

/// Replaces each {{name}} of a page once; what is put in is not looked at again. Precondition: `parts` has every name.
std::string filled(const std::string& page, const std::map<std::string, std::string>& parts);

/// With thousands apart: 12,345.
std::string grouped(std::uint64_t value);

/// About three significant digits; thousands apart; "none" where there is nothing.
std::string number(double value, int digits = 3);

/// Nine significant digits.
std::string exact(double value);

/// A cell of a table, with the value that it is sorted by; "none" where the value is not finite.
/// @param kind its class; empty: none
std::string cell(double value, int digits = 3, const char* kind = "");

template <class T>
std::string cell_of(const std::optional<T>& value, int digits = 3, const char* kind = "") {
  return value ? cell(static_cast<double>(*value), digits, kind) : "<td data-v=\"\">none</td>";
}

/// A cell that is sorted as text. @param text not yet escaped
std::string text_cell(const std::string& text);

/// A row of a name and its value, neither escaped yet.
std::string row(const std::string& name, const std::string& value);

/// The word of a verdict in its colour. @param status "pass", "warn" or "fail"
std::string badge(const std::string& status);

/// The head of a table that a click sorts; names that begin with * are of text columns.
std::string table_head(const std::string& caption, const std::vector<std::string>& columns);

}  // namespace stackmesh
