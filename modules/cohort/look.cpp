#include "cohort/look.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/sha256.h"
#include "run/input.h"
#include "run/provenance.h"

namespace stackmesh {
namespace {

using Json = nlohmann::ordered_json;

const std::vector<std::string>& value_of(const CohortCase& c, const std::string& name) {
  static const std::vector<std::string> none;
  for (const OptionValue& o : c.options)
    if (o.name == name) return o.values;
  return none;
}

bool has(const CohortCase& c, const std::string& name) {
  return std::any_of(c.options.begin(), c.options.end(), [&](const OptionValue& o) { return o.name == name; });
}

/// The value of an option of one number; none where it is not given, or per label.
std::optional<double> number_of(const CohortCase& c, const std::string& name) {
  const std::vector<std::string>& values = value_of(c, name);
  if (values.empty()) return std::nullopt;
  char* end = nullptr;
  const double number = std::strtod(values.back().c_str(), &end);
  return *end == '\0' && number > 0 ? std::optional<double>(number) : std::nullopt;
}

/// Whether an option decides on what is written.
bool changes_results(const std::string& name) {
  for (const char* other : {"threads", "progress", "quiet", "verbose", "timeout", "max-memory", "yes"})
    if (name == other) return false;
  return true;
}

/// Of a value such as "law.json" or "top=points:marks.json,3" the parts that name files: digests of their bytes.
std::string digests_in(const std::string& value) {
  std::string digests, part;
  std::error_code ignored;
  const auto take = [&](const std::string& path) {
    if (!path.empty() && std::filesystem::exists(path, ignored)) digests += " " + digest_of_input({path}).sha256;
  };
  take(value);
  if (!digests.empty()) return digests;
  for (const char c : value + "=") {
    if (c != '=' && c != ':' && c != ',' && c != '&') {
      part += c;
      continue;
    }
    if (part.find('.') != std::string::npos) take(part);
    part.clear();
  }
  return digests;
}

InputOptions input_options(const CohortCase& c) {
  InputOptions o;
  o.paths = c.inputs;
  if (!value_of(c, "label").empty()) o.labels = value_of(c, "label").back();
  if (!value_of(c, "void").empty()) o.voids = value_of(c, "void").back();
  if (!value_of(c, "series").empty()) o.series = value_of(c, "series").back();
  o.merge = has(c, "merge");
  o.allow_outside = has(c, "allow-outside");
  if (!value_of(c, "spacing").empty()) {
    std::array<double, 3> mm{};
    if (std::sscanf(value_of(c, "spacing").back().c_str(), "%lf,%lf,%lf", &mm[0], &mm[1], &mm[2]) == 3)
      o.spacing_mm = mm;
  }
  return o;
}

/// Counts voxels and the faces between different labels.
void measure(const LabelVolume& v, CaseLook& look) {
  look.voxels = v.voxels.size();
  look.labels = v.labels.empty() ? 0 : v.labels.size() - 1;
  look.pixel_mm = std::sqrt(v.voxel_volume_mm3() / *std::max_element(v.spacing_mm.begin(), v.spacing_mm.end()));
  const double face_mm2[3] = {v.spacing_mm[1] * v.spacing_mm[2], v.spacing_mm[0] * v.spacing_mm[2],
                              v.spacing_mm[0] * v.spacing_mm[1]};
  const std::size_t step[3] = {1, static_cast<std::size_t>(v.size[0]), static_cast<std::size_t>(v.size[0]) * v.size[1]};
  std::size_t labelled = 0, faces[3] = {0, 0, 0};  // a face between two labels counts for either
  for (int k = 0; k < v.size[2]; ++k)
    for (int j = 0; j < v.size[1]; ++j)
      for (int i = 0; i < v.size[0]; ++i) {
        const std::size_t at = v.index(i, j, k);
        const std::uint16_t label = v.voxels[at];
        labelled += label != 0;
        const int place[3] = {i, j, k};
        for (int a = 0; a < 3; ++a) {
          if (place[a] == 0) faces[a] += label != 0;
          const std::uint16_t next = place[a] + 1 < v.size[a] ? v.voxels[at + step[a]] : 0;
          if (next != label) faces[a] += (label != 0) + (next != 0);
        }
      }
  look.volume_mm3 = static_cast<double>(labelled) * v.voxel_volume_mm3();
  constexpr double kStairs = 1.5;  // a ball's voxel faces are half as much again as its surface
  for (int a = 0; a < 3; ++a) look.area_mm2 += static_cast<double>(faces[a]) * face_mm2[a] / kStairs;
}

/// Of contours: their walls, of a gap's height each.
void measure(const Stack& stack, CaseLook& look) {
  look.labels = stack.labels.empty() ? 0 : stack.labels.size() - 1;
  look.pixel_mm = stack.pixel_mm;
  const std::size_t n = stack.sections.size();
  const double gap_mm = n > 1 ? (stack.sections[n - 1].z_mm - stack.sections[0].z_mm) / static_cast<double>(n - 1) : 1;
  for (const Section& section : stack.sections)
    for (std::size_t k = 1; k < stack.labels.size(); ++k) {
      const double area = label_area_mm2(stack, section, stack.labels[k].number);
      look.volume_mm3 += area * gap_mm;
      look.area_mm2 += 3.545 * std::sqrt(area) * gap_mm;  // a circle's rim: 2 sqrt(pi area)
    }
  if (!(look.pixel_mm > 0)) look.pixel_mm = gap_mm;
}

// Fitted to 19 inputs of testdata and shared/data on one core, without other load (docs/cohorts.md).
constexpr double kBaseMb = 46, kMbPerMillionVoxels = 8, kMbPerTet = 0.65e-3;
constexpr double kBaseS = 0.4, kSecondsPerMillionVoxels = 0.08, kSecondsPerTet = 4e-5, kSecondsPerStitched = 2e-5;

/// Of an input that is no labels, such as a volume mesh for `fem`: by the sizes of its files.
void foretell_unread(CaseLook& look, const CohortCase& c) {
  constexpr double kMbPerMbOfFile = 10;
  look.memory_mb = kBaseMb;
  look.time_s = kBaseS;
  for (const std::string& input : c.inputs) {
    std::error_code none;
    const auto bytes = std::filesystem::file_size(input, none);
    if (!none) look.memory_mb += kMbPerMbOfFile * static_cast<double>(bytes) / 1e6;
  }
}

}  // namespace

std::string key_of_case(const CohortCase& c, const CaseCommand& command, const std::string& input_sha256) {
  Sha256 sum;
  sum.add("stackmesh " + command.version + "\ncommand " + command.name + "\n");
  for (const std::string& format : command.formats) sum.add("format " + format + "\n");
  for (const OptionValue& o : c.options) {
    if (!changes_results(o.name)) continue;
    sum.add("option " + o.name + "\n");
    for (const std::string& value : o.values) sum.add(" value " + value + digests_in(value) + "\n");
  }
  sum.add("input " + input_sha256 + "\n");
  std::error_code ignored;
  for (const std::string& input : c.inputs) {  // LABEL=FILE
    const std::size_t equal = input.find('=');
    if (equal != std::string::npos && !std::filesystem::exists(input, ignored))
      sum.add("label " + input.substr(0, equal) + "\n");
  }
  return sum.hex();
}

CaseLook identify_case(const CohortCase& c, const CaseCommand& command) {
  CaseLook look;
  look.input_sha256 = digest_of_input(c.inputs).sha256;
  look.key = key_of_case(c, command, look.input_sha256);
  return look;
}

CaseLook look_at_case(const CohortCase& c, const CaseCommand& command, const std::string& known_key) {
  CaseLook look = identify_case(c, command);
  if (look.key == known_key) return look;
  try {
    Input input = read_input(input_options(c));
    if (input.volume) measure(*input.volume, look);
    else measure(drawn_sections(input), look);
    foretell(look, c);
  } catch (const std::exception& e) {
    look.fault = e.what();
    foretell_unread(look, c);
  }
  return look;
}

void foretell(CaseLook& look, const CohortCase& c) {
  if (!(look.pixel_mm > 0)) return;
  const double pixels = look.area_mm2 / (look.pixel_mm * look.pixel_mm), stitched = 1.2 * pixels;
  double tets = std::min(1.4 * pixels, 150e3 + 50e3 * std::max(0.0, static_cast<double>(look.labels) - 1));
  if (const auto target = number_of(c, "target-tets")) tets = *target;
  if (const auto edge = number_of(c, "edge-length"))
    tets = 1.5 * look.area_mm2 / (0.433 * *edge * *edge) + look.volume_mm3 / (0.12 * std::pow(2 * *edge, 3));
  if (const auto volume = number_of(c, "max-volume")) tets = std::max(tets, 1.5 * look.volume_mm3 / *volume);
  if (const auto refine = number_of(c, "refine")) tets *= std::pow(8, *refine);
  const double millions = static_cast<double>(look.voxels) / 1e6;
  look.memory_mb = kBaseMb + kMbPerMillionVoxels * millions + kMbPerTet * std::max(tets, stitched);
  look.time_s = kBaseS + kSecondsPerMillionVoxels * millions + kSecondsPerTet * tets + kSecondsPerStitched * stitched;
}

std::string to_json(const CaseLook& l) {
  return Json{{"key", l.key},
              {"input_sha256", l.input_sha256},
              {"fault", l.fault},
              {"voxels", l.voxels},
              {"labels", l.labels},
              {"volume_mm3", l.volume_mm3},
              {"area_mm2", l.area_mm2},
              {"pixel_mm", l.pixel_mm},
              {"memory_mb", l.memory_mb},
              {"time_s", l.time_s}}
      .dump(-1, ' ', false, Json::error_handler_t::replace);
}

CaseLook case_look_of(const std::string& json) {
  const Json j = Json::parse(json);
  CaseLook l;
  l.key = j.at("key");
  l.input_sha256 = j.at("input_sha256");
  l.fault = j.at("fault");
  l.voxels = j.at("voxels");
  l.labels = j.at("labels");
  l.volume_mm3 = j.at("volume_mm3");
  l.area_mm2 = j.at("area_mm2");
  l.pixel_mm = j.at("pixel_mm");
  l.memory_mb = j.at("memory_mb");
  l.time_s = j.at("time_s");
  return l;
}

}  // namespace stackmesh
