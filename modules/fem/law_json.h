#pragma once
// Private to fem: what reading a law file needs everywhere. Every complaint says where in the file.
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "base/error.h"
#include "fem/material_law.h"

namespace stackmesh {

using Json = nlohmann::json;

class LawJson {
 public:
  explicit LawJson(const std::string& path) : path_(path) {}

  [[noreturn]] void bad(const std::string& what, const std::string& where) const {
    fail_input(what, path_ + ", " + where, "docs/fem.md has the schema of a law file");
  }
  Json::object_t object(const Json& j, const std::string& where) const {
    if (!j.is_object()) bad("an object in { } is needed", where);
    return j.get<Json::object_t>();
  }
  void only(const Json& j, const std::string& where, const std::set<std::string>& known_keys) const {
    for (const auto& [key, value] : object(j, where))
      if (known_keys.count(key) == 0) bad("unknown entry \"" + key + "\"", where);
  }
  double number(const Json& j, const char* key, const std::string& where) const {
    if (!j.contains(key)) bad(std::string("no \"") + key + "\"", where);
    if (!j.at(key).is_number() || !std::isfinite(j.at(key).get<double>()))
      bad(std::string("\"") + key + "\" is no number", where);
    return j.at(key).get<double>();
  }
  double number(const Json& j, const char* key, const std::string& where, double otherwise) const {
    return j.contains(key) ? number(j, key, where) : otherwise;
  }
  std::string text(const Json& j, const char* key, const std::string& where) const {
    if (!j.contains(key) || !j.at(key).is_string()) bad(std::string("no text \"") + key + "\"", where);
    return j.at(key).get<std::string>();
  }

  std::vector<Json> list(const Json& j, const char* key, const std::string& where) const {
    if (!j.contains(key)) return {};
    if (!j.at(key).is_array()) bad(std::string("\"") + key + "\" is no list", where);
    return j.at(key).get<std::vector<Json>>();
  }

  /// Three finite numbers.
  Vec3 vector(const Json& j, const char* key, const std::string& where) const {
    if (!j.contains(key) || !j.at(key).is_array() || j.at(key).size() != 3)
      bad(std::string("\"") + key + "\" is no list of three numbers", where);
    double v[3];
    for (int k = 0; k < 3; ++k) {
      const Json& n = j.at(key)[k];
      if (!n.is_number() || !std::isfinite(n.get<double>()))
        bad(std::string("\"") + key + "\" is no list of three numbers", where);
      v[k] = n.get<double>();
    }
    return {v[0], v[1], v[2]};
  }
  bool flag(const Json& j, const char* key, const std::string& where, bool otherwise) const {
    if (!j.contains(key)) return otherwise;
    if (!j.at(key).is_boolean()) bad(std::string("\"") + key + "\" is neither true nor false", where);
    return j.at(key).get<bool>();
  }
  int whole(const Json& j, const char* key, const std::string& where, int least, int most, int otherwise) const {
    const double v = number(j, key, where, otherwise);
    if (!j.contains(key)) return otherwise;
    if (v < least || v > most || v != std::floor(v))
      bad(std::string("\"") + key + "\" is no whole number from " + std::to_string(least) + " to " +
              std::to_string(most),
          where);
    return static_cast<int>(v);
  }

 private:
  const std::string path_;
};

/// A label's entry with a "model": hyperelastic or orthotropic, and where its fibres go. The density is not read.
LabelMaterial read_label_model(const LawJson& law, const Json& j, const std::string& where);

/// The entry "load_case" of a law file.
LoadCase read_load_case(const LawJson& law, const Json& j);

}  // namespace stackmesh
