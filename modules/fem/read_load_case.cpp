// The entry "load_case" of a law file: supports, loads, points, springs, steps.
#include <algorithm>

#include "fem/law_json.h"

namespace stackmesh {
namespace {

class LoadCaseReader {
 public:
  explicit LoadCaseReader(const LawJson& law) : law_(law) {}

  LoadCase read(const Json& j) {
    const std::string where = "load_case";
    law_.only(j, where,
              {"comment", "source", "fixed", "moved", "loaded", "gravity_mm_s2", "points", "springs",
               "large_displacements", "increments", "steps"});
    for (const Json& p : filled_list(j, "points", where)) point(p, where + ", points");
    for (const Json& s : filled_list(j, "springs", where)) spring(s, where + ", springs");
    case_.always = acting(j, where);
    how(j, where, case_.defaults);
    for (const Json& s : filled_list(j, "steps", where))
      step(s, where + ", step " + std::to_string(case_.steps.size() + 1));
    return std::move(case_);
  }

 private:
  /// A list that is there must hold something: an empty one was meant to hold what it does not.
  std::vector<Json> filled_list(const Json& j, const char* key, const std::string& where) const {
    const std::vector<Json> entries = law_.list(j, key, where);
    if (j.contains(key) && entries.empty()) law_.bad(std::string("\"") + key + "\" is an empty list", where);
    return entries;
  }

  /// Axes or, with `allow_none`, possibly "".
  std::array<bool, 3> axes(const Json& j, const char* key, const std::string& where, const std::string& otherwise,
                           bool allow_none) const {
    const std::string text = j.contains(key) ? law_.text(j, key, where) : otherwise;
    if ((text.empty() && !allow_none) || text.find_first_not_of("xyz") != std::string::npos)
      law_.bad(std::string("\"") + key + "\" is not some of xyz", where);
    std::array<bool, 3> on{};
    for (const char a : text) on[a - 'x'] = true;
    return on;
  }

  std::array<std::optional<double>, 3> values(const Json& j, const char* key, const std::string& where) const {
    std::array<std::optional<double>, 3> out;
    if (!j.contains(key)) return out;
    const auto wrong = [&] { law_.bad(std::string("\"") + key + "\" is no list of three (a number or null)", where); };
    if (!j.at(key).is_array() || j.at(key).size() != 3) wrong();
    for (int axis = 0; axis < 3; ++axis) {
      const Json& v = j.at(key)[axis];
      if (v.is_null()) continue;
      if (!v.is_number() || !std::isfinite(v.get<double>())) wrong();
      out[axis] = v.get<double>();
    }
    return out;
  }

  const LoadCase::Point* find_point(const std::string& name) const {
    for (const LoadCase::Point& p : case_.points)
      if (p.name == name) return &p;
    return nullptr;
  }
  /// The set or the point that an entry is about; `true` where it is a point.
  std::pair<std::string, bool> target(const Json& j, const std::string& where) const {
    if (j.contains("set") == j.contains("point")) law_.bad("exactly one of \"set\" and \"point\" is needed", where);
    if (j.contains("set")) return {law_.text(j, "set", where), false};
    const std::string name = law_.text(j, "point", where);
    if (find_point(name) == nullptr) law_.bad("point \"" + name + "\" is not in \"points\"", where);
    return {name, true};
  }
  void needs_rigid(const std::string& name, const std::string& where) const {
    if (!find_point(name)->rigid)
      law_.bad("point \"" + name + "\" is distributing: it takes loads, but cannot be held or moved", where);
  }

