#include "fem/material_law.h"

#include <cmath>

namespace stackmesh {
namespace {

/// Factor to MPa or t/mm3; 0 for an unknown unit.
double to_mpa(const std::string& unit) {
  return unit == "MPa" ? 1 : unit == "GPa" ? 1e3 : unit == "Pa" ? 1e-6 : 0;
}
double to_t_mm3(const std::string& unit) {
  return unit == "g/cm3" ? 1e-9 : unit == "mg/cm3" || unit == "kg/m3" ? 1e-12 : unit == "t/mm3" ? 1 : 0;
}

double apply(const LawStep& step, double x) {
  const LawPiece* piece = &step.pieces.back();
  for (const LawPiece& p : step.pieces)
    if (x <= p.up_to) {
      piece = &p;
      break;
    }
  const double power = piece->exponent == 1 ? x : x > 0 ? std::pow(x, piece->exponent) : 0;
  return piece->offset + piece->factor * power;
}

}  // namespace

ModulusLaw::Value ModulusLaw::at(double intensity) const {
  Value value;
  double x = intensity;
  for (const LawStep& step : steps) {
    x = apply(step, x);
    if (to_t_mm3(step.unit) > 0) value.density_t_mm3 = std::max(0.0, x * to_t_mm3(step.unit));
    else value.young_mpa = x * to_mpa(step.unit);
  }
  return value;
}

}  // namespace stackmesh
