#include "report/html_text.h"

#include <cmath>
#include <cstdio>

namespace stackmesh {

std::string grouped(std::uint64_t value) {
  std::string text = std::to_string(value);
  for (std::ptrdiff_t at = static_cast<std::ptrdiff_t>(text.size()) - 3; at > 0; at -= 3)
    text.insert(static_cast<std::size_t>(at), ",");
  return text;
}

std::string for_script(const std::string& json) {
  std::string out;
  out.reserve(json.size());
  for (const char c : json) {
    if (c == '<') out += "\\u003c";
    else if (c == '>') out += "\\u003e";
    else if (c == '&') out += "\\u0026";
    else out += c;
  }
  return out;
}

std::string filled(const std::string& page, const std::map<std::string, std::string>& parts) {
  std::string out;
  std::size_t at = 0;
  for (std::size_t open; (open = page.find("{{", at)) != std::string::npos;) {
    const std::size_t close = page.find("}}", open);
    out.append(page, at, open - at);
    out += parts.at(page.substr(open + 2, close - open - 2));
    at = close + 2;
  }
  return out.append(page, at, std::string::npos);
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      case '\0':
        out += "\xef\xbf\xbd";
        break;
      default:
        out += c;
    }
  return out;
}

std::string number(double value, int digits) {
  if (!std::isfinite(value)) return "none";
  const double size = std::abs(value);
  if (size >= 1000 && size < 1e15)
    return (value < 0 ? "\xe2\x88\x92" : "") + grouped(static_cast<std::uint64_t>(std::llround(size)));
  char text[40];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

std::string exact(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.9g", value);
  return text;
}

std::string cell(double value, int digits, const char* kind) {
  if (!std::isfinite(value)) return "<td data-v=\"\">none</td>";
  return std::string("<td data-v=\"") + exact(value) + "\"" + (*kind ? std::string(" class=\"") + kind + "\"" : "") +
         ">" + number(value, digits) + "</td>";
}

std::string text_cell(const std::string& text) {
  return "<td class=\"text\">" + escaped(text) + "</td>";
}

std::string row(const std::string& name, const std::string& value) {
  return "<tr><th scope=\"row\">" + escaped(name) + "</th><td class=\"text\">" + escaped(value) + "</td></tr>\n";
}

std::string badge(const std::string& status) {
  return "<span class=\"badge " + status + "\">" + status + "</span>";
}

std::string table_head(const std::string& caption, const std::vector<std::string>& columns) {
  std::string out = "<div class=\"table tall\" tabindex=\"0\" role=\"region\" aria-label=\"" + escaped(caption) +
                    "\"><table class=\"sortable\"><caption>" + escaped(caption) + "</caption><thead><tr>";
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const bool text = columns[c][0] == '*';
    out += std::string("<th scope=\"col\"") + (text ? " class=\"text\"" : "") + " data-sort=\"" + std::to_string(c) +
           "\">" + escaped(columns[c].substr(text ? 1 : 0)) + "</th>";
  }
  return out + "</tr></thead><tbody>\n";
}

}  // namespace stackmesh
