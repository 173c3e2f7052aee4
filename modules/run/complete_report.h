#pragma once
#include <vector>

#include "model/complex.h"
#include "model/label_volume.h"
#include "model/stack.h"
#include "model/tet_mesh.h"
#include "report/run_report.h"

namespace stackmesh {

/// A row for each label, with its number, name and colour.
void add_label_rows(RunReport& report, const std::vector<LabelInfo>& labels);

/// Checks a given surface, and the tetrahedra that it bounds (nullptr: none): gives the report its `surface`, `volume`
/// and `closure`.
void check_mesh(RunReport& report, const InterfaceComplex& surface, const TetMesh* mesh, int threads);

/// Gives the row of each label what `surface`, `volume` and the fidelity (nullptr: not measured) say of it.
void fill_label_rows(RunReport& report, const std::vector<LabelFidelity>* fidelity = nullptr);

/// What a report is about, once surface (and volume) are checked. Pointers may be null.
struct Judged {
  const InterfaceComplex* surface = nullptr;  ///< in the frame of the labels, LPS
  const TetMesh* mesh = nullptr;
  const LabelVolume* volume = nullptr;  ///< tells pixels and slices
  int axis = 2;                         ///< along which they are stacked
  const Stack* sections = nullptr;      ///< of contour input
  const std::vector<LabelFidelity>* fidelity = nullptr;
  int threads = 0;
};

/// Completes a report that holds `surface`, `volume`, `limits` and a row for each label with its number, name and input
/// volume: fills the rows, measures thickness and bends, gives the verdicts and finds the defects.
void complete_report(RunReport& report, const Judged& judged);

}  // namespace stackmesh
