#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/stage_time.h"
#include "base/warning.h"
#include "fem/assign_materials.h"
#include "fem/check_supports.h"
#include "fem/estimate_error.h"
#include "model/geometry.h"
#include "model/layers.h"
#include "report/surface_values.h"
#include "validate/check_bends.h"
#include "validate/check_fidelity.h"
#include "validate/check_surface.h"
#include "validate/check_volume.h"
#include "validate/verdict.h"

namespace stackmesh {

/// A row of the report: one label of the input.
struct LabelReport {
  Label label = 0;
  std::string name;
  std::optional<std::array<std::uint8_t, 3>> colour;  ///< red, green, blue, where the input has one
  bool is_void = false;                               ///< it bounds the others and is not filled
  bool closed = false;
  int components = 0;
  std::optional<int> input_components;
  long euler = 0;
  std::optional<double> input_volume_mm3;  ///< voxels; none for contour input
  double surface_volume_mm3 = 0;
  std::optional<double> tet_volume_mm3;
  std::optional<std::size_t> tets;
  std::optional<double> dice;
  std::optional<std::size_t> wrong_centres;
  std::optional<double> wrong_centres_share;
  std::optional<BandDistance> band_distance_mm;
  std::optional<Distance> distance_mm, reverse_distance_mm;
  std::string cap_low, cap_high;  ///< "flat" or "round"
  std::optional<long> genus;      ///< handles of all its shells; none unless closed
  double surface_area_mm2 = 0, angle_min_deg = 0;
  std::optional<double> dihedral_min_deg, dihedral_max_deg;
  std::optional<double> thin_share, thickness_p5_mm;  ///< see check_thickness
  std::optional<std::size_t> wedges;                  ///< of layers, with pyramids
  std::size_t nonmanifold_edges = 0;
  std::optional<double> mean_bend_deg, bends_above_40_share;  ///< see Bends
};

/// The mesh that `validate` judged, as its file told it.
struct JudgedMesh {
  std::string path, format;
  /// in the file, before anything was joined or left out
  std::size_t vertices = 0, triangles = 0, tets = 0, wedges = 0;
  int order = 1;             ///< 2: tets of 10 nodes
  std::string labels;        ///< where its labels came from, and which label of the input each stands for
  std::string space;         ///< "lps", "ras" or "none"
  std::string space_reason;  ///< why that one
  std::string sha256;
};

/// Where a report comes from. Nothing of an image header goes in but grid and labels.
struct Provenance {
  std::string input_sha256;  ///< of the file; of several: of the lines "digest  name" in order of name
  std::size_t input_files = 0;
  std::string compiler, build_type, program_sha256;
  std::string processor, system;
  int cores = 0;
  double memory_gib = 0;
  std::string finished_utc;  ///< ISO 8601
};

/// A set of a solver model.
struct FemSet {
  std::string name, note;
  std::size_t nodes = 0, faces = 0;  ///< faces 0: a node set only
};

/// A step of a solver model.
struct FemStep {
  std::string name;
  bool frequency = false, large_displacements = false;
  std::size_t supports = 0, loaded_nodes = 0, pressures = 0;
  Vec3 force_n;  ///< sum of all forces and pressures, on the faces as they lie; without gravity
  Vec3 gravity_mm_s2;
};

/// The convergence that `stackmesh fem --accuracy` found.
struct FemAccuracy {
  double asked_rel = 0;
  bool reached = false;
  std::vector<std::size_t> elements;  ///< of each mesh that was solved
  std::vector<double> solve_s;
  Accuracy estimate;
};

/// The solver model of `stackmesh fem`.
struct FemReport {
  int order = 2;
  std::size_t nodes = 0, elements = 0, shells = 0;
  std::size_t wedges = 0;             ///< of the elements, with pyramids
  std::string image, materials_path;  ///< "": none
  bool placeholder_materials = false;
  std::vector<FemSet> sets;
  std::vector<SurfacePair> pairs;
  std::vector<MaterialRow> materials;
  std::vector<std::pair<std::string, double>> skins;  ///< name, thickness in mm
  std::size_t supports = 0, loaded_nodes = 0;         ///< of the first step
  Vec3 force_n;                                       ///< of the first step
  std::vector<FemStep> steps;
  std::vector<Body> bodies;  ///< the largest first
  std::optional<FemAccuracy> accuracy;
  SurfaceValues faces;  ///< for the pictures alone
};

/// Everything a run reports (modules/report/README.md lists the fields of the JSON form).
struct RunReport {
  std::string version, command;
  std::vector<std::pair<std::string, std::string>> options;  ///< as given or defaulted
  struct {
    std::string path, kind;
    std::vector<std::string> files;             ///< of an input of several; path joins them
    std::array<int, 3> dimensions = {0, 0, 0};  ///< 0: no grid (contours)
    std::array<double, 3> spacing_mm = {0, 0, 0};
    std::array<double, 3> effective_spacing_mm = {0, 0, 0};  ///< of the voxels on which the labels were made
    std::string axis = "z", space = "lps";
    std::size_t sections = 0;
  } input;
  std::vector<StageTime> stages;
  double peak_rss_mb = 0;
  struct {
    std::size_t loops = 0, vertices_traced = 0, vertices = 0;
  } contours;
  struct {
    std::size_t vertices = 0, triangles = 0, open_edges = 0, self_intersections = 0, added_points = 0;
  } stitched;
  std::string surface_level = "stitched";
  std::optional<SurfaceCheck> surface;
  std::optional<Bends> bends;  ///< of the whole surface
  std::optional<VolumeCheck> volume;
  std::vector<LayerFigures> layers;  ///< of wedges, by label; places in the world
  std::string closure = "skipped";   ///< verified, failed or skipped
  std::optional<FemReport> fem;      ///< of `fem` only
  std::vector<LabelReport> labels;
  std::optional<JudgedMesh> mesh;  ///< of `validate`
  std::optional<Provenance> provenance;
  std::vector<Verdict> verdicts;  ///< in the order in which they are read
  std::vector<Defect> defects;    ///< where it fails
  Limits limits;                  ///< that the verdicts were made with
  std::vector<Warning> warnings;
};

/// The report as JSON text (schema 1).
std::string to_json(const RunReport& report);

/// Reports of several meshes against one input, with a table of them: {"schema", "command", "comparison", "meshes"}.
std::string to_json(const std::vector<RunReport>& reports);

/// Every limit by its name in the reports; NaN: none by default, and none was set.
std::vector<std::pair<std::string, double>> named_limits(const Limits& limits);

/// Limits from a JSON file of the fields that a report lists under "limits"; those left out keep their default.
/// @throws Error(input) for an unreadable file, an unknown field or what is not a number.
Limits read_limits(const std::string& path);

/// Its labels alone, for --names: {"labels": [{"label", "name", "colour"}]}.
std::string names_to_json(const RunReport& report);

}  // namespace stackmesh
