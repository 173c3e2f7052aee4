#pragma once
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/atomic_file.h"
#include "base/monitor.h"
#include "mesh/mesh.h"
#include "meshio/write_mesh.h"
#include "report/run_report.h"
#include "run/input.h"
#include "run/layers.h"
#include "run/mesh_product.h"

namespace stackmesh {

/// What to mesh, how, and what to write.
struct MeshRunOptions {
  InputOptions input;  ///< what to read, and which labels of it
  MeshOptions mesh;    ///< voids, name and values per label are set by the run
  std::vector<std::pair<std::string, LabelEndCaps>> label_caps_text;  ///< by the label's number or name
  std::vector<std::pair<std::string, double>> label_edges_text;       ///< edge length, mm
  std::vector<std::pair<std::string, double>> label_volumes_text;     ///< largest tetrahedron, mm3
  LayerTexts layers;                                                  ///< of wedges, under the outer faces of labels
  std::string space = "lps";                                          ///< "lps" or "ras"
  std::vector<std::string> names_outputs;  ///< .json files for the labels' numbers, names and colours
  std::vector<std::string> outputs;        ///< file names of meshes; the ending gives the format, surface or volume
  std::vector<std::string> reports;        ///< file names; .html or .json
  MeshWriteOptions write;                  ///< space and labels are set by the run
  bool strict = false;                     ///< a lost detail is an error
  bool full_report = false;                ///< fidelity and verdicts also where no report is written
  std::string command = "mesh";            ///< that the report names: mesh, surface or fem
  std::string version;                     ///< of the program, for the report
  std::vector<std::pair<std::string, std::string>> option_texts;  ///< for the report
  std::vector<Warning> notes;                                     ///< warnings of the caller, for the report
};

/// Takes the place of writing volume files: gets the mesh, adds to the report, writes to the files.
using ModelStage = std::function<void(MeshProduct product, RunReport& report, AtomicFiles& files)>;

/// Is told the labels that will be filled as soon as they are read, and may refuse by an Error.
using LabelsStage = std::function<void(const std::vector<LabelInfo>& labels)>;

/// The mesh that a run has made, as it is written.
struct MadeMesh {
  InterfaceComplex surface;     ///< what write_surface() takes, in the space that was written
  std::optional<TetMesh> tets;  ///< what write_volume() takes
  MeshWriteOptions write;       ///< how the run wrote it, with the names of its labels
  bool has_voids = false;       ///< then `surface` is what write.per_label asked for, and not the other form
};

/// Is given the mesh of a run that succeeded, in place of its being dropped.
using MadeStage = std::function<void(MadeMesh made)>;

/// Slice stack to verified surface and volume mesh: read, contours, stitch, enhance, volume, validate, write.
/// Everything that is written appears whole or not at all. With `model`, the verified volume goes there instead of into
/// files.
/// @throws Error: input, output, usage; no_result after the report (and the offending triangles) were written.
RunReport run_mesh(const MeshRunOptions& options, Monitor& progress, const ModelStage& model = {},
                   const LabelsStage& labels = {}, const MadeStage& made = {});

}  // namespace stackmesh
