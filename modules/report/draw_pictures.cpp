#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "model/space.h"
#include "report/display_mesh.h"
#include "report/histograms.h"
#include "report/html_report.h"
#include "report/label_colours.h"
#include "report/packed.h"
#include "report/section_cuts.h"
#include "report/worst_places.h"
#include "validate/vertex_distances.h"

namespace stackmesh {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kWorstPlaces = 8;  // of each kind
// Shares of the limit, in bytes before base64.
constexpr double kSliceShare = 0.15, kCutShare = 0.2, kSurfaceShare = 0.25, kTetShare = 0.4;
// What an element takes, deflated, on real meshes; rather too much.
constexpr double kTriangleBytes = 6.5, kTetBytes = 7.5;

Json vec(const Vec3& v) {
  return {v.x, v.y, v.z};
}

Frame frame_of(const LabelVolume& volume, int axis) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  double corner[3] = {0, 0, 0};
  corner[u] = corner[v] = -0.5;
  return {volume.world(corner[0], corner[1], corner[2]), {volume.axes[u], volume.axes[v], volume.axes[axis]}};
}

/// How a section is shown: which stack axis runs to the right and which down, so that radiologists find the
/// patient's right on the left and the front, or the head, on top.
Json orientation(const Frame& lps, bool anatomical) {
  if (!anatomical)
    return {{"right", {{"axis", 0}, {"sign", 1}}},
            {"down", {{"axis", 1}, {"sign", 1}}},
            {"letters", nullptr},
            {"view", "section"}};
  const auto largest = [](const Vec3& v) {
    const double x = std::abs(v.x), y = std::abs(v.y), z = std::abs(v.z);
    return z >= x && z >= y ? 2 : y >= x ? 1 : 0;
  };
  const int stacking = largest(lps.axes[2]);
  const Vec3 right = stacking == 0 ? Vec3{0, 1, 0} : Vec3{1, 0, 0},
             down = stacking == 2 ? Vec3{0, 1, 0} : Vec3{0, 0, -1};
  // left, right, top, bottom of the picture
  const char* letters = stacking == 2 ? "RLAP" : stacking == 1 ? "RLSI" : "APSI";
  const char* view = stacking == 2 ? "axial" : stacking == 1 ? "coronal" : "sagittal";
  const int across = std::abs(dot(lps.axes[0], right)) >= std::abs(dot(lps.axes[1], right)) ? 0 : 1;
  return {{"right", {{"axis", across}, {"sign", dot(lps.axes[across], right) < 0 ? -1 : 1}}},
          {"down", {{"axis", 1 - across}, {"sign", dot(lps.axes[1 - across], down) < 0 ? -1 : 1}}},
          {"letters", letters},
          {"view", view}};
}

LabelIndex labels_of(const HtmlScene& scene) {
  std::map<Label, LabelInfo> labels = {{0, {0, ""}}};
  if (scene.volume != nullptr)
    for (const LabelInfo& l : scene.volume->labels) labels[l.number] = l;
  if (scene.sections != nullptr)
    for (const LabelInfo& l : scene.sections->labels) labels[l.number] = l;
  for (const InterfaceTriangle& t : scene.surface->triangles)
    for (const Label number : {t.below, t.above})
      if (labels.count(number) == 0) labels[number] = {number, ""};
  std::vector<LabelInfo> list;
  for (const auto& [number, info] : labels) list.push_back(info);
  return LabelIndex(std::move(list));
}

class Pictures {
 public:
  Pictures(const HtmlScene& scene, const HtmlOptions& options)
      : scene_(scene),
        options_(options),
        index_(labels_of(scene)),
        bytes_(0.75 * static_cast<double>(options.bytes_limit)) {}

