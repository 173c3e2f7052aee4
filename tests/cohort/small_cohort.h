#pragma once
// Small inputs, and cohorts of them, for the tests of this folder.
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "program.h"

namespace cohort_test {

using program::Ended;
using program::Json;

/// An NRRD of a box of label 1 in a volume of that size, with a box of label 2 on top of it where `second`.
std::string box_volume(int width, int height, bool second = false, double spacing_mm = 1);

/// A test with a folder: inputs in in/, the manifest in/cases.csv, the cohort out/cohort.
class CohortTest : public program::ProgramTest {
 protected:
  std::string cohort() const { return out("cohort"); }
  std::string in_cohort(const std::string& name) const { return cohort() + "/" + name; }
  /// a, b and c are good boxes, `bad` is no volume.
  std::string four_cases() const;
  /// stackmesh batch in/cases.csv -o out/cohort WORDS...
  Ended batch(const std::vector<std::string>& words = {}) const;
  Json json(const std::string& name) const;
  /// How often the journal names an event of a case.
  int times(const std::string& event, const std::string& id) const;
  std::vector<std::string> names() const;  ///< in the cohort's folder, sorted, without .cohort
};

}  // namespace cohort_test
