#include "fem/selection.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/error.h"
#include "base/json_text.h"
#include "base/text.h"
#include "fem/solver_names.h"
#include "model/space.h"

namespace stackmesh {
namespace {

constexpr const char* grammar =
    "write --select NAME=box:x0,y0,z0,x1,y1,z1, sphere:x,y,z,r, plane:x,y,z,nx,ny,nz[,tolerance], "
    "normal:nx,ny,nz,degrees, "
    "points:FILE.mrk.json,r, of:LABEL or in:SET, joined by &";

std::string number(double v) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", v);
  return text;
}

std::string at(Vec3 p) {
  return "(" + number(p.x) + ", " + number(p.y) + ", " + number(p.z) + ")";
}

std::vector<double> numbers(const std::string& list, std::size_t least, std::size_t most, const std::string& text) {
  std::vector<double> values;
  std::size_t begin = 0;
  while (begin <= list.size()) {
    const std::size_t end = std::min(list.find(',', begin), list.size());
    const std::string word = list.substr(begin, end - begin);
    char* rest = nullptr;
    const double v = std::strtod(word.c_str(), &rest);
    if (word.empty() || *rest != '\0' || !std::isfinite(v))
      fail_usage("'" + word + "' is not a number", "--select " + text, grammar);
    values.push_back(v);
    begin = end + 1;
  }
  if (values.size() < least || values.size() > most)
    fail_usage(std::to_string(values.size()) + " numbers where " + std::to_string(least) +
                   (most > least ? " or more" : "") + " are needed",
               "--select " + text, grammar);
  return values;
}

Vec3 unit(Vec3 v, const std::string& text) {
  const double length = norm(v);
  if (!(length > 0)) fail_usage("a direction has no length", "--select " + text, grammar);
  return (1 / length) * v;
}

/// Control points of a Slicer markups file, in the space of the mesh.
std::vector<Vec3> read_markups(const std::string& path, Space of_mesh) {
  const std::string text = read_json_text(path, "the markups file", "check the path");
  std::vector<Vec3> points;
  try {
    const nlohmann::json j = nlohmann::json::parse(text);
    for (const auto& markup : j.at("markups")) {
      const std::string system = markup.value("coordinateSystem", std::string("LPS"));
      if (system != "LPS" && system != "RAS" && system != "0" && system != "1")
        fail_input("the markups are in an unknown frame '" + system + "'", path, "save them from Slicer as LPS or RAS");
      const Space space = system == "RAS" || system == "0" ? Space::ras : Space::lps;
      if (markup.contains("coordinateUnits") && markup.at("coordinateUnits").is_string() &&
          markup.at("coordinateUnits") != "mm")
        fail_input("the markups are not in mm", path, "save them in mm");
      for (const auto& point : markup.at("controlPoints")) {
        if (point.value("positionStatus", std::string("defined")) != "defined") continue;
        const auto p = point.at("position").get<std::vector<double>>();
        if (p.size() != 3) fail_input("a control point has not three coordinates", path, "save the markups again");
        points.push_back(in_space({p[0], p[1], p[2]}, space, of_mesh));
      }
    }
  } catch (const nlohmann::json::exception&) {
    fail_input("the file is no Slicer markups file", path, "save the points from Slicer as .mrk.json");
  }
  if (points.empty()) fail_input("the markups file holds no control point", path, "place points, then save again");
  return points;
}

/// A criterion: how far a face is from meeting it; 0 or less: it does.
struct Criterion {
  std::string kind;
  std::function<double(std::int32_t)> miss;
  const char* unit = "mm";
  bool can_rank = true;  ///< a distance tells which face is nearest
};

Label label_named(const std::string& name, const SelectionContext& c, const std::string& text) {
  for (const LabelInfo& l : c.labels)
    if (l.name == name || l.name == sanitised_name(name) || std::to_string(l.number) == name) return l.number;
  std::string known;
  for (const LabelInfo& l : c.labels)
    known += (known.empty() ? "" : ", ") + std::to_string(l.number) + " (" + l.name + ")";
  fail_input("label '" + name + "' is not in the mesh", "--select " + text, "choose among: " + known.substr(0, 300));
}

Criterion make(const std::string& word, const SelectionContext& c, const std::string& text) {
  const std::size_t colon = word.find(':');
  if (colon == std::string::npos) fail_usage("'" + word + "' is no criterion", "--select " + text, grammar);
  const std::string kind = word.substr(0, colon), rest = word.substr(colon + 1);
  const auto& faces = c.faces;
  Criterion out;
  out.kind = kind;
  if (kind == "box") {
    const auto v = numbers(rest, 6, 6, text);
    const Vec3 low = {std::min(v[0], v[3]), std::min(v[1], v[4]), std::min(v[2], v[5])};
    const Vec3 high = {std::max(v[0], v[3]), std::max(v[1], v[4]), std::max(v[2], v[5])};
    out.miss = [=, &faces](std::int32_t f) {
      const Vec3 p = faces[f].centre;
      const auto beyond = [](double x, double l, double h) { return std::max({l - x, x - h, 0.0}); };
      return norm({beyond(p.x, low.x, high.x), beyond(p.y, low.y, high.y), beyond(p.z, low.z, high.z)});
    };
  } else if (kind == "sphere") {
    const auto v = numbers(rest, 4, 4, text);
    if (v[3] <= 0) fail_usage("the radius is not above 0", "--select " + text, grammar);
    out.miss = [=, &faces](std::int32_t f) { return norm(faces[f].centre - Vec3{v[0], v[1], v[2]}) - v[3]; };
  } else if (kind == "plane") {
    const auto v = numbers(rest, 6, 7, text);
    const Vec3 n = unit({v[3], v[4], v[5]}, text), p = {v[0], v[1], v[2]};
    const double tolerance = v.size() > 6 ? v[6] : 0.01;
    if (tolerance < 0) fail_usage("the tolerance is negative", "--select " + text, grammar);
    out.miss = [=, &c, &faces](std::int32_t f) {
      double most = 0;
      for (const std::int32_t k : faces[f].v) most = std::max(most, std::abs(dot(n, c.mesh.points[k] - p)));
      return most - tolerance;
    };
  } else if (kind == "normal") {
    const auto v = numbers(rest, 4, 4, text);
    const Vec3 n = unit({v[0], v[1], v[2]}, text);
    if (v[3] <= 0 || v[3] > 180)
      fail_usage("the angle is not above 0 and at most 180 degrees", "--select " + text, grammar);
    out.unit = "degrees";
    out.miss = [=, &faces](std::int32_t f) {
      return std::acos(std::clamp(dot(n, faces[f].normal), -1.0, 1.0)) * 180 / M_PI - v[3];
    };
  } else if (kind == "points") {
    const std::size_t comma = rest.rfind(',');
    if (comma == std::string::npos) fail_usage("no radius behind the markups file", "--select " + text, grammar);
    const double radius = numbers(rest.substr(comma + 1), 1, 1, text)[0];
    if (radius <= 0) fail_usage("the radius is not above 0", "--select " + text, grammar);
    const std::vector<Vec3> points = read_markups(rest.substr(0, comma), c.mesh.space);
    out.miss = [=, &faces](std::int32_t f) {
      double least = std::numeric_limits<double>::max();
      for (const Vec3 p : points) least = std::min(least, norm(faces[f].centre - p));
      return least - radius;
    };
  } else if (kind == "of") {
    const Label label = label_named(rest, c, text);
    out.can_rank = false;
    out.miss = [=, &faces](std::int32_t f) { return faces[f].in == label ? 0.0 : 1.0; };
  } else if (kind == "in") {
    const std::vector<std::int32_t>* set = c.set(rest);
    if (set == nullptr)
      fail_input("set '" + rest + "' is not in the model", "--select " + text,
                 "the nearest are " + nearest_names(rest, c.set_names()));
    std::vector<char> member(faces.size(), 0);
    for (const std::int32_t f : *set) member[f] = 1;
    out.can_rank = false;
    out.miss = [member = std::move(member)](std::int32_t f) { return member[f] != 0 ? 0.0 : 1.0; };
  } else {
    fail_usage("unknown criterion '" + kind + "'", "--select " + text, grammar);
  }
  return out;
}

struct Selection {
  std::string name;
  std::vector<Criterion> criteria;
  bool sided = false;  ///< it says whose faces it means
};

Selection read_selection(const std::string& text, const SelectionContext& c) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) fail_usage("a selection has no name", "--select " + text, grammar);
  Selection s;
  const std::string& name = s.name = text.substr(0, equals);
  if (sanitised_name(name) != name || name.size() > 60)
    fail_usage("'" + name + "' is no name that solvers take", "--select " + text,
               "use letters, digits and _, a letter first, at most 60");
  std::size_t begin = equals + 1;
  while (begin <= text.size()) {
    const std::size_t end = std::min(text.find('&', begin), text.size());
    s.criteria.push_back(make(text.substr(begin, end - begin), c, text));
    s.sided = s.sided || s.criteria.back().kind == "of" || s.criteria.back().kind == "in";
    begin = end + 1;
  }
  return s;
}

}  // namespace

