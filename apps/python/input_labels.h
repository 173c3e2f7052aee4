#pragma once
#include <pybind11/numpy.h>

#include <memory>
#include <string>
#include <vector>

#include "model/contours.h"
#include "model/label_volume.h"

namespace stackmesh::python {

/// @param labels three-dimensional, Fortran order, native byte order, of any whole-number or float type
/// @param affine shape (4, 4), index to LPS mm; None: no anatomy @param spacing three mm; None: what the affine says,
/// or 1 @param names {number: name}
std::shared_ptr<const LabelVolume> volume_of_array(const pybind11::array& labels, const pybind11::object& affine,
                                                   const pybind11::object& spacing, const pybind11::dict& names,
                                                   const std::string& name);

/// @param labels [(number, name, [(z, [polygon of shape (n, 2), ...]), ...]), ...], heights ascending, mm
std::shared_ptr<const std::vector<LabelContours>> contours_of_lists(const pybind11::list& labels,
                                                                    const std::string& name);

}  // namespace stackmesh::python
