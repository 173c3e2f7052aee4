#pragma once
#include <set>
#include <string>
#include <vector>

namespace stackmesh {

/// Kinds of input file, told by their endings (any case).
enum class FileFormat { unknown, nifti, nrrd, metaimage, gipl, png, tiff };
FileFormat format_of(const std::string& path);

/// The name without folder and (double) ending: "a/heart.nii.gz" gives "heart".
std::string stem_of(const std::string& path);
std::string file_name_of(const std::string& path);

/// True when a sorts before b with digit runs compared as numbers: "slice2" before "slice10".
bool natural_less(const std::string& a, const std::string& b);

/// The natural order of a set of names. A sign before a number counts as one where the set shows that it is no hyphen:
/// "z-10", "z0" and "z5" (or "z-10" and "z+5") have numbers from -10 to 5; "scan-1" and "scan-2" have the numbers 1
/// and 2.
class NameOrder {
 public:
  explicit NameOrder(const std::vector<std::string>& names);
  bool less(const std::string& a, const std::string& b) const;
  /// The last number of a name, with its sign, and the text before it. False where it has none of at most 15 digits.
  bool last_number(const std::string& name, std::string& before, long long& number) const;

 private:
  struct Piece {
    std::string text;
    bool is_number = false, is_signed = false;
    double value = 0;  ///< of a signed number
  };
  std::vector<Piece> pieces_of(const std::string& name) const;
  std::set<std::string> signed_after_;  ///< texts (numbers as '#') behind which '-' and '+' are signs
};

}  // namespace stackmesh
