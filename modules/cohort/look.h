#pragma once
#include <cstdint>
#include <string>

#include "cohort/cohort_case.h"

namespace stackmesh {

/// What a short look at a case's input tells before it is meshed.
struct CaseLook {
  std::string key;           ///< see key_of_case; empty where the input has no file that can be read
  std::string input_sha256;  ///< over the bytes of the input's files, in hexadecimal
  std::string fault;         ///< why the input cannot be read, one line; empty where it can, or where it was not tried
  std::size_t voxels = 0;    ///< of the whole grid, background included; 0 for contours and where it was not read
  std::size_t labels = 0;    ///< that are requested, without the background
  double volume_mm3 = 0;     ///< of all labels
  /// of the voxel faces between different labels, border included, over 1.5: about the surface
  double area_mm2 = 0;
  /// root of a pixel's area across the coarsest axis; of contours Stack::pixel_mm, or the gap; 0: was not read
  double pixel_mm = 0;
  double memory_mb = 0;  ///< foretold: largest resident set
  double time_s = 0;     ///< foretold: on one free core
};

/// What decides whether a finished case stands: SHA-256 over the program's version, the command, the formats, the
/// options (without those that change no result: threads, progress, quiet, verbose, timeout, max-memory, yes), the
/// bytes of the input's files and of files that options name.
std::string key_of_case(const CohortCase& c, const CaseCommand& command, const std::string& input_sha256);

/// Digest and key alone, without a look at the voxels.
CaseLook identify_case(const CohortCase& c, const CaseCommand& command);

/// Reads the input once: key, sizes, and from them memory and time, by figures measured with this version
/// (docs/cohorts.md).
/// @param c the case; its own options are among those of all
/// @param command whose name, version and formats go into the key
/// @param known_key of a result that is there: where it is the case's key, the voxels are not read
CaseLook look_at_case(const CohortCase& c, const CaseCommand& command, const std::string& known_key);

/// Fills in memory_mb and time_s from the sizes and the case's options.
void foretell(CaseLook& look, const CohortCase& c);

/// The look as JSON, for the pipe between the process that looks and the one that runs the cases.
std::string to_json(const CaseLook& look);
/// The look that came through the pipe. @throws nlohmann::json::exception for text that is none or was cut off
CaseLook case_look_of(const std::string& json);

}  // namespace stackmesh
