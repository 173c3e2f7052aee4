#include <algorithm>
#include <cmath>

#include "base/json_text.h"
#include "fem/law_json.h"

namespace stackmesh {
namespace {

const std::set<std::string> kDensityUnits = {"g/cm3", "mg/cm3", "kg/m3", "t/mm3"};
const std::set<std::string> kModulusUnits = {"MPa", "GPa", "Pa"};

struct KnownLaw {
  const char *name, *source;
  std::vector<LawStep> steps;  // behind the calibration, from a density in g/cm3
};

/// Ash density from QCT density, and ash over apparent density 0.6 (schileo2008); morgan2003: femoral neck; keller1994:
/// pooled.
const std::vector<KnownLaw>& known() {
  constexpr double all = std::numeric_limits<double>::infinity();
  const LawStep ash = {"qct_density", "ash_density", "g/cm3", {{all, 0.877, 1, 0.079}}};
  const LawStep apparent = {"ash_density", "apparent_density", "g/cm3", {{all, 1 / 0.6, 1, 0}}};
  static const std::vector<KnownLaw> laws = {
      {"morgan2003_femoral_neck",
       "schileo2008, morgan2003",
       {ash, apparent, {"apparent_density", "E", "MPa", {{all, 6850, 1.49, 0}}}}},
      {"keller1994", "schileo2008, keller1994", {ash, {"ash_density", "E", "MPa", {{all, 10500, 2.29, 0}}}}}};
  return laws;
}

/// Walks a law file; every complaint says where in it.
class LawReader : LawJson {
 public:
  explicit LawReader(const std::string& path) : LawJson(path) { plan_.path = path; }

  MaterialPlan read() {
    const std::string text = read_json_text(plan_.path, "the material law", "check the path of --materials");
    Json j;
    try {
      j = Json::parse(text);
    } catch (const Json::parse_error& e) {
      fail_input("the material law is no JSON (byte " + std::to_string(e.byte) + ")", plan_.path,
                 "mend the file; docs/fem.md has the schema");
    }
    only(j, "the file",
         {"schema", "comment", "units", "calibration", "laws", "labels", "skins", "mapping", "load_case", "contact"});
    if (!j.contains("schema") || j.at("schema") != "stackmesh-law-1")
      bad("\"schema\" is not \"stackmesh-law-1\"", "the file");
    units(j);
    if (j.contains("calibration")) calibration(j.at("calibration"));
    if (j.contains("laws"))
      for (const auto& [name, law] : object(j.at("laws"), "laws")) own_law(name, law);
    if (!j.contains("labels")) bad("no \"labels\": which material has which label", "the file");
    for (const auto& [name, label] : object(j.at("labels"), "labels")) label_material(name, label);
    if (j.contains("skins"))
      for (const auto& [name, skin] : object(j.at("skins"), "skins")) skin_material(name, skin);
    if (j.contains("mapping")) mapping(j.at("mapping"));
    if (j.contains("load_case")) plan_.load_case = read_load_case(*this, j.at("load_case"));
    for (const Json& c : list(j, "contact", "the file")) contact(c);
    return std::move(plan_);
  }

 private:
  void units(const Json& j) {
    const std::string where = "units";
    if (!j.contains("units"))
      bad("no \"units\": the file must say {\"length\": \"mm\", \"force\": \"N\", \"stress\": \"MPa\"}", "the file");
    const Json& u = j.at("units");
    only(u, where, {"length", "force", "stress", "density"});
    if (text(u, "length", where) != "mm") bad("the unit of length is not mm", where);
    if (text(u, "force", where) != "N") bad("the unit of force is not N", where);
    if (text(u, "stress", where) != "MPa") bad("the unit of stress is not MPa", where);
    if (u.contains("density") && text(u, "density", where) != "t/mm3") bad("the unit of density is not t/mm3", where);
  }

  /// density = slope * intensity + intercept
  void calibration(const Json& j) {
    const std::string where = "calibration";
    only(j, where, {"comment", "source", "intensity", "density", "slope", "intercept"});
    text(j, "intensity", where);
    LawStep step;
    step.from = text(j, "intensity", where);
    step.to = "qct_density";
    step.unit = text(j, "density", where);
    if (kDensityUnits.count(step.unit) == 0) bad("unknown unit of density \"" + step.unit + "\"", where);
    LawPiece piece;
    piece.factor = number(j, "slope", where);
    piece.offset = number(j, "intercept", where);
    if (!(piece.factor > 0)) bad("the slope is not above 0: density would fall as intensity rises", where);
    step.pieces = {piece};
    calibration_ = step;
  }

