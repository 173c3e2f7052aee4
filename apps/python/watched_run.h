#pragma once
#include <pybind11/pybind11.h>

#include <functional>

#include "base/monitor.h"

namespace stackmesh::python {

/// Does `work` on a thread of its own and without the GIL, while the calling thread looks after Python: a signal whose
/// handler raises (Ctrl-C) or a `progress` that raises cancels the run within a tenth of a second, and what was raised
/// is thrown. @param progress None, or called as progress(stage: str, done: float), 0 to 1, on the calling thread
void run_watched(const std::function<void(Monitor&)>& work, const pybind11::object& progress);

}  // namespace stackmesh::python
