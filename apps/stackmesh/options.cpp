#include "options.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <set>

#include "base/error.h"
#include "base/memory.h"
#include "base/text.h"
#include "base/warning.h"
#include "slicer_module.h"

namespace stackmesh::app {
namespace {

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> out = {""};
  for (char c : text) {
    if (c == at) out.emplace_back();
    else out.back() += c;
  }
  return out;
}

/// The whole text as a finite number.
std::optional<double> to_number(const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !std::isfinite(value)) return std::nullopt;
  return value;
}

Caps caps_named(const std::string& name) {
  if (name == "auto") return Caps::automatic;
  if (name == "flat") return Caps::flat;
  if (name == "round") return Caps::round;
  fail_usage("unknown cap '" + name + "'", "--caps", "choose auto, flat or round, or per label 5=flat,9=round");
}

}  // namespace

void InputArguments::add_to(CLI::App& command, bool selection) {
  command
      .add_option("INPUT", paths,
                  "label volume, DICOM (RTSTRUCT, SEG, series), folder or quoted glob of slices or masks, .cnt file(s) "
                  "or LABEL=FILE.cnt")
      ->required();
  command.add_option("--spacing", spacing, "X,Y,Z mm of a PNG/TIFF stack");
  command.add_option("--series", series, "DICOM: series instance UID where a folder holds several");
  command.add_flag("--allow-outside", allow_outside,
                   "a detached header (.nhdr, .mhd) may name data files outside of its own folder");
  add_memory_option(command);
  if (!selection) return;
  command.add_option("--label", labels, "labels to use by number or name: 1,4,7-9,femur_left (default: all)");
  command.add_flag("--merge", merge, "selected labels become one, numbered as the smallest");
}

InputOptions InputArguments::options() const {
  InputOptions o;
  o.paths = paths;
  o.labels = labels;
  o.series = series;
  o.merge = merge;
  o.allow_outside = allow_outside;
  if (!spacing.empty()) {
    const std::vector<std::string> parts = split(spacing, ',');
    if (parts.size() != 3)
      fail_usage("--spacing needs three numbers", "'" + spacing + "'", "write --spacing X,Y,Z in mm");
    std::array<double, 3> s{};
    for (int i = 0; i < 3; ++i) {
      s[i] = parse_number(parts[i], "--spacing");
      if (s[i] <= 0) fail_usage("--spacing must be positive", "'" + spacing + "'", "write --spacing X,Y,Z in mm");
    }
    o.spacing_mm = s;
  }
  return o;
}

void ContourArguments::add_to(CLI::App& command) {
  command.add_option("--axis", axis, "stacking axis: auto (the coarsest spacing), x, y or z")->capture_default_str();
  command
      .add_option("--simplify", simplify_px,
                  "largest deviation of a simplified contour in pixels (default: 0.05, with --band 0 0.5); 0 keeps "
                  "every vertex")
      ->check(number_in(0, 1000, "a number from 0 to 1000"));
  command
      .add_option("--band", band_px,
                  "how far a contour may leave the middle between pixel centres, in pixels: up to 0.5 every voxel "
                  "centre keeps its label; more smooths "
                  "labels that were drawn slice by slice; 0 keeps the pixels' own outlines")
      ->check(number_in(0, 3, "a number from 0 to 3"))
      ->capture_default_str();
  command.add_flag("--as-stored", as_stored,
                   "take labels that are stored finer than they were made as they are stored");
  command.add_option("--threads", threads, "threads (default: all)")->check(CLI::Range(1, 1024));
}

SectionOptions ContourArguments::options() const {
  SectionOptions out;
  ContourOptions& o = out.contours;
  if (simplify_px >= 0) out.simplify_px = simplify_px;
  out.band_px = band_px;
  out.as_stored = as_stored;
  o.threads = threads;
  if (axis == "auto") o.axis = StackAxis::automatic;
  else if (axis == "x") o.axis = StackAxis::x;
  else if (axis == "y") o.axis = StackAxis::y;
  else if (axis == "z") o.axis = StackAxis::z;
  else fail_usage("unknown axis '" + axis + "'", "--axis", "choose auto, x, y or z");
  return out;
}

void TerminalArguments::add_to(CLI::App& command) {
  command.add_option("--progress", progress, "auto, plain or none, on stderr; slicer, as 3D Slicer reads it on stdout")
      ->check(CLI::IsMember({"auto", "plain", "none", "slicer"}))
      ->capture_default_str();
  command.add_flag("--quiet", quiet, "only errors");
  command.add_flag("--verbose", verbose, "a line per stage, as --progress plain");
}

std::unique_ptr<Monitor> TerminalArguments::make_progress() const {
  if (for_slicer()) return make_slicer_progress();
  return make_terminal_monitor(quiet || progress == "none"      ? ProgressMode::none
                               : verbose || progress == "plain" ? ProgressMode::plain
                                                                : ProgressMode::automatic);
}

CLI::Validator number_in(double low, double high, const std::string& what) {
  return CLI::Validator(
      [=](std::string& text) {
        const std::optional<double> value = to_number(text);
        return value && *value >= low && *value <= high ? std::string() : "'" + text + "' is not " + what;
      },
      "", "number_in");
}

