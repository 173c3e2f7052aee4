#pragma once
#include <string>

namespace stackmesh {

/// A DICOM text (PS3.5, 6.1.2) as UTF-8, where code extensions by ISO 2022 switch between character sets: Japanese,
/// Korean, Chinese, and the 8-bit sets of Europe and the Middle East. DCMTK's own conversion knows no multi-byte set
/// but the Korean one.
/// @param bytes the field as it is stored; what follows a backslash between characters is another value, and left out
/// @param character_sets Specific Character Set, its values parted by backslashes; the first one holds until a switch
/// @return what cannot be decoded stands as '?'
std::string decode_dicom_text(const std::string& bytes, const std::string& character_sets);

/// Whether the character sets are for decode_dicom_text(): one of them is a multi-byte one of Japan or China.
bool needs_code_extensions(const std::string& character_sets);

}  // namespace stackmesh
