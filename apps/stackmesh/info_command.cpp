#include <cstdio>
#include <nlohmann/json.hpp>

#include "base/text.h"
#include "commands.h"
#include "fair/true_grid.h"
#include "options.h"

namespace stackmesh::app {
namespace {

using Json = nlohmann::ordered_json;

Json colour_of(const LabelInfo& label) {
  return label.colour ? Json(*label.colour) : Json(nullptr);
}

/// @param s of contours
Json describe(const Input& input, const Stack& s, const std::array<double, 3>& made_mm) {
  Json j = {{"path", input.path}, {"kind", input.kind}};
  Json labels = Json::array();
  if (input.volume) {
    const LabelVolume& v = *input.volume;
    j["dimensions"] = v.size;
    j["spacing_mm"] = v.spacing_mm;
    j["effective_spacing_mm"] = made_mm;
    j["origin_mm"] = {v.origin_mm.x, v.origin_mm.y, v.origin_mm.z};
    Json direction = Json::array();
    for (const Vec3& a : v.axes) direction.push_back({a.x, a.y, a.z});
    j["direction"] = direction;
    j["space"] = v.anatomical ? "lps" : "none";
    j["axis"] = std::string(1, "xyz"[stacking_axis(v, StackAxis::automatic)]);
    const std::vector<std::size_t> counts = count_voxels(v);
    for (std::size_t k = 1; k < v.labels.size(); ++k)
      labels.push_back({{"label", v.labels[k].number},
                        {"name", v.labels[k].name},
                        {"colour", colour_of(v.labels[k])},
                        {"voxels", counts[k]},
                        {"volume_mm3", static_cast<double>(counts[k]) * v.voxel_volume_mm3()}});
  } else {
    j["space"] = input.anatomical ? "lps" : "none";
    j["sections"] = s.sections.size();
    j["z_mm"] = {s.sections.front().z_mm, s.sections.back().z_mm};
    for (std::size_t k = 1; k < s.labels.size(); ++k) {
      std::size_t sections = 0;
      double area = 0;
      for (const Section& section : s.sections) {
        const double a = label_area_mm2(s, section, s.labels[k].number);
        sections += a > 0 ? 1 : 0;
        area = std::max(area, a);
      }
      labels.push_back({{"label", s.labels[k].number},
                        {"name", s.labels[k].name},
                        {"colour", colour_of(s.labels[k])},
                        {"sections", sections},
                        {"largest_area_mm2", area}});
    }
  }
  j["labels"] = labels;
  j["warnings"] = texts_of(input.warnings);
  return j;
}

/// @param s of contours
void print(const Input& input, const Stack& s, const std::array<double, 3>& made_mm) {
  std::printf("%s (%s)\n", printable(input.path).c_str(), input.kind.c_str());
  if (input.volume) {
    const LabelVolume& v = *input.volume;
    std::printf("dimensions %d x %d x %d voxels, spacing %g x %g x %g mm, stacked along %c\n", v.size[0], v.size[1],
                v.size[2], v.spacing_mm[0], v.spacing_mm[1], v.spacing_mm[2],
                "xyz"[stacking_axis(v, StackAxis::automatic)]);
    if (made_mm != v.spacing_mm)
      std::printf("made on    voxels of %.4g x %.4g x %.4g mm, stored finer\n", made_mm[0], made_mm[1], made_mm[2]);
    std::printf("origin     %g, %g, %g mm%s\n", v.origin_mm.x, v.origin_mm.y, v.origin_mm.z,
                v.anatomical ? " (LPS)" : " (no anatomy)");
    for (int a = 0; a < 3; ++a)
      std::printf("%s %8.5f %8.5f %8.5f\n", a == 0 ? "axes      " : "          ", v.axes[a].x, v.axes[a].y,
                  v.axes[a].z);
    const std::vector<std::size_t> counts = count_voxels(v);
    std::printf("%8s %12s %14s  %s\n", "label", "voxels", "volume mm3", "name");
    for (std::size_t k = 1; k < v.labels.size(); ++k)
      std::printf("%8d %12zu %14.1f  %s\n", v.labels[k].number, counts[k],
                  static_cast<double>(counts[k]) * v.voxel_volume_mm3(), printable(v.labels[k].name).c_str());
  } else {
    std::printf("sections   %zu, from z = %g to %g mm\n", s.sections.size(), s.sections.front().z_mm,
                s.sections.back().z_mm);
    for (std::size_t k = 1; k < s.labels.size(); ++k)
      std::printf("%8d  %s\n", s.labels[k].number, printable(s.labels[k].name).c_str());
  }
}

/// An input as it is described.
struct Read {
  Input input;
  Stack sections;  ///< of contours
  std::array<double, 3> made_mm = {0, 0, 0};
};

Read read(const InputOptions& options) {
  Read r;
  r.input = read_input(options);
  if (!r.input.volume) {
    r.sections = drawn_sections(r.input);
    return r;
  }
  r.made_mm = r.input.volume->spacing_mm;
  if (const auto grid = find_true_grid(*r.input.volume, 0)) r.made_mm = grid->volume.spacing_mm;
  return r;
}

std::string to_json(const Read& r) {
  return describe(r.input, r.sections, r.made_mm).dump(1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

std::string info_json(const InputOptions& input) {
  return to_json(read(input));
}

void add_info_command(CLI::App& program) {
  CLI::App* command = program.add_subcommand("info", "Dimensions, spacing, direction and labels of an input");
  auto input = std::make_shared<InputArguments>();
  auto json = std::make_shared<bool>(false);
  input->add_to(*command, false);
  command->add_flag("--json", *json, "as JSON");
  command->callback([input, json] {
    const Read r = read(input->options());
    if (*json) {
      std::printf("%s\n", to_json(r).c_str());
      return;
    }
    print(r.input, r.sections, r.made_mm);
    print_warnings(r.input.warnings);
  });
}

}  // namespace stackmesh::app
