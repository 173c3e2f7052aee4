#include "fem/assign_materials.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>

#include "base/error.h"
#include "base/warning.h"
#include "fem/lay_fibres.h"
#include "fem/map_modulus.h"
#include "fem/tet_shape.h"
#include "model/space.h"
#include "model/wedge_shape.h"

namespace stackmesh {
namespace {

std::string number(double v) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", v);
  return text;
}

std::string where_of(const MaterialPlan& plan, Label label, const std::string& name) {
  return plan.path + ", label " + std::to_string(label) + " (" + name + ")";
}

template <class Map>
auto find(const Map& map, Label label, const std::string& name) {
  auto at = map.find(std::to_string(label));
  if (at == map.end()) at = map.find(name);
  if (at == map.end()) at = map.find("*");
  return at;
}

class Assigner {
 public:
  Assigner(SolverModel& model, const MaterialPlan* plan, const IntensityVolume* image)
      : model_(model), plan_(plan), image_(image) {}

  MaterialReport run() {
    SolverSets& sets = model_.sets;
    sets.modulus_mpa.assign(model_.mesh.elements(), 0);
    sets.density_t_mm3.assign(model_.mesh.elements(), 0);
    if (plan_ != nullptr) check_plan(*plan_, model_.labels, image_ != nullptr);
    else sets.placeholder_materials = true;
    std::map<Label, std::vector<std::int32_t>> elements;
    for (std::size_t e = 0; e < model_.mesh.elements(); ++e)
      elements[model_.mesh.labels[e]].push_back(static_cast<std::int32_t>(e));
    for (const auto& [label, list] : elements) label_material(label, list);
    for (ShellSet& s : sets.shells) skin(s);
    if (image_ != nullptr && !used_image_)
      report_.warnings.push_back({WarningCode::materials, "", "the image is not used: no label of the mesh has a law"});
    return std::move(report_);
  }

 private:
  std::string name_of(Label label) const {
    for (const LabelInfo& l : model_.labels)
      if (l.number == label) return l.name;
    return "label_" + std::to_string(label);
  }
  std::string where(Label label) const { return where_of(*plan_, label, name_of(label)); }

  /// Of the middle's determinant.
  double volume(std::int32_t t) const {
    const auto element = static_cast<std::size_t>(t);
    if (model_.mesh.is_wedge(element)) return wedge_volume(wedge_nodes(model_.mesh, element - model_.mesh.tets.size()));
    return std::abs(tet_point(model_.mesh, element, {0.25, 0.25, 0.25, 0.25}).determinant) / 6;
  }
  Vec3 middle(std::int32_t t) const {
    const auto element = static_cast<std::size_t>(t);
    if (model_.mesh.is_wedge(element))
      return wedge_point(wedge_nodes(model_.mesh, element - model_.mesh.tets.size()), {1.0 / 3, 1.0 / 3, 0, 0})
          .position;
    return tet_point(model_.mesh, element, {0.25, 0.25, 0.25, 0.25}).position;
  }

  void label_material(Label label, const std::vector<std::int32_t>& tets) {
    MaterialRow row;
    row.label = label;
    row.name = name_of(label);
    row.elements = tets.size();
    LabelMaterial m;
    if (plan_ == nullptr) {
      m.young_mpa = 1;
    } else {
      m = find(plan_->labels, label, row.name)->second;  // check_plan() has seen to it
    }
    row.poisson = m.poisson;
    SolverSets& sets = model_.sets;
    if (m.young_mpa) {
      ElementMaterial material{"M_" + row.name, label,      *m.young_mpa, m.poisson, m.density_t_mm3.value_or(0), tets,
                               m.kind,          m.constants};
      if (m.axes) lay_axes(*m.axes, tets, sets);
      if (m.fibres) {
        const std::size_t unclear = lay_fibres(model_, label, *m.fibres, where(label));
        if (unclear > 0)
          report_.warnings.push_back(warning_at(WarningCode::materials, "label " + std::to_string(label),
                                                "the way through the wall goes along the long axis in " +
                                                    std::to_string(unclear) +
                                                    " elements, whose fibres take any direction across it"));
      }
      for (const std::int32_t t : tets) {
        sets.modulus_mpa[t] = material.young_mpa;
        sets.density_t_mm3[t] = material.density_t_mm3;
      }
      row.young_min_mpa = row.young_mean_mpa = row.young_max_mpa = material.young_mpa;
      row.density_mean_t_mm3 = material.density_t_mm3;
      row.kind = m.kind;
      sets.materials.push_back(std::move(material));
    } else {
      map(label, m, tets, row);
    }
    report_.labels.push_back(row);
  }

