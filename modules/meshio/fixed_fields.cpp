#include "meshio/fixed_fields.h"

#include <charconv>

namespace stackmesh {

std::string fixed_number(double value, std::size_t width) {
  if (value == 0) return "0.";
  for (int digits = 17; digits > 0; --digits) {
    char buffer[64];
    const auto end = digits == 17
                         ? std::to_chars(buffer, buffer + sizeof buffer, value).ptr
                         : std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::general, digits).ptr;
    std::string text(buffer, end);
    const std::size_t exponent = text.find('e');
    if (text.find('.') == std::string::npos) text.insert(exponent == std::string::npos ? text.size() : exponent, ".");
    if (const std::size_t e = text.find('e'); e != std::string::npos) text[e] = 'E';
    if (text.size() <= width) return text;
  }
  return "0.";
}

void FixedFields::padded(const std::string& text, std::size_t width) {
  for (std::size_t i = text.size(); i < width; ++i) out_ << ' ';
  out_ << text;
}

}  // namespace stackmesh
