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
  Label label = 0;                                    ///< its number
  std::string name;                                   ///< "": none
  std::optional<std::array<std::uint8_t, 3>> colour;  ///< red, green, blue, where the input has one
  bool is_void = false;                               ///< it bounds the others and is not filled
  bool closed = false;                                ///< its surface is
  int components = 0;                                 ///< solid pieces of its surface
  std::optional<int> input_components;                ///< 6-connected components of its voxels; none of contours
  long euler = 0;                                     ///< Euler number of its surface
  std::optional<double> input_volume_mm3;             ///< voxels; none for contour input
  double surface_volume_mm3 = 0;                      ///< that its surface encloses
  std::optional<double> tet_volume_mm3;               ///< of its elements; none of a surface alone
  std::optional<std::size_t> tets;                    ///< its tetrahedra; none of a surface alone
  std::optional<double> dice;                         ///< the next six: LabelFidelity; none where there are no voxels
  std::optional<std::size_t> wrong_centres;           ///< voxel centres
  std::optional<double> wrong_centres_share;          ///< of its voxels
  std::optional<BandDistance> band_distance_mm;       ///< of its surface outside of the band
  std::optional<Distance> distance_mm;                ///< of its voxel faces from its surface
  std::optional<Distance> reverse_distance_mm;        ///< of its surface from its voxel faces
  std::string cap_low;                                ///< how it ends at its first section: "flat" or "round"
  std::string cap_high;                               ///< how it ends at its last section
  std::optional<long> genus;                          ///< handles of all its shells; none unless closed
  double surface_area_mm2 = 0;                        ///< of its surface
  double angle_min_deg = 0;                           ///< smallest angle of a triangle of its surface
  std::optional<double> dihedral_min_deg;             ///< smallest dihedral angle of its tetrahedra
  std::optional<double> dihedral_max_deg;             ///< largest dihedral angle of its tetrahedra
  std::optional<double> thin_share;                   ///< LabelThickness::thin_share
  std::optional<double> thickness_p5_mm;              ///< LabelThickness::p5_mm
  std::optional<std::size_t> wedges;                  ///< of layers, with pyramids
  std::size_t nonmanifold_edges = 0;                  ///< where it touches itself
  std::optional<double> mean_bend_deg;                ///< Bends::mean_deg
  std::optional<double> bends_above_40_share;         ///< Bends::above_40_share
};

/// The mesh that `validate` judged, as its file told it.
struct JudgedMesh {
  std::string path;           ///< of the file
  std::string format;         ///< in words
  std::size_t vertices = 0;   ///< in the file, before anything was joined or left out
  std::size_t triangles = 0;  ///< in the file
  std::size_t tets = 0;       ///< in the file
  std::size_t wedges = 0;     ///< in the file, with pyramids
  int order = 1;              ///< 2: tets of 10 nodes
  std::string labels;         ///< where its labels came from, and which label of the input each stands for
  std::string space;          ///< "lps", "ras" or "none"
  std::string space_reason;   ///< why that one
  std::string sha256;         ///< of the file; "" without a report
};

/// Where a report comes from. Nothing of an image header goes in but grid and labels.
struct Provenance {
  std::string input_sha256;     ///< of the file; of several: of the lines "digest  name" in order of name
  std::size_t input_files = 0;  ///< how many there were
  std::string compiler;         ///< with its version
  std::string build_type;       ///< of CMake
  std::string program_sha256;   ///< of the program's file
  std::string processor;        ///< its model
  std::string system;           ///< name and version
  int cores = 0;                ///< of the machine
  double memory_gib = 0;        ///< of the machine
  std::string finished_utc;     ///< ISO 8601
};

/// A set of a solver model.
struct FemSet {
  std::string name;       ///< as in the deck
  std::string note;       ///< what it is
  std::size_t nodes = 0;  ///< how many
  std::size_t faces = 0;  ///< how many; 0: a node set only
};

/// A step of a solver model.
struct FemStep {
  std::string name;                  ///< as the law file calls it
  bool frequency = false;            ///< natural frequencies; false: static
  bool large_displacements = false;  ///< requested, or needed by a material
  std::size_t supports = 0;          ///< sets and points that are held or moved
  std::size_t loaded_nodes = 0;      ///< nodes and points on which forces act
  std::size_t pressures = 0;         ///< sets under pressure
  Vec3 force_n;                      ///< sum of all forces and pressures, on the faces as they lie; without gravity
  Vec3 gravity_mm_s2;                ///< acceleration of every body
};

