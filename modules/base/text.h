#pragma once
#include <string>
#include <string_view>

namespace stackmesh {

/// The text with A to Z as a to z; whatever the locale, other bytes stay.
std::string lower_case(std::string_view text);

bool ends_with(std::string_view text, std::string_view end);

}  // namespace stackmesh
