#pragma once
#include <string>

#include "model/label_volume.h"
#include "report/run_report.h"

namespace stackmesh::testing_support {

/// What came of a label volume at the options that the program has when none is given.
struct DefaultRun {
  std::string problem;  ///< open, crossing, a component lost, a fallback, an error; "" if there is none
  RunReport report;     ///< of a run that ended well
  double cpu_s = 0;     ///< of all threads that run in this thread's name
};

/// A label volume through the whole of `stackmesh surface` (or `mesh`, where a worker is given): a file of it in memory
/// is read, made into sections, stitched, enhanced, checked. Nothing is written. One thread.
/// @param worker a program that answers the volume mesher's call; "": the surface only
DefaultRun run_at_defaults(const LabelVolume& volume, const std::string& worker = "");

}  // namespace stackmesh::testing_support