  HtmlPictures draw() {
    place();
    describe_labels();
    if (options_.labels && scene_.volume != nullptr) slices();
    if (options_.labels && scene_.sections != nullptr) contours();
    cuts();
    if (scene_.volume != nullptr && !scene_.surface->triangles.empty()) distances();
    meshes();
    histograms();
    places();
    HtmlPictures out;
    out.space = space();
    out.json = json_.dump(-1, ' ', false, Json::error_handler_t::replace);
    for (const Blob& b : blobs_) out.blobs.emplace_back(b.name(), base64(b.bytes()));
    return out;
  }

 private:
  Space space() const { return scene_.surface->space; }

  /// The frame of the sections, and the heights of sections and mid-gaps.
  void place() {
    Frame lps;
    std::vector<double> heights;
    if (scene_.volume != nullptr) {
      const LabelVolume& v = *scene_.volume;
      const int axis = scene_.stack_axis;
      lps = frame_of(v, axis);
      for (int k = 0; k < v.size[axis]; ++k) heights.push_back(k * v.spacing_mm[axis]);
      pixel_ = {v.spacing_mm[(axis + 1) % 3], v.spacing_mm[(axis + 2) % 3]};
    } else if (scene_.sections != nullptr) {
      lps = scene_.sections->frame;
      for (const Section& s : scene_.sections->sections)
        if (!s.interpolated) heights.push_back(s.z_mm);
      pixel_ = {scene_.sections->pixel_mm, scene_.sections->pixel_mm};
    }
    const bool of_box = heights.empty();
    if (of_box) heights = spread_heights();
    if (of_box && space() == Space::ras)  // the planes lie across the mesh's own axes
      for (Vec3& a : lps.axes) a = in_space(a, Space::ras, Space::lps);
    frame_ = lps;
    frame_.origin = in_space(lps.origin, Space::lps, space());
    for (Vec3& a : frame_.axes) a = in_space(a, Space::lps, space());
    Json planes = Json::array();
    for (std::size_t k = 0; k < heights.size(); ++k) {
      if (k > 0 && !of_box) {
        heights_.push_back(0.5 * (heights[k - 1] + heights[k]));
        planes.push_back({{"z", heights_.back()}, {"section", static_cast<double>(k) - 0.5}});
      }
      heights_.push_back(heights[k]);
      planes.push_back({{"z", heights[k]}, {"section", k}});
    }
    drawing_.unit_mm = std::min(pixel_[0], pixel_[1]) / 64;
    drawing_.tolerance_mm = 2 * drawing_.unit_mm;
    drawing_.threads = options_.threads;
    json_["space"] = to_text(space());
    json_["frame"] = {{"origin", vec(frame_.origin)},
                      {"axes", {vec(frame_.axes[0]), vec(frame_.axes[1]), vec(frame_.axes[2])}}};
    json_["orientation"] = orientation(lps, space() != Space::none);
    json_["pixel_mm"] = pixel_;
    json_["planes"] = planes;
    json_["planes_are"] = of_box ? "planes" : "sections";
  }

  /// Without labels or contours, planes across z from end to end of the mesh.
  std::vector<double> spread_heights() {
    std::vector<double> heights;
    if (scene_.surface->triangles.empty()) return heights;
    double low = scene_.surface->points[scene_.surface->triangles[0].v[0]].z, high = low, longest = 0;
    for (const InterfaceTriangle& t : scene_.surface->triangles)
      for (int k = 0; k < 3; ++k) {
        const Vec3 &p = scene_.surface->points[t.v[k]], &q = scene_.surface->points[t.v[(k + 1) % 3]];
        low = std::min(low, p.z), high = std::max(high, p.z);
        longest = std::max(longest, norm(q - p));
      }
    constexpr int kPlanes = 60;
    for (int k = 0; k < kPlanes; ++k) heights.push_back(low + (high - low) * (k + 0.5) / kPlanes);
    pixel_ = {longest / 8, longest / 8};
    return heights;
  }

  void describe_labels() {
    Json list = Json::array();
    const std::vector<std::string> colours = label_colours(index_.labels());
    for (std::size_t l = 0; l < colours.size(); ++l)
      list.push_back({{"label", index_.labels()[l].number}, {"name", index_.labels()[l].name}, {"colour", colours[l]}});
    json_["labels"] = list;
  }

