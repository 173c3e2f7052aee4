#pragma once
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/progress.h"
#include "base/atomic_file.h"
#include "enhance/enhance.h"
#include "meshio/write_mesh.h"
#include "pipeline/input.h"
#include "pipeline/keep_pieces.h"
#include "pipeline/layers.h"
#include "pipeline/mesh_product.h"
#include "pipeline/volume_sections.h"
#include "report/run_report.h"
#include "stitch/stitch.h"
#include "volume/fill_volume.h"

namespace stackmesh {

/// How far a run goes.
enum class Target { surface, volume };

struct MeshRunOptions {
  Target target = Target::volume;
  InputOptions input;
  PieceOptions pieces;                            ///< which pieces of each label are meshed
  SectionOptions sections;
  StitchOptions stitch;                           ///< label_caps are given by name or number in label_caps_text
  std::vector<std::pair<std::string, LabelEndCaps>> label_caps_text;
  bool enhance = false;                           ///< smooth and remesh the stitched surface
  std::optional<std::size_t> enhance_up_to;       ///< triangles; a larger stitched surface is kept as it is, with a warning
  EnhanceOptions enhancement;                     ///< pixel and gap are set by the run; label_edge_mm by label_edges_text
  std::vector<std::pair<std::string, double>> label_edges_text;
  FillOptions fill;                               ///< label_max_volume_mm3 by label_volumes_text
  std::vector<std::pair<std::string, double>> label_volumes_text;
  LayerTexts layers;                              ///< of wedges, under the outer faces of labels
  bool many_tets = false;                         ///< more than 10 million tetrahedra are wanted
  int order = 1;                                  ///< of the tetrahedra: 1 linear, 2 quadratic (10 nodes)
  int refine = 0;                                 ///< how often every tetrahedron is cut into eight, at the end
  std::string space = "lps";                      ///< "lps" or "ras"
  std::vector<std::string> names_outputs;         ///< .json files for the labels' numbers, names and colours
  std::vector<std::string> outputs, reports;      ///< file names; the ending gives the format
  MeshWriteOptions write;                         ///< space and labels are set by the run
  bool strict = false;                            ///< a lost detail is an error
  int threads = 0;
  std::string command = "mesh", version;
  std::vector<std::pair<std::string, std::string>> option_texts;  ///< for the report
  std::vector<std::string> notes;                 ///< warnings of the caller, for the report
};

/// Takes the place of writing volume files: gets the mesh, adds to the report, writes to the files.
using ModelStage = std::function<void(MeshProduct product, RunReport& report, AtomicFiles& files)>;

/// Is told the labels that will be filled as soon as they are read, and may refuse by an Error.
using LabelsStage = std::function<void(const std::vector<LabelInfo>& labels)>;

/// Slice stack to verified surface and volume mesh: read, contours, stitch, enhance, volume, validate, write. Everything
/// that is written appears whole or not at all. With `model`, the verified volume goes there instead of into files.
/// @throws Error: input, output, usage; no_result after the report (and the offending triangles) were written.
RunReport run_mesh(const MeshRunOptions& options, Progress& progress, const ModelStage& model = {}, const LabelsStage& labels = {});

}  // namespace stackmesh