  void map(Label label, const LabelMaterial& m, const std::vector<std::int32_t>& tets, MaterialRow& row) {
    used_image_ = true;
    check_cover(label, tets);
    SolverSets& sets = model_.sets;
    const ModulusLaw& law = plan_->laws.at(m.law);
    row.law = law.name;
    const InsideVoxels voxels(*image_, model_.mesh, tets, plan_->mapping.erode_px);
    row.voxels = voxels.used();
    if (voxels.used() == 0)
      report_.warnings.push_back(
          {WarningCode::materials, "label " + std::to_string(label),
           "label " + std::to_string(label) +
               " holds no voxel's centre of the image: intensities are taken as they are around it"});
    else if (voxels.eroded_px() < plan_->mapping.erode_px)
      report_.warnings.push_back({WarningCode::materials, "label " + std::to_string(label),
                                  "label " + std::to_string(label) + " is too thin for --erode " +
                                      std::to_string(plan_->mapping.erode_px) + ": " +
                                      std::to_string(voxels.eroded_px()) + " is used"});
    const double voxel_mm = *std::min_element(image_->spacing_mm.begin(), image_->spacing_mm.end());
    std::vector<ModulusLaw::Value> values = map_modulus(model_.mesh, tets, voxels, voxel_mm, law, plan_->mapping);

    std::size_t low = 0, high = 0, bad = 0, first_bad = 0;
    double sum = 0, density = 0, volumes = 0;
    for (std::size_t i = 0; i < tets.size(); ++i) {
      double& e = values[i].young_mpa;
      if (m.floor_mpa && e < *m.floor_mpa) {
        e = *m.floor_mpa;
        ++low;
      }
      if (m.ceiling_mpa && e > *m.ceiling_mpa) {
        e = *m.ceiling_mpa;
        ++high;
      }
      if (!(e > 0) && bad++ == 0) first_bad = i;
      if (m.density_t_mm3) values[i].density_t_mm3 = *m.density_t_mm3;
      const double v = volume(tets[i]);
      sum += v * e;
      density += v * values[i].density_t_mm3;
      volumes += v;
      sets.modulus_mpa[tets[i]] = e;
      sets.density_t_mm3[tets[i]] = values[i].density_t_mm3;
      row.young_min_mpa = i == 0 ? e : std::min(row.young_min_mpa, e);
      row.young_max_mpa = i == 0 ? e : std::max(row.young_max_mpa, e);
    }
    if (bad > 0) {
      const Vec3 p = middle(tets[first_bad]);
      fail_input("element " + std::to_string(tets[first_bad] + 1) + " would get a modulus of " +
                     number(values[first_bad].young_mpa) + " MPa" +
                     (bad > 1 ? " (and " + std::to_string(bad - 1) + " more elements none above 0)" : ""),
                 where(label) + ", at (" + number(p.x) + ", " + number(p.y) + ", " + number(p.z) + ")",
                 "give the label a \"floor_MPa\"");
    }
    row.clamped_low = static_cast<double>(low) / static_cast<double>(tets.size());
    row.clamped_high = static_cast<double>(high) / static_cast<double>(tets.size());
    row.young_mean_mpa = sum / volumes;
    row.density_mean_t_mm3 = density / volumes;
    sets.mapped.push_back(label);
    bin(label, m, tets, row);
  }

  void check_cover(Label label, const std::vector<std::int32_t>& tets) const {
    std::size_t outside = 0;
    Vec3 p;
    for (const std::int32_t t : tets) {
      const Vec3 c = in_space(middle(t), model_.mesh.space, Space::lps);
      if (image_->contains(c)) continue;
      if (outside++ == 0) p = c;
    }
    if (outside == 0) return;
    const Vec3 a = image_->world(-0.5, -0.5, -0.5),
               b = image_->world(image_->size[0] - 0.5, image_->size[1] - 0.5, image_->size[2] - 0.5);
    const auto at = [](Vec3 v) { return "(" + number(v.x) + ", " + number(v.y) + ", " + number(v.z) + ")"; };
    fail_input(outside == tets.size() ? "the image does not overlap the mesh"
                                      : std::to_string(outside) + " of " + std::to_string(tets.size()) +
                                            " elements lie outside of the image",
               "label " + std::to_string(label) + " (" + name_of(label) + "), first at " + at(p) +
                   " LPS; the image runs from " + at(a) + " to " + at(b),
               "give the image that the labels were drawn on, or one that covers them");
  }