  std::vector<LawPiece> pieces(const Json& j, const std::string& where) const {
    std::vector<LawPiece> list;
    const auto one = [&](const Json& p, bool bounded) {
      LawPiece piece;
      piece.factor = number(p, "factor", where);
      piece.exponent = number(p, "exponent", where, 1);
      piece.offset = number(p, "offset", where, 0);
      if (bounded && p.contains("up_to")) piece.up_to = number(p, "up_to", where);
      list.push_back(piece);
    };
    if (!j.contains("pieces")) {
      one(j, false);
      return list;
    }
    if (!j.at("pieces").is_array() || j.at("pieces").empty()) bad("\"pieces\" is no list", where);
    for (const Json& p : j.at("pieces")) {
      only(p, where, {"up_to", "factor", "exponent", "offset"});
      one(p, true);
    }
    for (std::size_t i = 0; i + 1 < list.size(); ++i)
      if (!(list[i].up_to < list[i + 1].up_to)) bad("\"up_to\" of the pieces does not ascend, or is missing", where);
    return list;
  }

  void own_law(const std::string& name, const Json& j) {
    const std::string where = "law \"" + name + "\"";
    only(j, where, {"comment", "source", "steps"});
    for (const KnownLaw& k : known())
      if (name == k.name) bad("the name is taken by a law of the program", where);
    ModulusLaw law;
    law.name = name;
    law.source = j.contains("source") ? text(j, "source", where) : "";
    if (!j.contains("steps") || !j.at("steps").is_array() || j.at("steps").empty()) bad("no list \"steps\"", where);
    for (std::size_t i = 0; i < j.at("steps").size(); ++i) {
      const Json& s = j.at("steps")[i];
      const std::string at = where + ", step " + std::to_string(i + 1);
      only(s, at, {"comment", "source", "from", "to", "unit", "factor", "exponent", "offset", "pieces"});
      LawStep step;
      step.from = text(s, "from", at);
      step.to = text(s, "to", at);
      step.unit = text(s, "unit", at);
      step.pieces = pieces(s, at);
      const std::string before = i == 0 ? "" : law.steps.back().to;
      if (i > 0 && step.from != before)
        bad("it begins with \"" + step.from + "\", but the step before gives \"" + before + "\"", at);
      const bool last = i + 1 == j.at("steps").size();
      if (last != (kModulusUnits.count(step.unit) > 0) || (!last && kDensityUnits.count(step.unit) == 0))
        bad(last ? "the last step does not give a modulus in MPa, GPa or Pa"
                 : "unit \"" + step.unit + "\" is no unit of density",
            at);
      if (i == 0 && !last)
        for (const LawPiece& p : step.pieces)
          if (!(p.factor > 0)) bad("the slope is not above 0: density would fall as intensity rises", at);
      law.steps.push_back(step);
    }
    const std::string first = law.steps.front().from;
    if (first == "qct_density") {
      if (!calibration_) bad("it begins with \"qct_density\", but the file has no \"calibration\"", where);
      law.steps.insert(law.steps.begin(), *calibration_);
    }
    plan_.laws[name] = std::move(law);
  }

  /// A law of the program, behind the file's calibration turned to g/cm3.
  void take_known(const std::string& name, const std::string& where) {
    if (plan_.laws.count(name) > 0) return;
    for (const KnownLaw& k : known()) {
      if (name != k.name) continue;
      if (!calibration_)
        bad("law \"" + name + "\" needs a \"calibration\" of the scanner (intensity to density)", where);
      LawStep first = *calibration_;
      const double scale = first.unit == "mg/cm3" || first.unit == "kg/m3" ? 1e-3 : first.unit == "t/mm3" ? 1e9 : 1;
      first.pieces[0].factor *= scale;
      first.pieces[0].offset *= scale;
      first.unit = "g/cm3";
      ModulusLaw law{k.name, k.source, k.steps};
      law.steps.insert(law.steps.begin(), first);
      plan_.laws[name] = std::move(law);
      return;
    }
    std::string names;
    for (const auto& [n, law] : plan_.laws) names += (names.empty() ? "" : ", ") + n;
    for (const KnownLaw& k : known()) names += std::string(names.empty() ? "" : ", ") + k.name;
    bad("unknown law \"" + name + "\" (there are " + names + ")", where);
  }

  double poisson(const Json& j, const std::string& where) const {
    const double v = number(j, "poisson", where);
    if (!(v > -1 && v < 0.5)) bad("Poisson's ratio is not between -1 and 0.5", where);
    return v;
  }

  void label_material(const std::string& name, const Json& j) {
    const std::string where = "label \"" + name + "\"";
    LabelMaterial m;
    if (object(j, where).count("model") > 0) {
      m = read_label_model(*this, j, where);
    } else {
      only(j, where, {"comment", "source", "E_MPa", "law", "poisson", "density_t_mm3", "floor_MPa", "ceiling_MPa"});
      if (j.contains("E_MPa") == j.contains("law")) bad("exactly one of \"E_MPa\" and \"law\" is needed", where);
      if (j.contains("E_MPa")) {
        m.young_mpa = number(j, "E_MPa", where);
        if (!(*m.young_mpa > 0)) bad("\"E_MPa\" is not above 0", where);
        if (j.contains("floor_MPa") || j.contains("ceiling_MPa"))
          bad("a floor or ceiling is for a label with a law", where);
      } else {
        m.law = text(j, "law", where);
        take_known(m.law, where);
      }
      m.poisson = poisson(j, where);
    }
    if (j.contains("density_t_mm3")) {
      m.density_t_mm3 = number(j, "density_t_mm3", where);
      if (!(*m.density_t_mm3 >= 0)) bad("the density is negative", where);
      if (*m.density_t_mm3 > 1e-6) bad("the density is above that of any matter: it is in t/mm3 (water: 1e-9)", where);
    }
    if (j.contains("floor_MPa")) m.floor_mpa = number(j, "floor_MPa", where);
    if (j.contains("ceiling_MPa")) m.ceiling_mpa = number(j, "ceiling_MPa", where);
    if (m.floor_mpa && !(*m.floor_mpa > 0)) bad("the floor is not above 0", where);
    if (m.ceiling_mpa && !(*m.ceiling_mpa > m.floor_mpa.value_or(0))) bad("the ceiling is not above the floor", where);
    plan_.labels[name] = m;
  }