  /// Adds chunks as a blob; what the page needs to find them.
  Json add(const std::string& name, const std::vector<std::string>& chunks) {
    blobs_.emplace_back(name);
    blobs_.back().add(chunks, options_.threads);
    return {{"blob", name}, {"offsets", blobs_.back().offsets()}};
  }

  /// As add(), with every second chunk left empty, again and again, until the blob is within its share of the limit.
  Json add_within(const std::string& name, std::vector<std::string> chunks, double share) {
    Json j = add(name, chunks);
    std::size_t step = 1;
    for (; static_cast<double>(blobs_.back().bytes().size()) > share * bytes_ && step < chunks.size();
         j = add(name, chunks)) {
      blobs_.pop_back();
      step *= 2;
      for (std::size_t k = 0; k < chunks.size(); ++k)
        if (k % step != 0) chunks[k].clear();
    }
    j["step"] = step;
    return j;
  }

  void slices() {
    const PixelWindow window = window_of_labels(*scene_.volume, scene_.stack_axis);
    Json j = add_within("slices", pack_slices(*scene_.volume, scene_.stack_axis, window, index_, options_.threads),
                        kSliceShare);
    j["window"] = {window.x, window.y, window.width, window.height};
    json_["slices"] = j;
  }

  void contours() {
    std::vector<std::string> chunks;
    for (const Section& s : scene_.sections->sections)
      if (!s.interpolated) chunks.push_back(draw_section(*scene_.sections, s, index_, drawing_));
    Json j = add("contours", chunks);
    j["unit_mm"] = drawing_.unit_mm;
    json_["contours"] = j;
  }

  void cuts() {
    if (heights_.empty()) return;
    CurveDrawing drawing = drawing_;
    std::vector<std::string> packed = cut_complex(*scene_.surface, frame_, heights_, index_, drawing);
    const auto deflated_size = [&] {
      Blob trial("cuts");
      trial.add(packed, options_.threads);
      return static_cast<double>(trial.bytes().size());
    };
    while (drawing.tolerance_mm < 0.25 * pixel_[0] && deflated_size() > kCutShare * bytes_) {
      drawing.tolerance_mm *= 2;
      packed = cut_complex(*scene_.surface, frame_, heights_, index_, drawing);
    }
    Json j = add_within("cuts", std::move(packed), kCutShare);
    j["unit_mm"] = drawing.unit_mm;
    j["tolerance_mm"] = drawing.tolerance_mm;
    json_["cuts"] = j;
  }

  void distances() {
    if (space() != Space::ras) {
      distances_mm_ = vertex_distances(*scene_.surface, *scene_.volume, scene_.stack_axis, options_.threads);
      return;
    }
    InterfaceComplex lps = *scene_.surface;
    change_space(lps, Space::lps);
    distances_mm_ = vertex_distances(lps, *scene_.volume, scene_.stack_axis, options_.threads);
  }

  Json describe(const PackedMesh& m, const std::string& name, const DisplayGrid& grid, std::size_t of) {
    Json j = add(name, m.chunks);
    j["arrays"] = m.names;
    j["vertices"] = m.vertices;
    j["elements"] = m.elements;
    j["of"] = of;
    j["origin_mm"] = vec(grid.origin_mm);
    j["unit_mm"] = grid.unit_mm;
    return j;
  }