double parse_number(const std::string& text, const std::string& option) {
  const std::optional<double> value = to_number(text);
  if (!value) fail_usage("'" + text + "' is not a number", option, "see --help");
  return *value;
}

std::vector<std::pair<std::string, double>> parse_sizes(const std::string& text, const std::string& option,
                                                        const std::string& what, const std::string& unit,
                                                        std::optional<double>& all) {
  const std::string mend = "write " + option + " 2.0, or per label 5=2.0,9=1.0, in " + unit;
  std::vector<std::pair<std::string, double>> per_label;
  for (const std::string& item : split(text, ',')) {
    const std::size_t at = item.find('=');
    const bool by_label = text.find('=') != std::string::npos;
    if (by_label != (at != std::string::npos) || at == 0 || (!by_label && item != text))
      fail_usage("'" + text + "' is no " + what, option, mend);
    const double size = parse_number(by_label ? item.substr(at + 1) : item, option);
    if (size <= 0) fail_usage("'" + item + "' is not above 0", option, mend);
    if (by_label) per_label.emplace_back(item.substr(0, at), size);
    else all = size;
  }
  return per_label;
}

LayerTexts parse_layers(const std::vector<std::string>& texts) {
  const std::string mend = "write --layer 5=1.5,3: label, thickness in mm, number of wedges";
  LayerTexts out;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('='), comma = text.find(',', equals == std::string::npos ? 0 : equals);
    if (equals == std::string::npos || equals == 0 || comma == std::string::npos)
      fail_usage("'" + text + "' is no layer", "--layer", mend);
    LayerSize size;
    size.thickness_mm = parse_number(text.substr(equals + 1, comma - equals - 1), "--layer");
    if (!(size.thickness_mm > 0))
      fail_usage("the thickness '" + text.substr(equals + 1, comma - equals - 1) + "' is not above 0", "--layer", mend);
    const std::string count = text.substr(comma + 1);
    const bool digits =
        !count.empty() && count.size() <= 3 && count.find_first_not_of("0123456789") == std::string::npos;
    if (!digits || std::stoi(count) < 1 || std::stoi(count) > 100)
      fail_usage("the number of wedges '" + count + "' is not a whole number from 1 to 100", "--layer", mend);
    size.count = std::stoi(count);
    out.emplace_back(text.substr(0, equals), size);
  }
  return out;
}

std::optional<int> parse_interpolate(const std::string& text) {
  if (text == "auto") return std::nullopt;
  const bool digits = !text.empty() && text.size() <= 4 && text.find_first_not_of("0123456789") == std::string::npos;
  if (!digits || std::stoi(text) > 1000)
    fail_usage("'" + text + "' is not auto or a whole number from 0 to 1000", "--interpolate", "see --help");
  return std::stoi(text);
}

void parse_caps(const std::string& text, Caps& all, std::vector<std::pair<std::string, LabelEndCaps>>& per_label) {
  if (text.find('=') == std::string::npos) {
    all = caps_named(text);
    return;
  }
  const auto ends_of = [&](const std::string& label) -> LabelEndCaps& {
    for (auto& [l, caps] : per_label)
      if (l == label) return caps;
    per_label.emplace_back(label, LabelEndCaps{});
    return per_label.back().second;
  };
  std::string of_ends;          // the label whose ends were named last
  std::set<std::string> named;  // ends
  for (const std::string& item : split(text, ',')) {
    const std::size_t at = item.find('=');
    if (at == std::string::npos || at == 0)
      fail_usage("'" + item + "' names no label", "--caps " + text,
                 "write --caps 5=flat,9=round, or --caps 1:high=flat,low=round for either end");
    const std::string left = item.substr(0, at);
    const Caps caps = caps_named(item.substr(at + 1));
    const std::size_t colon = left.rfind(':');
    const std::string end = colon == std::string::npos ? left : left.substr(colon + 1);
    const bool names_end =
        (end == "low" || end == "high") && (colon != std::string::npos ? colon > 0 : !of_ends.empty());
    if (!names_end) {
      per_label.emplace_back(left, LabelEndCaps{caps, caps});
      of_ends.clear();
      continue;
    }
    if (colon != std::string::npos) of_ends = left.substr(0, colon);
    if (!named.insert(of_ends + ':' + end).second)
      fail_usage("the " + end + " end of label '" + of_ends + "' is named twice", "--caps " + text,
                 "name each end once");
    (end == "low" ? ends_of(of_ends).low : ends_of(of_ends).high) = caps;
  }
}

void add_memory_option(CLI::App& command) {
  command.add_option_function<std::string>(
      "--max-memory", [](const std::string& text) { set_memory_limit(parse_memory(text, "--max-memory")); },
      "most memory that this process, and each that it starts, may take: 4GB, 512MB (default: what the machine or its "
      "control group has)");
}

void print_warnings(const std::vector<Warning>& warnings) {
  for (const Warning& w : warnings) std::fprintf(stderr, "stackmesh: warning: %s\n", printable(w.text).c_str());
}

}  // namespace stackmesh::app
