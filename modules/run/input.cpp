#include "run/input.h"

#include <algorithm>
#include <cstdio>

#include "base/error.h"
#include "base/text.h"
#include "base/warning.h"
#include "fair/true_grid.h"
#include "image/dicom_series.h"
#include "image/read_contours.h"
#include "image/read_label_table.h"
#include "image/read_labels.h"
#include "image/read_structure_set.h"
#include "model/label_table.h"
#include "sections/polygons.h"

namespace stackmesh {
namespace {

/// How the drawn labels are to end.
void choose_caps(const InputOptions& options, Input& input) {
  input.drawn.caps = options.caps;
  input.drawn.label_caps = LabelTable(input.contours).values(options.label_caps, "--caps");
}

/// The labels that contours are drawn of, ascending.
std::vector<LabelInfo> labels_of(const std::vector<LabelContours>& contours) {
  std::vector<LabelInfo> labels;
  for (const LabelContours& f : contours) labels.push_back({f.label, f.name, f.colour});
  std::stable_sort(labels.begin(), labels.end(),
                   [](const LabelInfo& a, const LabelInfo& b) { return a.number < b.number; });
  return labels;
}

void read_contours(const InputOptions& options, Input& input) {
  if (options.spacing_mm)
    fail_usage("--spacing is for PNG/TIFF slices", options.paths[0], "leave it out: contour files are in mm");
  std::vector<LabelContours> files;
  for (const std::string& path : options.paths) {
    if (!is_contour_input(path))
      fail_usage("a contour file cannot be mixed with other input", path, "give .cnt files only");
    files.push_back(read_contour_file(path));
  }
  // Files that only have a name get the free numbers in order; several bare files count up.
  std::vector<Label> taken;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const bool bare = files.size() > 1 && options.paths[i].find('=') == std::string::npos;
    if (bare) files[i].label = 0;
    if (files[i].label != 0) taken.push_back(files[i].label);
  }
  Label next = 1;
  for (LabelContours& f : files) {
    input.warnings.insert(input.warnings.end(), f.warnings.begin(), f.warnings.end());
    if (f.label != 0) continue;
    while (std::find(taken.begin(), taken.end(), next) != taken.end()) ++next;
    f.label = next++;
  }
  if (!options.labels.empty()) {
    std::vector<LabelContours> chosen;
    for (std::size_t k : LabelTable(files).resolve(options.labels)) chosen.push_back(files[k]);
    files = std::move(chosen);
  }
  input.kind = "contours";
  input.contours = std::move(files);
}

void read_structures(const InputOptions& options, const std::string& path, Input& input) {
  if (options.spacing_mm) fail_usage("--spacing is for PNG/TIFF slices", path, "leave it out: contours are in mm");
  StructureSet set = read_structure_set(path, options.labels);
  input.warnings = std::move(set.warnings);
  ContourStackOptions& contours = input.drawn;
  contours.slices = true;
  contours.same_height_mm = 0.01;
  contours.first_wins = !options.labels.empty();
  contours.report_overlaps = !options.merge;
  contours.fill_missing = contours.repair = true;
  contours.frame = set.frame;
  input.kind = "rtstruct";
  input.anatomical = true;
  input.contours = std::move(set.structures);
}

LabelVolume read_from_path(const InputOptions& options) {
  if (options.paths.size() != 1)
    fail_usage("more than one input", options.paths[1], "give one label volume, or several .cnt files");
  ReadOptions read;
  read.spacing_mm = options.spacing_mm;
  read.labels = options.labels;
  read.series = options.series;
  read.allow_outside = options.allow_outside;
  return read_label_volume(options.paths[0], read);
}

void read_volume(const InputOptions& options, Input& input) {
  LabelVolume volume = options.volume ? *options.volume : read_from_path(options);
  input.kind = volume.kind;
  input.warnings = volume.warnings;
  if (!options.names.empty()) apply_label_table(read_label_table(options.names), volume.labels);
  std::vector<std::size_t> keep = LabelTable(volume).resolve(options.labels);
  for (std::size_t& k : keep) ++k;  // behind the background
  if (options.merge || keep.size() + 1 < volume.labels.size())
    volume = select_labels(std::move(volume), keep, options.merge);
  input.labels.assign(volume.labels.begin() + 1, volume.labels.end());
  input.anatomical = volume.anatomical;
  input.volume = std::move(volume);
}

/// Drawn contours in memory.
void take_contours(const InputOptions& options, Input& input) {
  input.kind = "contours";
  for (const std::size_t k : LabelTable(*options.contours).resolve(options.labels))
    input.contours.push_back((*options.contours)[k]);
}

/// The structure set that one path is, or whose folder it is; "" where there is none.
std::string structure_set_in(const std::vector<std::string>& paths) {
  if (paths.size() != 1) return "";
  const DicomContent content = dicom_content(paths[0]);
  return content.structure_sets.empty() ? "" : label_object(content, paths[0]);
}

/// Voids are read beside the labels that were requested; where drawn ones overlap they go first, as a cavity lies in
/// its wall.
InputOptions with_voids(InputOptions options) {
  if (options.voids.empty()) return options;
  if (!options.labels.empty()) options.labels = options.voids + "," + options.labels;
  return options;
}

std::set<Label> resolve_voids(const std::string& text, const std::vector<LabelInfo>& labels) {
  std::set<Label> voids;
  if (text.empty()) return voids;
  for (const Label l : LabelTable(labels).numbers(text, "--void")) voids.insert(l);
  if (voids.size() == labels.size())
    fail_usage("every label is a void: nothing is left to be filled", "--void " + text,
               "name the labels that only bound others");
  return voids;
}

/// --merge: the labels that are filled become the smallest of them, and the voids stay what they are.
void merge_filled(Input& input) {
  const auto filled = [&](Label l) { return l != 0 && input.voids.count(l) == 0; };
  Label kept = 0;
  for (const LabelInfo& l : input.labels)
    if (filled(l.number) && (kept == 0 || l.number < kept)) kept = l.number;
  const auto goes = [&](const LabelInfo& l) { return filled(l.number) && l.number != kept; };
  input.labels.erase(std::remove_if(input.labels.begin(), input.labels.end(), goes), input.labels.end());
  if (!input.volume) return;
  LabelVolume& v = *input.volume;
  std::vector<LabelInfo> labels;
  std::vector<std::uint16_t> to(v.labels.size(), 0);
  for (std::size_t k = 0; k < v.labels.size(); ++k)
    if (!goes(v.labels[k])) to[k] = static_cast<std::uint16_t>(labels.size()), labels.push_back(v.labels[k]);
  const auto at = std::find_if(labels.begin() + 1, labels.end(), [&](const LabelInfo& l) { return l.number == kept; });
  for (std::size_t k = 0; k < v.labels.size(); ++k)
    if (goes(v.labels[k])) to[k] = static_cast<std::uint16_t>(at - labels.begin());
  v.labels = std::move(labels);
  for (std::uint16_t& x : v.voxels) x = to[x];
}

}  // namespace

