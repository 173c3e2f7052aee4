// A label's entry with a "model": hyperelastic and orthotropic materials, fibres.
#include "fem/law_json.h"

namespace stackmesh {
namespace {

class ModelReader {
 public:
  ModelReader(const LawJson& law, const Json& j, const std::string& where) : law_(law), j_(j), where_(where) {}

  LabelMaterial read() {
    const std::string model = law_.text(j_, "model", where_);
    if (model == "neo_hooke") {
      m_.kind = MaterialKind::neo_hooke;
      only({"C10_MPa", "bulk_MPa"}, false);
      m_.constants = {positive("C10_MPa"), positive("bulk_MPa")};
      small_strain(2 * m_.constants[0], m_.constants[1]);
    } else if (model == "mooney_rivlin") {
      m_.kind = MaterialKind::mooney_rivlin;
      only({"C10_MPa", "C01_MPa", "bulk_MPa"}, false);
      m_.constants = {law_.number(j_, "C10_MPa", where_), law_.number(j_, "C01_MPa", where_), positive("bulk_MPa")};
      if (!(m_.constants[0] + m_.constants[1] > 0))
        law_.bad("\"C10_MPa\" and \"C01_MPa\" together are not above 0", where_);
      small_strain(2 * (m_.constants[0] + m_.constants[1]), m_.constants[2]);
    } else if (model == "holzapfel") {
      m_.kind = MaterialKind::holzapfel;
      only({"C10_MPa", "k1_MPa", "k2", "kappa", "angle_deg", "bulk_MPa"}, true);
      const double kappa = law_.number(j_, "kappa", where_, 0), angle = law_.number(j_, "angle_deg", where_, 0);
      if (!(kappa >= 0 && kappa <= 1.0 / 3)) law_.bad("\"kappa\" is not from 0 to 1/3", where_);
      if (!(angle >= 0 && angle <= 90)) law_.bad("\"angle_deg\" is not from 0 to 90", where_);
      m_.constants = {positive("C10_MPa"), positive("k1_MPa"), positive("k2"), kappa, angle, positive("bulk_MPa")};
      small_strain(2 * m_.constants[0], m_.constants[5]);
    } else if (model == "orthotropic") {
      m_.kind = MaterialKind::orthotropic;
      only({"E_MPa", "poisson", "G_MPa"}, true);
      orthotropic();
    } else {
      law_.bad("\"model\" is none of \"neo_hooke\", \"mooney_rivlin\", \"holzapfel\" and \"orthotropic\"", where_);
    }
    return std::move(m_);
  }

 private:
  void only(std::set<std::string> known, bool has_axes) {
    known.insert({"comment", "source", "model", "density_t_mm3"});
    if (has_axes) known.insert({"fibres", "axes"});
    law_.only(j_, where_, known);
    if (!has_axes) return;
    if (j_.contains("fibres") == j_.contains("axes"))
      law_.bad("exactly one of \"fibres\" and \"axes\" is needed", where_);
    if (j_.contains("axes")) axes(j_.at("axes"), where_ + ", axes");
    else fibres(j_.at("fibres"), where_ + ", fibres");
  }
  double positive(const char* key) const {
    const double v = law_.number(j_, key, where_);
    if (!(v > 0)) law_.bad(std::string("\"") + key + "\" is not above 0", where_);
    return v;
  }
  void small_strain(double shear, double bulk) {
    if (!(bulk > 2.0 / 3 * shear))
      law_.bad("\"bulk_MPa\" is not above two thirds of the shear modulus: Poisson's ratio would not be above 0",
               where_);
    m_.young_mpa = 9 * bulk * shear / (3 * bulk + shear);
    m_.poisson = (3 * bulk - 2 * shear) / (2 * (3 * bulk + shear));
  }
  void orthotropic() {
    const Vec3 e = law_.vector(j_, "E_MPa", where_), nu = law_.vector(j_, "poisson", where_),
               g = law_.vector(j_, "G_MPa", where_);
    if (!(std::min({e.x, e.y, e.z, g.x, g.y, g.z}) > 0)) law_.bad("a modulus is not above 0", where_);
    const double nu21 = nu.x * e.y / e.x, nu31 = nu.y * e.z / e.x, nu32 = nu.z * e.z / e.y;
    if (!(nu.x * nu21 < 1 && nu.y * nu31 < 1 && nu.z * nu32 < 1 &&
          1 - nu.x * nu21 - nu.z * nu32 - nu.y * nu31 - 2 * nu21 * nu32 * nu.y > 0))
      law_.bad("no such material can be: with these moduli and ratios a strain would give energy back", where_);
    m_.constants = {e.x, e.y, e.z, nu.x, nu.y, nu.z, g.x, g.y, g.z};
    m_.young_mpa = e.x;
    m_.poisson = nu.x;
  }
  Vec3 direction(const Json& j, const char* key, const std::string& where) const {
    const Vec3 v = law_.vector(j, key, where);
    if (!(norm(v) > 0)) law_.bad(std::string("\"") + key + "\" has no length", where);
    return (1 / norm(v)) * v;
  }
  void axes(const Json& j, const std::string& where) {
    law_.only(j, where, {"comment", "fibre", "across"});
    const Vec3 fibre = direction(j, "fibre", where);
    Vec3 across = direction(j, "across", where);
    across = across - dot(across, fibre) * fibre;
    if (!(norm(across) > 1e-6)) law_.bad("\"across\" goes along \"fibre\"", where);
    m_.axes = {fibre, (1 / norm(across)) * across};
  }
  void fibres(const Json& j, const std::string& where) {
    law_.only(j, where, {"comment", "source", "from", "to", "angles_deg", "along"});
    FibreRule rule;
    rule.from = law_.text(j, "from", where);
    rule.to = law_.text(j, "to", where);
    rule.along = direction(j, "along", where);
    if (j.contains("angles_deg")) {
      const Json& a = j.at("angles_deg");
      if (!a.is_array() || a.size() != 2 || !a[0].is_number() || !a[1].is_number())
        law_.bad("\"angles_deg\" is no list of two numbers", where);
      rule.angle_deg = {a[0].get<double>(), a[1].get<double>()};
    }
    m_.fibres = rule;
  }

  const LawJson& law_;
  const Json& j_;
  const std::string& where_;
  LabelMaterial m_;
};

}  // namespace

LabelMaterial read_label_model(const LawJson& law, const Json& j, const std::string& where) {
  return ModelReader(law, j, where).read();
}

}  // namespace stackmesh
