#pragma once
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/monitor.h"
#include "meshio/read_mesh.h"
#include "report/run_report.h"
#include "run/input.h"
#include "sections/extract.h"

namespace stackmesh {

/// Which meshes to judge, and against what.
struct ValidateRunOptions {
  std::vector<std::string> meshes;        ///< files of any program
  std::optional<InputOptions> against;    ///< labels or contours; unset: the meshes are judged alone
  StackAxis axis = StackAxis::automatic;  ///< stacking axis of the labels or contours of `against`
  bool as_stored = false;                 ///< labels that are stored finer than they were made stay as they are stored
  /// "lps", "ras", "image": indices times spacing, or "auto": the mark in the file, else what overlaps best
  std::string mesh_space = "auto";
  MeshReadOptions read;              ///< how the mesh files are read: the array of their labels
  std::optional<Limits> limits;      ///< unset: the defaults
  std::vector<std::string> reports;  ///< file names; the ending gives the format
  bool write_defects = false;        ///< NAME.defects.vtp for each mesh with defects
  std::string defects_folder;        ///< for those; empty: beside the first report, else the working folder
  int threads = 0;                   ///< 0: all of the machine
  std::string version;               ///< of the program, for the reports
  std::vector<std::pair<std::string, std::string>> option_texts;  ///< for the report
};

/// Judges each mesh on its own and against the labels: read, frame, match labels, check, find defects, give verdicts,
/// write. Everything that is written appears whole or not at all. Returns a report for each mesh; exit_code() of their
/// verdicts is the command's. @throws Error: usage, input (also when mesh and labels do not overlap), output.
std::vector<RunReport> run_validate(const ValidateRunOptions& options, Monitor& progress);

}  // namespace stackmesh
