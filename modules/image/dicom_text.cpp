#include "image/dicom_text.h"

#include <iconv.h>

#include <algorithm>

namespace stackmesh {
namespace {

/// A character set that escape sequences switch to. The two halves of the code table, bytes below and from 0x80, are
/// switched apart.
struct CodeSet {
  const char* escape;    ///< behind ESC
  const char* term;      ///< the defined term of a high one
  const char* encoding;  ///< of iconv, in which its characters have their high bits set
  bool high;             ///< it takes the high half
  int bytes;             ///< per character
  char shift;            ///< the encoding's own byte before each character; 0: none
};

constexpr CodeSet kSets[] = {
    {"(B", "", "", false, 1, 0},
    {"(J", "", "", false, 1, 0},  // JIS X 0201 Roman: ASCII but for the yen and the overline
    {"$@", "", "EUC-JP", false, 2, 0},
    {"$B", "", "EUC-JP", false, 2, 0},
    {"$(D", "", "EUC-JP", false, 2, '\x8f'},
    {")I", "ISO 2022 IR 13", "EUC-JP", true, 1, '\x8e'},
    {"$)C", "ISO 2022 IR 149", "EUC-KR", true, 2, 0},
    {"$)A", "ISO 2022 IR 58", "GB2312", true, 2, 0},
    {"-A", "ISO 2022 IR 100", "ISO-8859-1", true, 1, 0},
    {"-B", "ISO 2022 IR 101", "ISO-8859-2", true, 1, 0},
    {"-C", "ISO 2022 IR 109", "ISO-8859-3", true, 1, 0},
    {"-D", "ISO 2022 IR 110", "ISO-8859-4", true, 1, 0},
    {"-L", "ISO 2022 IR 144", "ISO-8859-5", true, 1, 0},
    {"-G", "ISO 2022 IR 127", "ISO-8859-6", true, 1, 0},
    {"-F", "ISO 2022 IR 126", "ISO-8859-7", true, 1, 0},
    {"-H", "ISO 2022 IR 138", "ISO-8859-8", true, 1, 0},
    {"-M", "ISO 2022 IR 148", "ISO-8859-9", true, 1, 0},
    {"-T", "ISO 2022 IR 166", "TIS-620", true, 1, 0},
};

std::string to_utf8(std::string character, const char* encoding) {
  iconv_t converter = iconv_open("UTF-8", encoding);
  if (converter == reinterpret_cast<iconv_t>(-1)) return "?";
  char out[16];
  char *from = character.data(), *to = out;
  std::size_t left = character.size(), room = sizeof out;
  const bool good = iconv(converter, &from, &left, &to, &room) != static_cast<std::size_t>(-1);
  iconv_close(converter);
  return good ? std::string(out, to) : "?";
}

/// The set of the high half before any switch: the first that is declared. (The standard wants a switch to those behind
/// the first value, which some programs leave out.)
const CodeSet* first_high(const std::string& character_sets) {
  for (std::size_t begin = 0; begin <= character_sets.size();) {
    const std::size_t end = std::min(character_sets.find('\\', begin), character_sets.size());
    std::string term = character_sets.substr(begin, end - begin);
    begin = end + 1;
    term.erase(0, std::min(term.find_first_not_of(' '), term.size()));
    term.erase(term.find_last_not_of(' ') + 1);
    if (term.compare(0, 7, "ISO_IR ") == 0) term = "ISO 2022 IR " + term.substr(7);
    for (const CodeSet& s : kSets)
      if (s.high && term == s.term) return &s;
  }
  return nullptr;
}

}  // namespace

bool needs_code_extensions(const std::string& character_sets) {
  const auto names = [&](const std::string& term) {
    const std::size_t at = character_sets.find(term);
    return at != std::string::npos &&
           (character_sets.size() == at + term.size() || character_sets[at + term.size()] < '0' ||
            character_sets[at + term.size()] > '9');
  };
  return names("IR 87") || names("IR 159") || names("IR 13") || names("IR 58");
}

std::string decode_dicom_text(const std::string& bytes, const std::string& character_sets) {
  const CodeSet *low = &kSets[0], *high = first_high(character_sets);
  std::string out;
  for (std::size_t i = 0; i < bytes.size();) {
    if (bytes[i] == '\x1b') {
      const CodeSet* found = nullptr;
      for (const CodeSet& s : kSets)
        if (bytes.compare(i + 1, std::char_traits<char>::length(s.escape), s.escape) == 0) found = &s;
      if (found == nullptr) {
        out += '?';
        ++i;
        continue;
      }
      (found->high ? high : low) = found;
      i += 1 + std::char_traits<char>::length(found->escape);
      continue;
    }
    const bool upper = static_cast<unsigned char>(bytes[i]) >= 0x80;
    const CodeSet* set = upper ? high : low;
    // blanks and control signs are in every set
    const bool plain = !upper && (set->bytes == 1 || static_cast<unsigned char>(bytes[i]) <= 0x20);
    if (plain) {
      if (bytes[i] == '\\') break;
      out += bytes[i++];
      continue;
    }
    if (set == nullptr || i + static_cast<std::size_t>(set->bytes) > bytes.size()) {
      out += '?';
      ++i;
      continue;
    }
    std::string character = bytes.substr(i, static_cast<std::size_t>(set->bytes));
    for (char& c : character) c = static_cast<char>(static_cast<unsigned char>(c) | 0x80);
    if (set->shift != 0) character.insert(character.begin(), set->shift);
    out += to_utf8(std::move(character), set->encoding);
    i += static_cast<std::size_t>(set->bytes);
  }
  return out;
}

}  // namespace stackmesh