  LoadCase::Acting acting(const Json& j, const std::string& where) const {
    LoadCase::Acting out;
    for (const Json& f : filled_list(j, "fixed", where)) {
      const std::string at = where + ", fixed";
      law_.only(f, at, {"comment", "set", "point", "axes", "rotations"});
      const auto [name, is_point] = target(f, at);
      LoadCase::Held held{name, {}};
      const auto shifts = axes(f, "axes", at, "xyz", is_point),
                 turns = axes(f, "rotations", at, is_point ? "xyz" : "", true);
      if (is_point) needs_rigid(name, at);
      else if (f.contains("rotations")) law_.bad("\"rotations\" are of a point: nodes of tetrahedra have none", at);
      for (int k = 0; k < 3; ++k) {
        if (shifts[k]) held.value_mm[k] = 0.0;
        if (turns[k]) held.value_rad[k] = 0.0;
      }
      out.held.push_back(held);
    }
    for (const Json& m : filled_list(j, "moved", where)) {
      const std::string at = where + ", moved";
      law_.only(m, at, {"comment", "set", "point", "mm", "rad"});
      const auto [name, is_point] = target(m, at);
      if (!is_point && !m.contains("mm")) law_.bad("\"mm\" is no list of three (a number or null)", at);
      if (!is_point && m.contains("rad")) law_.bad("\"rad\" is of a point: nodes of tetrahedra have no rotations", at);
      if (is_point) needs_rigid(name, at);
      LoadCase::Held held{name, values(m, "mm", at), values(m, "rad", at)};
      const auto any = [](const auto& v) {
        return std::any_of(v.begin(), v.end(), [](const auto& x) { return x.has_value(); });
      };
      if (!any(held.value_mm) && !any(held.value_rad)) law_.bad("\"mm\" moves nothing", at);
      out.held.push_back(held);
    }
    for (const Json& l : filled_list(j, "loaded", where)) {
      const std::string at = where + ", loaded";
      law_.only(l, at, {"comment", "set", "point", "force_N", "pressure_MPa", "moment_Nmm"});
      LoadCase::Loaded loaded;
      const auto [name, is_point] = target(l, at);
      loaded.set = name;
      if ((l.contains("force_N") || l.contains("moment_Nmm")) == l.contains("pressure_MPa"))
        law_.bad("exactly one of \"force_N\" (or \"moment_Nmm\", or both) and \"pressure_MPa\" is needed", at);
      if (is_point && l.contains("pressure_MPa")) law_.bad("a point takes a force or a moment, not a pressure", at);
      if (l.contains("force_N")) loaded.force_n = law_.vector(l, "force_N", at);
      if (l.contains("moment_Nmm")) loaded.moment_nmm = law_.vector(l, "moment_Nmm", at);
      if (l.contains("pressure_MPa")) loaded.pressure_mpa = law_.number(l, "pressure_MPa", at);
      out.loaded.push_back(loaded);
    }
    if (j.contains("gravity_mm_s2")) {
      out.gravity_mm_s2 = law_.vector(j, "gravity_mm_s2", where);
      if (!(norm(*out.gravity_mm_s2) > 0)) law_.bad("\"gravity_mm_s2\" has no length", where);
      if (norm(*out.gravity_mm_s2) < 50)
        law_.bad("\"gravity_mm_s2\" is far below that of the earth, which is 9806.65 mm/s2 (not 9.8)", where);
    }
    return out;
  }

  void point(const Json& j, const std::string& where) {
    law_.only(j, where, {"comment", "name", "set", "mm", "coupling"});
    LoadCase::Point p;
    p.name = law_.text(j, "name", where);
    p.set = law_.text(j, "set", where);
    p.at_mm = law_.vector(j, "mm", where);
    const std::string kind = j.contains("coupling") ? law_.text(j, "coupling", where) : "rigid";
    if (kind != "rigid" && kind != "distributing")
      law_.bad("\"coupling\" is neither \"rigid\" nor \"distributing\"", where);
    p.rigid = kind == "rigid";
    if (find_point(p.name) != nullptr) law_.bad("point \"" + p.name + "\" is there twice", where);
    case_.points.push_back(p);
  }

  void spring(const Json& j, const std::string& where) {
    law_.only(j, where, {"comment", "set", "N_per_mm", "MPa_per_mm"});
    LoadCase::Spring s;
    s.set = law_.text(j, "set", where);
    if (j.contains("N_per_mm") == j.contains("MPa_per_mm"))
      law_.bad("exactly one of \"N_per_mm\" and \"MPa_per_mm\" is needed", where);
    if (j.contains("N_per_mm")) {
      s.n_per_mm = law_.vector(j, "N_per_mm", where);
      const Vec3 k = *s.n_per_mm;
      if (!(k.x >= 0 && k.y >= 0 && k.z >= 0 && k.x + k.y + k.z > 0))
        law_.bad("\"N_per_mm\" is negative, or 0 along all axes", where);
    } else {
      s.mpa_per_mm = law_.number(j, "MPa_per_mm", where);
      if (!(*s.mpa_per_mm > 0)) law_.bad("\"MPa_per_mm\" is not above 0", where);
    }
    case_.springs.push_back(s);
  }

  void how(const Json& j, const std::string& where, LoadCase::Step& step) const {
    step.large_displacements = law_.flag(j, "large_displacements", where, case_.defaults.large_displacements);
    step.increments = law_.whole(j, "increments", where, 1, 100000, case_.defaults.increments);
  }

  void step(const Json& j, const std::string& where) {
    law_.only(j, where,
              {"comment", "name", "type", "modes", "large_displacements", "increments", "fixed", "moved", "loaded",
               "gravity_mm_s2"});
    LoadCase::Step s;
    s.name = j.contains("name") ? law_.text(j, "name", where) : "step " + std::to_string(case_.steps.size() + 1);
    const std::string type = j.contains("type") ? law_.text(j, "type", where) : "static";
    if (type != "static" && type != "frequency") law_.bad("\"type\" is neither \"static\" nor \"frequency\"", where);
    s.analysis = type == "static" ? Analysis::statics : Analysis::frequency;
    if (type == "static" && j.contains("modes")) law_.bad("\"modes\" are of a frequency step", where);
    s.modes = law_.whole(j, "modes", where, 1, 1000, 10);
    how(j, where, s);
    s.acting = acting(j, where);
    if (type == "frequency" && (!s.acting.loaded.empty() || s.acting.gravity_mm_s2))
      law_.bad("a frequency step has no loads", where);
    case_.steps.push_back(std::move(s));
  }

  const LawJson& law_;
  LoadCase case_;
};

}  // namespace

LoadCase read_load_case(const LawJson& law, const Json& j) {
  return LoadCaseReader(law).read(j);
}

}  // namespace stackmesh
