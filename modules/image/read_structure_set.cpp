#include "image/read_structure_set.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <sstream>

#include "base/error.h"
#include "base/warning.h"
#include "image/dicom_dataset.h"
#include "model/label_table.h"
#include "model/label_volume.h"

namespace stackmesh {
namespace {

constexpr double kSameHeight_mm = 0.01;
constexpr double kPlanar_mm = 0.05;  // coordinates are decimal texts, often rounded
constexpr const char* again = "export the structure set again";

struct RawContour {
  std::size_t structure = 0, number = 0;  // number: from 1, in the file's order
  std::vector<Vec3> points;
};

std::string list(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size() && i < 12; ++i) text += (i > 0 ? ", " : "") + names[i];
  return names.size() > 12 ? text + " and " + std::to_string(names.size() - 12) + " more" : text;
}

/// Twice the area, along the normal (Newell).
Vec3 area_vector(const std::vector<Vec3>& p) {
  Vec3 sum;
  for (std::size_t i = 1; i + 1 < p.size(); ++i) sum = sum + cross(p[i] - p[0], p[i + 1] - p[0]);
  return sum;
}

class StructureSetReader {
 public:
  StructureSetReader(const std::string& path, const std::string& labels)
      : path_(path), labels_(labels), file_(load_dicom(path)), data_(*file_->getDataset()) {}

  StructureSet run() {
    read_structures();
    chosen_ = LabelTable(set_.structures).in_order(labels_);
    read_contours();
    find_planes();
    for (RawContour& c : contours_) place(c);
    StructureSet chosen;
    for (std::size_t k : chosen_) {
      LabelContours& s = set_.structures[k];
      if (s.sections.empty() && !labels_.empty())
        fail_input("structure '" + s.name + "' has no closed contour", path_, "leave it out of --label, or draw it");
      if (s.sections.empty()) continue;
      merge_heights(s);
      chosen.structures.push_back(std::move(s));
    }
    if (chosen.structures.empty()) fail_input("no structure has a closed contour", path_, again);
    if (!empty_.empty())
      set_.warnings.push_back(warning_at(WarningCode::left_out, path_, "no closed contour for " + list(empty_)));
    chosen.frame = set_.frame;
    chosen.warnings = std::move(set_.warnings);
    return chosen;
  }

 private:
  std::string where(std::size_t structure, std::size_t contour) const {
    return path_ + ", structure '" + set_.structures[structure].name + "', contour " + std::to_string(contour);
  }

  void read_structures() {
    std::set<Label> taken;
    std::vector<std::size_t> unnumbered;
    for (DcmItem* item : items_of(data_, DCM_StructureSetROISequence)) {
      const std::optional<double> number = number_of(*item, DCM_ROINumber, path_);
      LabelContours s;
      s.path = path_;
      s.name = text_of(*item, DCM_ROIName);
      if (number && std::abs(*number) < 1e15) by_number_.emplace(static_cast<long>(*number), set_.structures.size());
      const bool usable =
          number && *number >= 1 && *number < 2147483648.0 && taken.insert(static_cast<Label>(*number)).second;
      s.label = usable ? static_cast<Label>(*number) : 0;
      if (!usable) unnumbered.push_back(set_.structures.size());
      set_.structures.push_back(std::move(s));
    }
    if (set_.structures.empty()) fail_input("the structure set names no structure", path_, again);
    Label next = 1;
    for (std::size_t k : unnumbered) {
      while (!taken.insert(next).second) ++next;
      set_.structures[k].label = next;
      set_.warnings.push_back(warning_at(WarningCode::renumbered, path_,
                                         "structure '" + set_.structures[k].name +
                                             "' has no ROI number of its own above 0; it becomes label " +
                                             std::to_string(next)));
    }
    for (LabelContours& s : set_.structures)
      if (s.name.empty()) s.name = "structure_" + std::to_string(s.label);
  }

