#pragma once
#include <CLI/CLI.hpp>
#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/monitor.h"
#include "base/warning.h"
#include "run/input.h"
#include "run/layers.h"
#include "sections/volume_sections.h"
#include "stitch/stitch.h"

namespace stackmesh::app {

/// INPUT, --spacing, --label, --merge: what every command that reads labels takes.
struct InputArguments {
  std::vector<std::string> paths;
  std::string spacing, labels, series;
  bool merge = false, allow_outside = false;
  void add_to(CLI::App& command, bool selection);
  InputOptions options() const;  ///< @throws Error(usage)
};

/// --axis, --simplify, --threads.
struct ContourArguments {
  std::string axis = "auto";
  double simplify_px = -1;  // below 0: the default
  double band_px = 0.5;
  bool as_stored = false;
  int threads = 0;
  void add_to(CLI::App& command);
  SectionOptions options() const;  ///< @throws Error(usage)
};

/// --progress, --quiet, --verbose.
struct TerminalArguments {
  std::string progress = "auto";
  bool quiet = false, verbose = false;
  bool for_slicer() const { return progress == "slicer"; }
  void add_to(CLI::App& command);
  std::unique_ptr<Monitor> make_progress() const;
};

/// Accepts finite numbers of [low, high]; `what` names them in an error: "a number above 0".
CLI::Validator number_in(double low, double high, const std::string& what);

/// A finite number, or "not a number" as Error(usage) naming the option.
double parse_number(const std::string& text, const std::string& option);

/// "2.0" sets `all`; "5=2.0,9=1.0" is returned per label; all above 0. `what` it is and its `unit` are for errors.
/// @throws Error(usage)
std::vector<std::pair<std::string, double>> parse_sizes(const std::string& text, const std::string& option,
                                                        const std::string& what, const std::string& unit,
                                                        std::optional<double>& all);

/// Each "LABEL=MM,COUNT": the thickness of a layer of wedges, above 0, and how many there are over each other, from 1
/// to 100. @throws Error(usage)
LayerTexts parse_layers(const std::vector<std::string>& texts);

/// "auto" (no value) or a whole number from 0 to 1000. @throws Error(usage)
std::optional<int> parse_interpolate(const std::string& text);

/// "auto", "flat", "round", or per label "5=flat,9=round", or per label and end "1:high=flat,low=round" (an end that is
/// not named is automatic). @throws Error(usage)
void parse_caps(const std::string& text, Caps& all, std::vector<std::pair<std::string, LabelEndCaps>>& per_label);

/// --max-memory, which takes effect when it is read.
void add_memory_option(CLI::App& command);

/// A warning as a line on stderr.
void print_warnings(const std::vector<Warning>& warnings);

}  // namespace stackmesh::app
