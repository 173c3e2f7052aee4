#include "meshio/write_sections.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <set>
#include <vector>

#include "base/error.h"
#include "base/text.h"

namespace stackmesh {
namespace {

using Loop = std::vector<std::array<double, 2>>;

std::string ending(const std::string& path) {
  const std::size_t dot = path.rfind('.');
  return dot == std::string::npos ? "" : lower_case(path.substr(dot));
}

std::array<double, 2> position(const Stack& stack, GridPoint p) {
  return {p.x * stack.grid_x_mm, p.y * stack.grid_y_mm};
}

/// The closed borders of a label in a section, the label on their left. Where a border meets itself in a point it
/// turns sharpest to the left, so that loops touch but do not cross.
std::vector<Loop> loops_of(const Stack& stack, const Section& section, Label label) {
  struct Directed {
    std::int32_t from, to;
  };
  std::vector<Directed> edges;
  for (const SectionEdge& e : section.edges) {
    if (e.left == label) edges.push_back({e.a, e.b});
    else if (e.right == label) edges.push_back({e.b, e.a});
  }
  std::multimap<std::int32_t, std::size_t> leaving;
  for (std::size_t i = 0; i < edges.size(); ++i) leaving.emplace(edges[i].from, i);
  std::vector<char> used(edges.size(), 0);
  std::vector<Loop> loops;
  for (std::size_t start = 0; start < edges.size(); ++start) {
    if (used[start]) continue;
    Loop loop;
    for (std::size_t e = start; !used[e];) {
      used[e] = 1;
      loop.push_back(position(stack, section.points[edges[e].from]));
      const GridPoint from = section.points[edges[e].from], at = section.points[edges[e].to];
      const auto [first, last] = leaving.equal_range(edges[e].to);
      double best = -10;
      for (auto it = first; it != last; ++it) {
        if (used[it->second] && it->second != start) continue;
        const GridPoint to = section.points[edges[it->second].to];
        const double ux = at.x - from.x, uy = at.y - from.y, vx = to.x - at.x, vy = to.y - at.y;
        const double turn = std::atan2(ux * vy - uy * vx, ux * vx + uy * vy);
        if (turn > best) {
          best = turn;
          e = it->second;
        }
      }
      if (best == -10) break;
    }
    loops.push_back(std::move(loop));
  }
  return loops;
}

std::set<Label> labels_of(const Stack& stack) {
  std::set<Label> labels;
  for (const Section& s : stack.sections)
    for (const SectionEdge& e : s.edges) {
      labels.insert(e.left);
      labels.insert(e.right);
    }
  labels.erase(0);
  return labels;
}

void write_json(std::FILE* f, const Stack& stack) {
  std::fprintf(f, "{\"schema\": 1, \"unit\": \"mm\", \"sections\": [");
  for (std::size_t i = 0; i < stack.sections.size(); ++i) {
    const Section& s = stack.sections[i];
    std::fprintf(f, "%s\n{\"z\": %.17g, \"points\": [", i ? "," : "", s.z_mm);
    for (std::size_t v = 0; v < s.points.size(); ++v) {
      const auto p = position(stack, s.points[v]);
      std::fprintf(f, "%s[%.17g,%.17g]", v ? "," : "", p[0], p[1]);
    }
    std::fprintf(f, "], \"edges\": [");
    for (std::size_t e = 0; e < s.edges.size(); ++e)
      std::fprintf(f, "%s[%d,%d,%d,%d]", e ? "," : "", s.edges[e].a, s.edges[e].b, s.edges[e].left, s.edges[e].right);
    std::fprintf(f, "]}");
  }
  std::fprintf(f, "\n]}\n");
}

/// Where a contour file's coordinates start: the format has no axes, so only sections that lie in the world's own can
/// be put in their place.
Vec3 start_of(const Stack& stack) {
  const Frame plain;
  for (int k = 0; k < 3; ++k)
    if (norm(stack.frame.axes[k] - plain.axes[k]) > 1e-6) return {};
  return stack.frame.origin;
}

void write_cnt(std::FILE* f, const Stack& stack, Label label) {
  const Vec3 start = start_of(stack);
  std::vector<std::pair<double, std::vector<Loop>>> sections;
  for (const Section& s : stack.sections) {
    std::vector<Loop> loops = loops_of(stack, s, label);
    if (!loops.empty()) sections.emplace_back(s.z_mm, std::move(loops));
  }
  std::fprintf(f, "S %zu\n", sections.size());
  for (const auto& [z, loops] : sections) {
    std::size_t count = 0;
    for (const Loop& l : loops) count += l.size();
    std::fprintf(f, "v %zu z %.17g\n", count, z + start.z);
    for (const Loop& l : loops) {
      std::fprintf(f, "{\n");
      for (const auto& p : l) std::fprintf(f, "%.17g %.17g\n", p[0] + start.x, p[1] + start.y);
      std::fprintf(f, "}\n");
    }
  }
}

void write_svg(std::FILE* f, const Stack& stack) {
  double x0 = std::numeric_limits<double>::infinity(), y0 = x0, x1 = -x0, y1 = -x0;
  for (const Section& s : stack.sections)
    for (const GridPoint g : s.points) {
      const auto p = position(stack, g);
      x0 = std::min(x0, p[0]);
      x1 = std::max(x1, p[0]);
      y0 = std::min(y0, p[1]);
      y1 = std::max(y1, p[1]);
    }
  const double margin = 0.05 * std::max(x1 - x0, y1 - y0), w = x1 - x0 + 2 * margin, h = y1 - y0 + 2 * margin;
  const int columns = std::max(1, static_cast<int>(std::ceil(std::sqrt(stack.sections.size() * h / w))));
  const int rows = (static_cast<int>(stack.sections.size()) + columns - 1) / columns;
  std::fprintf(f,
               "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %.6g %.6g\" width=\"%d\">\n<title>%zu "
               "sections</title>\n",
               columns * w, rows * h, std::min(2400, 240 * columns), stack.sections.size());
  const std::set<Label> labels = labels_of(stack);
  for (std::size_t i = 0; i < stack.sections.size(); ++i) {
    const Section& s = stack.sections[i];
    std::fprintf(f, "<g transform=\"translate(%.6g %.6g)\"><title>section %zu, z = %.6g mm</title>\n",
                 static_cast<double>(i % columns) * w + margin - x0, static_cast<double>(i / columns) * h + margin - y0,
                 i + 1, s.z_mm);
    int hue = 0;
    for (Label label : labels) {
      hue += 137;
      const std::vector<Loop> loops = loops_of(stack, s, label);
      if (loops.empty()) continue;
      std::fprintf(f,
                   "<path fill=\"hsl(%d 60%% 70%%)\" fill-rule=\"evenodd\" stroke=\"#222\" stroke-width=\"%.4g\" d=\"",
                   hue % 360, w / 400);
      for (const Loop& l : loops)
        for (std::size_t k = 0; k < l.size(); ++k)
          std::fprintf(f, "%s%.6g %.6g%s", k ? "L" : "M", l[k][0], l[k][1], k + 1 == l.size() ? "Z" : "");
      std::fprintf(f, "\"><title>label %d</title></path>\n", label);
    }
    std::fprintf(f, "</g>\n");
  }
  std::fprintf(f, "</svg>\n");
}

}  // namespace

bool is_section_format(const std::string& path) {
  const std::string e = ending(path);
  return e == ".json" || e == ".svg" || e == ".cnt";
}

void write_sections(AtomicFiles& files, const std::string& path, const Stack& stack) {
  const std::string e = ending(path);
  if (e == ".json") {
    files.write(path, [&](std::FILE* f) { write_json(f, stack); });
  } else if (e == ".svg") {
    files.write(path, [&](std::FILE* f) { write_svg(f, stack); });
  } else if (e == ".cnt") {
    const std::set<Label> labels = labels_of(stack);
    for (Label label : labels) {
      const std::string name = labels.size() == 1 ? path
                                                  : path.substr(0, path.size() - 4) + "_" + std::to_string(label) +
                                                        path.substr(path.size() - 4);
      files.write(name, [&](std::FILE* f) { write_cnt(f, stack, label); });
    }
  } else {
    fail_usage("unknown ending for contours", path, "choose .json, .svg or .cnt");
  }
}

}  // namespace stackmesh