  void skin_material(const std::string& name, const Json& j) {
    const std::string where = "skin \"" + name + "\"";
    only(j, where, {"comment", "source", "E_MPa", "poisson", "density_t_mm3"});
    SkinMaterial m;
    m.young_mpa = number(j, "E_MPa", where);
    if (!(m.young_mpa > 0)) bad("\"E_MPa\" is not above 0", where);
    m.poisson = poisson(j, where);
    m.density_t_mm3 = number(j, "density_t_mm3", where, 0);
    plan_.skins[name] = m;
  }

  void mapping(const Json& j) {
    const std::string where = "mapping";
    only(j, where, {"comment", "average", "erode_px", "bins", "binning"});
    MappingOptions& m = plan_.mapping;
    if (j.contains("average")) {
      const std::string what = text(j, "average", where);
      if (what != "modulus" && what != "intensity") bad("\"average\" is neither \"modulus\" nor \"intensity\"", where);
      m.integrate_modulus = what == "modulus";
    }
    const double erode = number(j, "erode_px", where, m.erode_px), bins = number(j, "bins", where, m.bins);
    if (erode < 0 || erode > 20 || erode != std::floor(erode))
      bad("\"erode_px\" is no whole number from 0 to 20", where);
    if (bins < 1 || bins > 100000 || bins != std::floor(bins))
      bad("\"bins\" is no whole number from 1 to 100000", where);
    m.erode_px = static_cast<int>(erode);
    m.bins = static_cast<int>(bins);
    if (j.contains("binning")) {
      const std::string how = text(j, "binning", where);
      if (how != "logarithmic" && how != "equal_count" && how != "equal_modulus")
        bad("\"binning\" is none of \"logarithmic\", \"equal_count\" and \"equal_modulus\"", where);
      m.binning = how == "logarithmic"   ? Binning::logarithmic
                  : how == "equal_count" ? Binning::equal_count
                                         : Binning::equal_modulus;
    }
  }

  void contact(const Json& j) {
    const std::string where = "contact";
    only(j, where, {"comment", "source", "parts", "type", "friction", "stiffness_MPa_mm", "stabilise"});
    ContactLaw law;
    if (!j.contains("parts") || !j.at("parts").is_array() || j.at("parts").size() != 2 ||
        !j.at("parts")[0].is_string() || !j.at("parts")[1].is_string())
      bad("\"parts\" is no list of two names of parts", where);
    for (int k = 0; k < 2; ++k) law.parts[k] = j.at("parts")[k].get<std::string>();
    const std::string type = text(j, "type", where);
    if (type != "tie" && type != "contact" && type != "none")
      bad("\"type\" is none of \"tie\", \"contact\", \"none\"", where);
    law.contact = type == "tie" ? Contact::tie : type == "contact" ? Contact::contact : Contact::none;
    if (law.contact != Contact::contact &&
        (j.contains("friction") || j.contains("stiffness_MPa_mm") || j.contains("stabilise")))
      bad("\"friction\", \"stiffness_MPa_mm\" and \"stabilise\" are for type \"contact\"", where);
    law.stabilise = number(j, "stabilise", where, 0);
    if (!(law.stabilise >= 0 && law.stabilise <= 1)) bad("\"stabilise\" is no share from 0 to 1", where);
    law.friction = number(j, "friction", where, 0);
    if (!(law.friction >= 0)) bad("\"friction\" is negative", where);
    if (j.contains("stiffness_MPa_mm")) {
      law.stiffness_mpa_mm = number(j, "stiffness_MPa_mm", where);
      if (!(*law.stiffness_mpa_mm > 0)) bad("\"stiffness_MPa_mm\" is not above 0", where);
    }
    plan_.contacts.push_back(std::move(law));
  }

  MaterialPlan plan_;
  std::optional<LawStep> calibration_;
};

}  // namespace

std::vector<std::string> known_laws() {
  std::vector<std::string> names;
  for (const KnownLaw& k : known()) names.push_back(k.name);
  return names;
}

MaterialPlan read_law(const std::string& path) {
  try {
    return LawReader(path).read();
  } catch (const Json::exception&) {  // an entry of another type than it should have
    fail_input("the material law holds an entry of the wrong type", path, "docs/fem.md has the schema");
  }
}

}  // namespace stackmesh
