// The junctions of the 61-label torso, stitched, smoothed and remeshed: angles between sheets, thickness of walls over
// edge length, and how many triangles a halfedge mesh refuses when each label's shell is built in it.
// Usage: bench_junctions [LABELS.nii.gz [EDGE_MM]]; prints Markdown tables for docs/enhancement.md.
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Core/System/omstream.hh>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <set>

#include "enhance/complex_mesh.h"
#include "enhance/enhance.h"
#include "enhance/sizing.h"
#include "image/read_labels.h"
#include "sections/extract.h"
#include "stitch/stitch.h"

namespace {

using namespace stackmesh;

constexpr double kAngles[] = {1, 5, 10, 15, 20, 30, 60, 90, 120, 180.001};
constexpr double kRatios[] = {0.1, 0.25, 0.5, 1, 2, 4, 1e300};

struct Study {
  std::size_t edges = 0;
  std::map<double, std::size_t> angles, ratios;
  std::size_t refused = 0;
};

/// Angles between neighbouring sheets round each edge at which three sheets or more meet.
void study_angles(const InterfaceComplex& c, Study& out) {
  std::map<std::pair<std::int32_t, std::int32_t>, std::vector<std::int32_t>> apexes;
  for (const InterfaceTriangle& t : c.triangles)
    for (int k = 0; k < 3; ++k) apexes[std::minmax(t.v[k], t.v[(k + 1) % 3])].push_back(t.v[(k + 2) % 3]);
  for (const auto& [edge, around] : apexes) {
    if (around.size() < 3) continue;
    ++out.edges;
    const Vec3 a = c.points[edge.first], e = c.points[edge.second] - a, axis = (1 / norm(e)) * e;
    const auto across = [&](std::int32_t v) {
      const Vec3 d = c.points[v] - a;
      return d - dot(d, axis) * axis;
    };
    const Vec3 x = (1 / norm(across(around[0]))) * across(around[0]), y = cross(axis, x);
    std::vector<double> turns;
    for (std::int32_t v : around) turns.push_back(std::atan2(dot(across(v), y), dot(across(v), x)) * 180 / M_PI);
    std::sort(turns.begin(), turns.end());
    for (std::size_t i = 0; i < turns.size(); ++i) {
      const double next = i + 1 < turns.size() ? turns[i + 1] : turns[0] + 360;
      const double angle = std::min(next - turns[i], 180.0);
      ++out.angles[*std::upper_bound(std::begin(kAngles), std::end(kAngles) - 1, angle)];
    }
  }
}

void study_thickness(const InterfaceComplex& c, double reach_mm, Study& out) {
  const ComplexMesh mesh(c, 1e300);
  const std::vector<double> thin = wall_thickness(mesh, reach_mm, 0);
  std::vector<std::int32_t> around;
  for (std::int32_t v = 0; v < static_cast<std::int32_t>(thin.size()); ++v) {
    if (mesh.star[v].empty() || !mesh.curve[v].empty()) continue;
    mesh.neighbours(v, around);
    double sum = 0;
    for (std::int32_t w : around) sum += norm(mesh.points[w] - mesh.points[v]);
    const double ratio = std::min(thin[v] / (sum / static_cast<double>(around.size())), 1e299);
    ++out.ratios[*std::upper_bound(std::begin(kRatios), std::end(kRatios) - 1, ratio)];
  }
}

void study_shells(const InterfaceComplex& c, Study& out) {
  std::set<Label> labels;
  for (const InterfaceTriangle& t : c.triangles) labels.insert({t.below, t.above});
  labels.erase(0);
  for (Label label : labels) {
    OpenMesh::TriMesh_ArrayKernelT<> shell;
    std::map<std::int32_t, OpenMesh::VertexHandle> vertex;
    for (const InterfaceTriangle& t : c.triangles) {
      if (t.below != label && t.above != label) continue;
      OpenMesh::VertexHandle v[3];
      for (int i = 0; i < 3; ++i) {
        const std::int32_t id = t.v[t.below == label ? i : 2 - i];
        const auto [it, fresh] = vertex.emplace(id, OpenMesh::VertexHandle());
        if (fresh) it->second = shell.add_vertex(OpenMesh::TriMesh_ArrayKernelT<>::Point(0, 0, 0));
        v[i] = it->second;
      }
      out.refused += !shell.add_face(v[0], v[1], v[2]).is_valid();
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::string path =
      argc > 1 ? argv[1] : std::string(STACKMESH_SHARED_DATA) + "/torso_totalseg/torso_3mm_61labels.nii.gz";
  Monitor quiet;
  Stack stack = extract_sections(read_label_volume(path), {}, quiet).stack;
  EnhanceOptions o;
  o.pixel_mm = stack.pixel_mm;
  o.gap_mm =
      (stack.sections.back().z_mm - stack.sections.front().z_mm) / static_cast<double>(stack.sections.size() - 1);
  o.edge_length_mm = argc > 2 ? std::atof(argv[2]) : 6;
  const InterfaceComplex stitched = stitch_sections(stack, {}, quiet).complex;
  o.remesh = false;
  const InterfaceComplex smoothed = enhance_complex(stitched, o, quiet).complex;
  o.remesh = true;
  const InterfaceComplex remeshed = enhance_complex(stitched, o, quiet).complex;
  ::omerr().disable();
  const InterfaceComplex* stages[3] = {&stitched, &smoothed, &remeshed};
  Study study[3];
  for (int k = 0; k < 3; ++k) {
    study_angles(*stages[k], study[k]);
    study_thickness(*stages[k], 4 * *o.edge_length_mm, study[k]);
    study_shells(*stages[k], study[k]);
  }
  const auto row = [&](const std::string& name, auto value) {
    std::printf("| %s |", name.c_str());
    for (int k = 0; k < 3; ++k) std::printf(" %zu |", static_cast<std::size_t>(value(k)));
    std::printf("\n");
  };
  std::printf("| | stitched | smoothed | remeshed |\n|---|---|---|---|\n");
  row("triangles", [&](int k) { return stages[k]->triangles.size(); });
  row("edges of three sheets or more", [&](int k) { return study[k].edges; });
  for (double a : kAngles)
    row("angles below " + std::to_string(static_cast<int>(a)) + " degrees", [&](int k) { return study[k].angles[a]; });
  char text[64];
  for (double r : kRatios) {
    std::snprintf(text, sizeof text, r < 1e9 ? "thickness below %g edges" : "thickness of more edges", r);
    row(text, [&](int k) { return study[k].ratios[r]; });
  }
  row("triangles refused by OpenMesh", [&](int k) { return study[k].refused; });
}