  void meshes() {
    if (scene_.surface->triangles.empty()) return;
    const DisplayGrid grid = grid_over(scene_.surface->points);
    PackedMesh packed;
    const std::vector<TriangleValues> values =
        scene_.values == nullptr ? std::vector<TriangleValues>() : values_on(*scene_.surface, *scene_.values);
    json_["surface"] = fitted("surface", grid, scene_.surface->triangles.size(), kSurfaceShare,
                              std::min(400e3, kSurfaceShare * bytes_ / kTriangleBytes), packed, [&](std::size_t most) {
                                return pack_surface(*scene_.surface, distances_mm_, grid, index_, most, values);
                              });
    if (!values.empty())
      json_["surface"]["model"] = {{"sets", scene_.values->sets},
                                   {"modulus_low_mpa", scene_.values->modulus_low_mpa},
                                   {"modulus_high_mpa", scene_.values->modulus_high_mpa},
                                   {"mises_high_mpa", scene_.values->mises_high_mpa}};
    json_["surface"]["cell_mm"] = packed.cell_mm;
    json_["surface"]["distance_unit_mm"] = packed.distance_unit_mm;
    if (scene_.mesh == nullptr || scene_.mesh->tets.empty()) return;
    TetMesh divided;  // wedges are drawn as tetrahedra
    if (!scene_.mesh->wedges.empty()) divided = with_tets_only(*scene_.mesh);
    const TetMesh& drawn = scene_.mesh->wedges.empty() ? *scene_.mesh : divided;
    const DisplayGrid tet_grid = grid_over(drawn.points);
    json_["tets"] =
        fitted("tets", tet_grid, drawn.tets.size(), kTetShare, std::min(1e6, kTetShare * bytes_ / kTetBytes), packed,
               [&](std::size_t most) { return pack_tets(drawn, tet_grid, index_, most, options_.threads); });
    json_["tets"]["one_of"] = packed.one_of;
  }

  /// Packs with fewer and fewer elements until the blob is within its share of the limit.
  template <class Pack>
  Json fitted(const std::string& name, const DisplayGrid& grid, std::size_t of, double share, double most,
              PackedMesh& packed, Pack pack) {
    packed = pack(static_cast<std::size_t>(most));
    Json j = describe(packed, name, grid, of);
    while (static_cast<double>(blobs_.back().bytes().size()) > share * bytes_ && packed.elements > 100) {
      blobs_.pop_back();
      packed = pack(packed.elements / 2);
      j = describe(packed, name, grid, of);
    }
    return j;
  }

  void histograms() {
    Json list = Json::array();
    for (const Histogram& h : make_histograms(*scene_.surface, scene_.mesh, distances_mm_, options_.threads))
      list.push_back({{"name", h.name},
                      {"title", h.title},
                      {"unit", h.unit},
                      {"low", h.low},
                      {"high", h.high},
                      {"counts", h.counts},
                      {"values", h.values},
                      {"smallest", h.smallest},
                      {"median", h.median},
                      {"largest", h.largest}});
    json_["histograms"] = list;
  }

  void places() {
    Json list = Json::array();
    const double apart_mm = 5 * std::max(pixel_[0], pixel_[1]);
    for (const WorstPlace& p : find_worst_places(*scene_.surface, scene_.mesh, distances_mm_, kWorstPlaces, apart_mm)) {
      Json corners = Json::array(), labels = Json::array();
      for (const Vec3& c : p.corners_mm) corners.push_back(vec(c));
      for (const Label l : p.labels) labels.push_back(index_(l));
      list.push_back({{"kind", p.kind},
                      {"figure", p.figure},
                      {"at_mm", vec(p.at_mm)},
                      {"corners_mm", corners},
                      {"labels", labels}});
    }
    json_["worst"] = list;
  }

  const HtmlScene& scene_;
  const HtmlOptions& options_;
  const LabelIndex index_;
  const double bytes_;
  Frame frame_;
  std::array<double, 2> pixel_ = {1, 1};
  std::vector<double> heights_;
  CurveDrawing drawing_;
  std::vector<float> distances_mm_;
  std::vector<Blob> blobs_;
  Json json_ = Json::object();
};

}  // namespace

HtmlPictures draw_pictures(const HtmlScene& scene, const HtmlOptions& options) {
  if (scene.stack_axis < 0 || scene.stack_axis > 2)
    fail_usage("stacking axis " + std::to_string(scene.stack_axis), "HTML report", "use 0, 1 or 2");
  return Pictures(scene, options).draw();
}

}  // namespace stackmesh
