#pragma once
// Cards of fixed width, as Nastran, LS-DYNA and ANSYS read them.
#include <cstdint>
#include <string>

#include "meshio/output_buffer.h"

namespace stackmesh {

/// A number with a point, in as many digits as fit into the width. Such fields touch where all of their width is used.
std::string fixed_number(double value, std::size_t width);

/// Fields of cards, to the right: 8 characters for whole numbers, 16 for real ones, or as wide as asked.
class FixedFields {
 public:
  explicit FixedFields(OutputBuffer& out) : out_(out) {}

 protected:
  void small(std::int64_t value) { whole(value, 8); }
  void large(std::int64_t value) { whole(value, 16); }
  void large(double value) { real(value, 16); }
  void whole(std::int64_t value, std::size_t width) { padded(std::to_string(value), width); }
  void real(double value, std::size_t width) { padded(fixed_number(value, width), width); }
  void padded(const std::string& text, std::size_t width);

  OutputBuffer& out_;
};

}  // namespace stackmesh
