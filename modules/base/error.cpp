#include "base/error.h"

#include "base/text.h"

namespace stackmesh {
namespace {
std::string join(const std::string& what, const std::string& where, const std::string& mend) {
  std::string text = what;
  if (!where.empty()) text += ", " + where;
  if (!mend.empty()) text += "; " + mend;
  return printable(text);  // an error is one line, of text
}
}  // namespace

Error::Error(ErrorKind kind, const std::string& what_is_wrong, const std::string& where, const std::string& how_to_mend)
    : std::runtime_error(join(what_is_wrong, where, how_to_mend)),
      kind_(kind),
      problem_(printable(what_is_wrong)),
      where_(printable(where)),
      mend_(printable(how_to_mend)) {}

void fail_usage(const std::string& what, const std::string& where, const std::string& mend) {
  throw Error(ErrorKind::usage, what, where, mend);
}
void fail_input(const std::string& what, const std::string& where, const std::string& mend) {
  throw Error(ErrorKind::input, what, where, mend);
}
void fail_output(const std::string& what, const std::string& where, const std::string& mend) {
  throw Error(ErrorKind::output, what, where, mend);
}
void fail_internal(const std::string& what, const std::string& where) {
  throw Error(ErrorKind::internal, what, where, "this is a bug of stackmesh: please report it with the input");
}

}  // namespace stackmesh