  /// Elements of like modulus share a material, whose modulus is their mean over the volume.
  void bin(Label label, const LabelMaterial& m, const std::vector<std::int32_t>& tets, MaterialRow& row) {
    const SolverSets& sets = model_.sets;
    std::vector<std::int32_t> order = tets;
    std::stable_sort(order.begin(), order.end(),
                     [&](std::int32_t a, std::int32_t b) { return sets.modulus_mpa[a] < sets.modulus_mpa[b]; });
    const auto bins = static_cast<std::size_t>(plan_->mapping.bins);
    const double low = row.young_min_mpa, width = row.young_max_mpa - low;
    const Binning binning = plan_->mapping.binning;
    const double ratio = std::log(row.young_max_mpa / low);
    const auto bin_of = [&](std::size_t i) {
      if (binning == Binning::equal_count) return i * std::min(bins, order.size()) / order.size();
      if (width <= 0) return std::size_t{0};
      if (binning == Binning::logarithmic)
        return std::min(bins - 1, static_cast<std::size_t>(std::log(sets.modulus_mpa[order[i]] / low) / ratio *
                                                           static_cast<double>(bins)));
      return std::min(bins - 1,
                      static_cast<std::size_t>((sets.modulus_mpa[order[i]] - low) / width * static_cast<double>(bins)));
    };
    row.materials = 0;
    for (std::size_t i = 0; i < order.size();) {
      ElementMaterial material;
      material.label = label;
      material.poisson = m.poisson;
      double volumes = 0;
      const std::size_t mine = bin_of(i);
      for (; i < order.size() && bin_of(i) == mine; ++i) {
        const double v = volume(order[i]);
        volumes += v;
        material.young_mpa += v * sets.modulus_mpa[order[i]];
        material.density_t_mm3 += v * sets.density_t_mm3[order[i]];
        material.tets.push_back(order[i]);
      }
      material.young_mpa /= volumes;
      material.density_t_mm3 /= volumes;
      if (binning == Binning::logarithmic) {  // the mean, but off from none by more than the middle of the bin would be
        const double first = sets.modulus_mpa[material.tets.front()], last = sets.modulus_mpa[material.tets.back()];
        const double most =
            std::max(std::tanh(0.5 * ratio / static_cast<double>(bins)), (last - first) / (last + first));
        material.young_mpa =
            std::clamp(material.young_mpa, (1 - most) * last, std::max((1 - most) * last, (1 + most) * first));
      }
      for (const std::int32_t t : material.tets)
        row.bin_error_rel = std::max(row.bin_error_rel, std::abs(material.young_mpa / sets.modulus_mpa[t] - 1));
      std::sort(material.tets.begin(), material.tets.end());
      material.name = "M_" + row.name + "_" + std::to_string(++row.materials);
      model_.sets.materials.push_back(std::move(material));
    }
  }

  void skin(ShellSet& s) {
    if (plan_ == nullptr) {
      s.young_mpa = 1;
      s.poisson = 0.3;
      return;
    }
    const auto at = find(plan_->skins, s.label, name_of(s.label));
    if (at == plan_->skins.end())
      fail_input("the skin of a label has no material", where(s.label), "add it to \"skins\" of the law file");
    s.young_mpa = at->second.young_mpa;
    s.poisson = at->second.poisson;
    s.density_t_mm3 = at->second.density_t_mm3;
  }

  SolverModel& model_;
  const MaterialPlan* plan_;
  const IntensityVolume* image_;
  MaterialReport report_;
  bool used_image_ = false;
};

}  // namespace

void check_plan(const MaterialPlan& plan, const std::vector<LabelInfo>& labels, bool has_image) {
  const auto check = [&](const std::string& key, const std::string& what) {
    if (key == "*") return;
    std::string known;
    for (const LabelInfo& l : labels) {
      if (key == std::to_string(l.number) || key == l.name) return;
      known += (known.empty() ? "" : ", ") + std::to_string(l.number) + " (" + l.name + ")";
    }
    fail_input("the material law names " + what + " '" + key + "', which is not in the mesh", plan.path,
               "the mesh has " + known.substr(0, 300) + "; use these, or \"*\" for all others");
  };
  for (const auto& [key, m] : plan.labels) check(key, "label");
  for (const auto& [key, m] : plan.skins) check(key, "the skin of label");
  for (const LabelInfo& l : labels) {
    const auto at = find(plan.labels, l.number, l.name);
    if (at == plan.labels.end())
      fail_input("a label has no material", where_of(plan, l.number, l.name),
                 "add it to \"labels\", or \"*\" for all others");
    if (!at->second.young_mpa && !has_image)
      fail_usage("label " + std::to_string(l.number) + " has a law, but there is no image to apply it to",
                 "--materials " + plan.path, "give the intensities with --image CT, or a constant E_MPa");
  }
}

MaterialReport assign_materials(SolverModel& model, const MaterialPlan* plan, const IntensityVolume* image) {
  return Assigner(model, plan, image).run();
}

}  // namespace stackmesh
