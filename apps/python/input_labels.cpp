#include "input_labels.h"

#include <cmath>
#include <optional>

#include "base/error.h"
#include "base/text.h"
#include "image/array_labels.h"

namespace stackmesh::python {
namespace {

namespace py = pybind11;
using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;

VoxelType type_of(const py::dtype& type, const std::string& name) {
  const char kind = type.kind();
  const auto bytes = type.itemsize();
  if (kind == 'u')
    return bytes == 1 ? VoxelType::u8 : bytes == 2 ? VoxelType::u16 : bytes == 4 ? VoxelType::u32 : VoxelType::u64;
  if (kind == 'i')
    return bytes == 1 ? VoxelType::i8 : bytes == 2 ? VoxelType::i16 : bytes == 4 ? VoxelType::i32 : VoxelType::i64;
  if (kind == 'f' && bytes == 4) return VoxelType::f32;
  if (kind == 'f' && bytes == 8) return VoxelType::f64;
  fail_input("numbers of type " + std::string(py::str(static_cast<const py::object&>(type))) + " are no labels", name,
             "give whole numbers from 0");
}

}  // namespace

std::shared_ptr<const LabelVolume> volume_of_array(const py::array& labels, const py::object& affine,
                                                   const py::object& spacing, const py::dict& names,
                                                   const std::string& name) {
  if (labels.ndim() != 3)
    fail_input("the array has " + std::to_string(labels.ndim()) + " dimensions", name,
               "give one of three: labels[i, j, k]");
  std::array<int, 3> size{};
  for (int d = 0; d < 3; ++d) {
    if (labels.shape(d) > 1000000)
      fail_input("the array has more than a million voxels along axis " + std::to_string(d), name, "crop it");
    size[d] = static_cast<int>(labels.shape(d));
  }
  const VoxelType type = type_of(labels.dtype(), name);
  const void* const values = labels.data();
  std::optional<std::array<double, 3>> spacing_mm;
  if (!spacing.is_none()) {
    const Doubles s(spacing);
    spacing_mm = {s.at(0), s.at(1), s.at(2)};
  }
  std::optional<std::array<Vec3, 4>> columns;
  if (!affine.is_none()) {
    const Doubles a(affine);
    columns.emplace();
    for (int c = 0; c < 4; ++c) (*columns)[c] = {a.at(0, c), a.at(1, c), a.at(2, c)};
  }
  std::vector<std::pair<Label, std::string>> named;
  for (const auto& [number, text] : names) named.emplace_back(py::cast<Label>(number), py::cast<std::string>(text));
  const py::gil_scoped_release released;
  LabelVolume volume = labels_of_array(values, type, size, name);
  if (columns) {
    place_volume(volume, *columns, spacing_mm, name);
  } else if (spacing_mm) {
    volume.spacing_mm = *spacing_mm;
    check_label_volume(volume, name);
  }
  for (const auto& [number, text] : named)
    for (LabelInfo& label : volume.labels)
      if (label.number == number && number != 0) label.name = printable(text);
  return std::make_shared<const LabelVolume>(std::move(volume));
}

std::shared_ptr<const std::vector<LabelContours>> contours_of_lists(const py::list& labels, const std::string& name) {
  std::vector<LabelContours> out;
  for (const py::handle entry : labels) {
    const auto label = py::cast<py::tuple>(entry);
    LabelContours c;
    c.label = py::cast<Label>(label[0]);
    c.name = printable(py::cast<std::string>(label[1]));
    c.path = name + ", label " + std::to_string(c.label);
    for (const py::handle s : py::cast<py::list>(label[2])) {
      const auto section = py::cast<py::tuple>(s);
      ContourSection made;
      made.z_mm = py::cast<double>(section[0]);
      for (const py::handle p : py::cast<py::list>(section[1])) {
        const Doubles points(py::reinterpret_borrow<py::object>(p));
        ContourPolygon polygon;
        for (py::ssize_t i = 0; i < points.shape(0); ++i) {
          polygon.points.push_back({points.at(i, 0), points.at(i, 1)});
          if (!std::isfinite(points.at(i, 0) + points.at(i, 1)))
            fail_input("a point of a contour is not finite", c.path + ", z = " + std::to_string(made.z_mm),
                       "give finite mm");
        }
        made.polygons.push_back(std::move(polygon));
      }
      c.sections.push_back(std::move(made));
    }
    out.push_back(std::move(c));
  }
  return std::make_shared<const std::vector<LabelContours>>(std::move(out));
}

}  // namespace stackmesh::python
