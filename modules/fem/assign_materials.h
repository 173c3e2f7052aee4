#pragma once
#include <string>
#include <vector>

#include "base/warning.h"
#include "fem/material_law.h"
#include "model/intensity_volume.h"
#include "model/solver_model.h"

namespace stackmesh {

/// What a label was made of, for the report.
struct MaterialRow {
  Label label = 0;   ///< its number
  std::string name;  ///< its name in the model
  std::string law;   ///< "": constant
  /// of other kinds the moduli are those at small strain (orthotropic: along the fibre)
  MaterialKind kind = MaterialKind::linear;
  std::size_t elements = 0;       ///< of the label
  double young_min_mpa = 0;       ///< smallest modulus of an element
  double young_mean_mpa = 0;      ///< mean over the volume
  double young_max_mpa = 0;       ///< largest modulus of an element
  double poisson = 0;             ///< Poisson's ratio
  double density_mean_t_mm3 = 0;  ///< mean mass density; 0: none
  double clamped_low = 0;         ///< share of its elements set to the floor
  double clamped_high = 0;        ///< share of its elements set to the ceiling
  std::size_t materials = 1;      ///< bins
  double bin_error_rel = 0;       ///< largest |bin's modulus / element's modulus - 1|
  std::size_t voxels = 0;         ///< of the image, inside the label
};

/// What every label was made of.
struct MaterialReport {
  std::vector<MaterialRow> labels;  ///< ascending
  std::vector<Warning> warnings;    ///< of intensities, margins and fibres
};

/// Checks a plan against the labels (with their solver names) before anything long begins.
/// @throws Error(input): a law that names a label that is not there, a label that it leaves without material;
/// Error(usage): a law of one of the labels without an image
void check_plan(const MaterialPlan& plan, const std::vector<LabelInfo>& labels, bool has_image);

/// Gives every element its material: constant by label, or from the image's intensities by a law. Only voxels inside
/// the label (less a margin) speak for it. The modulus of each element is kept, and binned for decks that need a
/// material for each. Skins get theirs. Without a plan, every label gets a placeholder.
/// @param plan nullptr: none; @param image nullptr: none; it lies in LPS, whatever the space of the mesh
/// @throws Error(input): a label or skin without material, a law that names a label that is not there, an image that
/// does not cover an element of a label with a law, an element whose modulus is not positive (it is named);
/// Error(usage): a law without an image
MaterialReport assign_materials(SolverModel& model, const MaterialPlan* plan, const IntensityVolume* image);

}  // namespace stackmesh