/// The convergence that `stackmesh fem --accuracy` found.
struct FemAccuracy {
  double asked_rel = 0;               ///< the error that was requested, as a share
  bool reached = false;               ///< the last mesh is as accurate
  std::vector<std::size_t> elements;  ///< of each mesh that was solved
  std::vector<double> solve_s;        ///< seconds that CalculiX took for each
  Accuracy estimate;                  ///< of the last mesh
};

/// The solver model of `stackmesh fem`.
struct FemReport {
  int order = 2;                                      ///< of the elements
  std::size_t nodes = 0;                              ///< of the mesh
  std::size_t elements = 0;                           ///< tetrahedra, wedges and pyramids
  std::size_t shells = 0;                             ///< faces with a skin
  std::size_t wedges = 0;                             ///< of the elements, with pyramids
  std::string image;                                  ///< file of the intensities; "": none
  std::string materials_path;                         ///< law file; "": none
  bool placeholder_materials = false;                 ///< no law was given: E = 1 MPa
  std::vector<FemSet> sets;                           ///< of nodes
  std::vector<SurfacePair> pairs;                     ///< parts that touch
  std::vector<MaterialRow> materials;                 ///< by label
  std::vector<std::pair<std::string, double>> skins;  ///< name, thickness in mm
  std::size_t supports = 0;                           ///< of the first step
  std::size_t loaded_nodes = 0;                       ///< of the first step
  Vec3 force_n;                                       ///< of the first step
  std::vector<FemStep> steps;                         ///< in sequence
  std::vector<Body> bodies;                           ///< the largest first
  std::optional<FemAccuracy> accuracy;                ///< with --accuracy
  SurfaceValues faces;                                ///< for the pictures alone
};

/// Everything a run reports (modules/report/README.md lists the fields of the JSON form).
struct RunReport {
  std::string version;                                       ///< of the program
  std::string command;                                       ///< "mesh", "surface", "fem" or "validate"
  std::vector<std::pair<std::string, std::string>> options;  ///< as given or defaulted
  /// What was read.
  struct {
    std::string path;                                        ///< as the user named it
    std::string kind;                                        ///< such as "nifti"
    std::vector<std::string> files;                          ///< of an input of several; path joins them
    std::array<int, 3> dimensions = {0, 0, 0};               ///< 0: no grid (contours)
    std::array<double, 3> spacing_mm = {0, 0, 0};            ///< of its voxels
    std::array<double, 3> effective_spacing_mm = {0, 0, 0};  ///< of the voxels on which the labels were made
    std::string axis = "z";                                  ///< along which slices are stacked
    std::string space = "lps";                               ///< of the mesh: "lps", "ras" or "none"
    std::size_t sections = 0;                                ///< without virtual ones
  } input;
  std::vector<StageTime> stages;  ///< in their order
  double peak_rss_mb = 0;         ///< largest memory of the run
  /// LabelMesh::contours.
  struct {
    std::size_t loops = 0;            ///< closed borders that were traced
    std::size_t vertices_traced = 0;  ///< before simplification
    std::size_t vertices = 0;         ///< after it
  } contours;
  /// LabelMesh::stitched.
  struct {
    std::size_t vertices = 0;            ///< of the stitched surface
    std::size_t triangles = 0;           ///< of it
    std::size_t open_edges = 0;          ///< SurfaceCheck::open_edges of it
    std::size_t self_intersections = 0;  ///< SurfaceCheck::self_intersections of it
    std::size_t added_points = 0;        ///< that no section has
  } stitched;
  std::string surface_level = "stitched";  ///< to_text() of the SurfaceLevel
  std::optional<SurfaceCheck> surface;     ///< what the checks say of the final surface
  std::optional<Bends> bends;              ///< of the whole surface
  std::optional<VolumeCheck> volume;       ///< what the checks say of the final tetrahedra
  std::vector<LayerFigures> layers;        ///< of wedges, by label; places in the world
  std::string closure = "skipped";         ///< verified, failed or skipped
  std::optional<FemReport> fem;            ///< of `fem` only
  std::vector<LabelReport> labels;         ///< one row a label
  std::optional<JudgedMesh> mesh;          ///< of `validate`
  std::optional<Provenance> provenance;    ///< where a report was requested
  std::vector<Verdict> verdicts;           ///< in the order in which they are read
  std::vector<Defect> defects;             ///< where it fails
  Limits limits;                           ///< that the verdicts were made with
  std::vector<Warning> warnings;           ///< of all stages
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