Input read_input(const InputOptions& asked) {
  InputOptions options = with_voids(asked);
  const bool merges_later = asked.merge && !asked.voids.empty();
  if (merges_later) options.merge = false;
  Input input;
  const bool in_memory = options.volume || options.contours;
  if (!in_memory && options.paths.empty()) fail_usage("no input", "", "name a label volume, a folder or a .cnt file");
  if (in_memory) input.path = options.memory_name;
  else
    for (const std::string& p : options.paths) input.path += (input.path.empty() ? "" : " ") + p;
  if (options.contours) take_contours(options, input);
  else if (options.volume) read_volume(options, input);
  else if (is_contour_input(options.paths[0])) read_contours(options, input);
  else if (const std::string file = structure_set_in(options.paths); !file.empty())
    read_structures(options, file, input);
  else read_volume(options, input);
  if (!input.volume) {
    input.labels = labels_of(input.contours);
    input.drawn.frame.world = input.anatomical ? Space::lps : Space::none;
    choose_caps(options, input);
  }
  if (!options.names.empty() && !input.volume) apply_label_table(read_label_table(options.names), input.labels);
  // Names come from files and file names: control characters in them would reach terminals and split lines of decks.
  for (LabelInfo& label : input.labels) label.name = printable(label.name);
  input.voids = resolve_voids(options.voids, input.labels);
  if (input.volume)
    for (LabelInfo& label : input.volume->labels) label.name = printable(label.name);
  if (!input.volume) {
    input.drawn.merge = asked.merge;
    input.drawn.not_merged = input.voids;
  }
  if (merges_later || input.drawn.merge) merge_filled(input);
  return input;
}

void empty_voids(Input& input) {
  if (input.voids.empty()) return;
  const auto is_void = [&](const LabelInfo& l) { return input.voids.count(l.number) > 0; };
  input.labels.erase(std::remove_if(input.labels.begin(), input.labels.end(), is_void), input.labels.end());
  if (input.volume) {
    std::vector<std::size_t> keep;
    for (std::size_t k = 1; k < input.volume->labels.size(); ++k)
      if (!is_void(input.volume->labels[k])) keep.push_back(k);
    input.volume = select_labels(std::move(*input.volume), keep, false);
  }
}

Stack drawn_sections(Input& input) {
  return sections_from_contours(input.contours, input.warnings, input.drawn);
}

void empty_voids(Stack& stack, const std::set<Label>& voids) {
  if (voids.empty()) return;
  std::vector<LabelInfo>& labels = stack.labels;
  labels.erase(
      std::remove_if(labels.begin() + 1, labels.end(), [&](const LabelInfo& l) { return voids.count(l.number) > 0; }),
      labels.end());
  for (Section& s : stack.sections) {
    for (SectionEdge& e : s.edges)
      for (Label* side : {&e.left, &e.right})
        if (voids.count(*side) > 0) *side = 0;
    s.edges.erase(
        std::remove_if(s.edges.begin(), s.edges.end(), [](const SectionEdge& e) { return e.left == e.right; }),
        s.edges.end());
  }
}

std::array<double, 3> reduce_to_true_grid(Input& input, int threads) {
  const std::array<double, 3> stored = input.volume->spacing_mm;
  std::optional<TrueGrid> grid = find_true_grid(*input.volume, threads);
  if (!grid) return stored;
  const std::array<double, 3> made = grid->volume.spacing_mm;
  input.warnings.push_back({WarningCode::coarser_grid, "", true_grid_warning(stored, made)});
  input.volume = std::move(grid->volume);
  return made;
}

void check_stack_axis(const Input& input, StackAxis axis) {
  if (!input.volume) {
    if (axis == StackAxis::x || axis == StackAxis::y)
      fail_usage("contours are stacked as they are drawn", "--axis", "leave --axis out");
    return;
  }
  check_slices(*input.volume, axis, input.path);
}

}  // namespace stackmesh
