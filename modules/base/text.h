#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace stackmesh {

/// The text with A to Z as a to z; whatever the locale, other bytes stay.
std::string lower_case(std::string_view text);

/// The text on one line, safe to show on a terminal: control characters (also those of 0x80 to 0x9f in UTF-8) become
/// blanks.
std::string printable(std::string_view text);

/// The same for text of several lines, which stay.
std::string printable_lines(std::string_view text);

/// Whether the last bytes of the text are those of `end`, upper and lower case apart; an empty end always is.
bool ends_with(std::string_view text, std::string_view end);

/// Those of the known names that are the most like a name that is not among them (by letters changed, added or left
/// out), the best first, as "a, b, c".
std::string nearest_names(std::string_view name, const std::vector<std::string>& known, std::size_t most = 6);

}  // namespace stackmesh