  void read_contours() {
    std::set<std::size_t> filled;
    for (DcmItem* roi : items_of(data_, DCM_ROIContourSequence)) {
      const std::optional<double> number = number_of(*roi, DCM_ReferencedROINumber, path_);
      const auto found =
          number && std::abs(*number) < 1e15 ? by_number_.find(static_cast<long>(*number)) : by_number_.end();
      if (found == by_number_.end()) {
        set_.warnings.push_back(warning_at(WarningCode::left_out, path_,
                                           "contours of a structure that the file does not name are left out"));
        continue;
      }
      const std::size_t k = found->second;
      if (std::find(chosen_.begin(), chosen_.end(), k) == chosen_.end()) continue;
      const std::vector<double> colour = numbers_of(*roi, DCM_ROIDisplayColor, path_);
      if (colour.size() == 3) {
        std::array<std::uint8_t, 3> rgb{};
        for (int i = 0; i < 3; ++i) rgb[i] = static_cast<std::uint8_t>(std::clamp(colour[i], 0.0, 255.0));
        set_.structures[k].colour = rgb;
      }
      if (read_structure(*roi, k)) filled.insert(k);
    }
    for (std::size_t k : chosen_)
      if (filled.count(k) == 0) empty_.push_back("'" + set_.structures[k].name + "'");
  }

  /// @return whether it has a contour that bounds something
  bool read_structure(DcmItem& roi, std::size_t k) {
    std::vector<std::string> open, thin, other;
    std::size_t number = 0;
    bool any = false;
    for (DcmItem* item : items_of(roi, DCM_ContourSequence)) {
      ++number;
      const std::string type = text_of(*item, DCM_ContourGeometricType);
      const std::vector<double> data = numbers_of(*item, DCM_ContourData, where(k, number));
      if (data.size() % 3 != 0)
        fail_input("a contour has " + std::to_string(data.size()) + " coordinates, no multiple of three",
                   where(k, number), again);
      for (const double value : data)
        if (!(std::abs(value) <= 1e12))
          fail_input("a contour has a point farther away than 1e12 mm", where(k, number), again);
      const std::optional<double> announced = number_of(*item, DCM_NumberOfContourPoints, where(k, number));
      if (announced && *announced != static_cast<double>(data.size() / 3)) {
        std::ostringstream text;
        text << data.size() / 3 << " points where its header says " << *announced << "; all are read";
        set_.warnings.push_back(warning_at(WarningCode::header, where(k, number), text.str()));
      }
      RawContour c;
      c.structure = k;
      c.number = number;
      for (std::size_t i = 0; i < data.size(); i += 3) {
        const Vec3 p{data[i], data[i + 1], data[i + 2]};
        if (c.points.empty() || norm(p - c.points.back()) > 0) c.points.push_back(p);
      }
      while (c.points.size() > 1 && norm(c.points.back() - c.points.front()) == 0) c.points.pop_back();
      if (type == "POINT" || type == "OPEN_NONPLANAR") {
        other.push_back(std::to_string(number));
        continue;
      }
      if (c.points.size() < 3 || norm(area_vector(c.points)) == 0) {
        thin.push_back(std::to_string(number));
        continue;
      }
      if (type == "OPEN_PLANAR") open.push_back(std::to_string(number));
      any = true;
      contours_.push_back(std::move(c));
    }
    const std::string of = path_ + ": structure '" + set_.structures[k].name + "'";
    if (!open.empty())
      set_.warnings.push_back(
          warning_at(WarningCode::contours_mended, of, "open contours closed by a straight line: " + list(open)));
    if (!thin.empty())
      set_.warnings.push_back(
          warning_at(WarningCode::left_out, of,
                     "contours that bound no area (fewer than three points, or on a line) left out: " + list(thin)));
    if (!other.empty())
      set_.warnings.push_back(
          warning_at(WarningCode::left_out, of, "points and curves that are no outlines left out: " + list(other)));
    return any;
  }