void check_selection(const std::string& text, const std::vector<LabelInfo>& labels) {
  TetMesh no_mesh;
  no_mesh.space = Space::none;
  const std::vector<BoundaryFace> no_faces;
  const std::vector<std::int32_t> any_set;
  read_selection(text, {no_mesh, no_faces, labels, [&](const std::string&) { return &any_set; }, {}, {}});
}

std::pair<std::string, std::vector<std::int32_t>> select_faces(const std::string& text, const SelectionContext& c) {
  const auto [name, criteria, sided] = read_selection(text, c);
  std::vector<std::int32_t> chosen, open;
  for (std::size_t i = 0; i < c.faces.size(); ++i) {
    const auto f = static_cast<std::int32_t>(i);
    if (!sided && c.faces[i].out != 0 && c.faces[i].out < c.faces[i].in) continue;
    open.push_back(f);
    if (std::all_of(criteria.begin(), criteria.end(), [&](const Criterion& k) { return k.miss(f) <= 0; }))
      chosen.push_back(f);
  }
  if (!chosen.empty()) return {name, chosen};

  // Nothing: the face that the first criterion which nothing meets came nearest to, among those that meet the others.
  std::string nearest;
  for (const Criterion& k : criteria) {
    if (!k.can_rank) continue;
    double least = std::numeric_limits<double>::max();
    std::int32_t best = -1;
    for (const std::int32_t f : open) {
      const bool others =
          std::all_of(criteria.begin(), criteria.end(), [&](const Criterion& o) { return &o == &k || o.miss(f) <= 0; });
      const double miss = others ? k.miss(f) : std::numeric_limits<double>::max();
      if (miss > 0 && miss < least) {
        least = miss;
        best = f;
      }
    }
    if (best >= 0)
      nearest += (nearest.empty() ? "" : "; or ") +
                 ("the nearest face misses " + k.kind + " by " + number(least) + " " + k.unit + ", at ") +
                 at(c.faces[best].centre) + " of " + c.place_of(best);
  }
  if (nearest.empty()) nearest = "no face meets any one of its criteria together with the others; loosen them";
  fail_input("selection '" + name + "' is empty", "--select " + text, nearest);
}

}  // namespace stackmesh