  /// The direction that all planes share: z as it is for axial contours, else that of the largest contour.
  void find_planes() {
    if (contours_.empty()) return;
    Vec3 largest;
    bool axial = true;
    for (const RawContour& c : contours_) {
      const Vec3 a = area_vector(c.points);
      if (norm(a) > norm(largest)) largest = a;
      for (const Vec3& p : c.points) axial = axial && std::abs(p.z - c.points[0].z) <= kSameHeight_mm;
    }
    if (axial) return;
    Vec3 n = (1 / norm(largest)) * largest;
    int main = std::abs(n.x) > std::abs(n.y) ? 0 : 1;
    if (std::abs(n.z) > std::abs(main == 0 ? n.x : n.y)) main = 2;
    const std::array<double, 3> parts = {n.x, n.y, n.z};
    if (parts[main] < 0) n = -1.0 * n;
    // Right-handed, u and v as near to the two following patient axes as the plane lets them be.
    const std::array<Vec3, 3> patient = {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
    Vec3 u = patient[(main + 1) % 3];
    if (norm(n - patient[main]) < 1e-6) n = patient[main];
    u = u - dot(u, n) * n;
    u = (1 / norm(u)) * u;
    set_.frame.axes = {u, cross(n, u), n};
    if (in_tenths()) planar_mm_ += 0.1 * (std::abs(n.x) + std::abs(n.y) + std::abs(n.z));
    set_.warnings.push_back(warning_at(WarningCode::header, path_,
                                       "the contours do not lie in axial planes; they are stacked along (" +
                                           std::to_string(n.x) + ", " + std::to_string(n.y) + ", " +
                                           std::to_string(n.z) + ")"));
  }

  /// Written with one decimal: oblique points then lie up to 0.05 mm along each axis beside their plane.
  bool in_tenths() const {
    for (const RawContour& c : contours_)
      for (const Vec3& p : c.points)
        for (double x : {p.x, p.y, p.z})
          if (std::abs(10 * x - std::round(10 * x)) > 1e-6) return false;
    return true;
  }

  void place(const RawContour& c) {
    ContourSection section;
    ContourPolygon polygon;
    double low = 0, high = 0, sum = 0;
    for (std::size_t i = 0; i < c.points.size(); ++i) {
      const Vec3 p = set_.frame.to_stack(c.points[i]);
      low = i == 0 ? p.z : std::min(low, p.z);
      high = i == 0 ? p.z : std::max(high, p.z);
      sum += p.z;
      polygon.points.push_back({p.x, p.y});
    }
    if (high - low > planar_mm_)
      fail_input("the contour does not lie in a plane parallel to the others", where(c.structure, c.number),
                 "leave the structure out with --label, or redraw it in one family of parallel planes");
    section.z_mm = high == low ? low : sum / static_cast<double>(c.points.size());
    section.polygons.push_back(std::move(polygon));
    set_.structures[c.structure].sections.push_back(std::move(section));
  }

  static void merge_heights(LabelContours& s) {
    std::stable_sort(s.sections.begin(), s.sections.end(),
                     [](const ContourSection& a, const ContourSection& b) { return a.z_mm < b.z_mm; });
    std::vector<ContourSection> merged;
    for (ContourSection& c : s.sections) {
      if (!merged.empty() && c.z_mm - merged.back().z_mm <= kSameHeight_mm)
        merged.back().polygons.push_back(std::move(c.polygons[0]));
      else merged.push_back(std::move(c));
    }
    s.sections = std::move(merged);
  }

  const std::string path_, labels_;
  std::unique_ptr<DcmFileFormat> file_;
  DcmDataset& data_;
  StructureSet set_;
  std::map<long, std::size_t> by_number_;
  std::vector<std::size_t> chosen_;  // structures, in the order asked
  std::vector<RawContour> contours_;
  double planar_mm_ = kPlanar_mm;  // how far a contour may leave its plane
  std::vector<std::string> empty_;
};

}  // namespace

StructureSet read_structure_set(const std::string& path, const std::string& labels) {
  return StructureSetReader(path, labels).run();
}

}  // namespace stackmesh
