#include "sections/layer_sections.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>

#include "sections/arcs.h"
#include "sections/section_edges.h"

namespace stackmesh {
namespace {

/// A piece of contour across a square of four pixel centres.
struct Piece {
  std::int64_t a, b;  // keys of its ends
  Label left, right;
};

/// Sides of a square: 0 bottom, 1 right, 2 top, 3 left; its corners: 0 bottom left, 1 bottom right, 2 top right, 3 top
/// left.
class LayerTracer {
 public:
  explicit LayerTracer(const LabelLayer& layer) : layer_(layer) {}

  std::vector<Arc> run() {
    for (int y = 0; y + 1 < layer_.height; ++y)
      for (int x = 0; x + 1 < layer_.width; ++x) square(x, y);
    link();
    return std::move(arcs_);
  }

 private:
  std::size_t at(int x, int y) const { return static_cast<std::size_t>(y) * layer_.width + x; }

  // A point between two centres has the key of its side, a junction that of its square.
  std::int64_t side_key(int x, int y, int side) const {
    const std::int64_t p = static_cast<std::int64_t>(at(x, y));
    if (side == 0) return 3 * p;
    if (side == 1) return 3 * (p + 1) + 1;
    if (side == 2) return 3 * (p + layer_.width);
    return 3 * p + 1;
  }

  GridPoint position(std::int64_t key) const {
    const std::size_t p = static_cast<std::size_t>(key / 3);
    double x = static_cast<double>(p % layer_.width), y = static_cast<double>(p / layer_.width);
    if (key % 3 == 0) x += layer_.right[p];
    else if (key % 3 == 1) y += layer_.up[p];
    else {
      x += junction_.at(key)[0];
      y += junction_.at(key)[1];
    }
    return {static_cast<std::int32_t>(std::lround(layer_.x0 + x * layer_.unit[0])),
            static_cast<std::int32_t>(std::lround(layer_.y0 + y * layer_.unit[1]))};
  }

  CrackVertex vertex(std::int64_t key) const {
    const GridPoint p = position(key);
    return {p.x, p.y, p, false};
  }

  void add(std::int64_t a, std::int64_t b, Label left, Label right) { pieces_.push_back({a, b, left, right}); }

  void square(int x, int y) {
    const std::array<std::size_t, 4> corner = {at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)};
    std::array<std::int32_t, 4> part;
    std::array<Label, 4> label;
    for (int c = 0; c < 4; ++c) {
      part[c] = layer_.part[corner[c]];
      label[c] = layer_.label[part[c]];
    }
    std::array<int, 4> crossed{};
    int count = 0;
    for (int s = 0; s < 4; ++s)  // side s lies between corners s and s + 1
      if (label[s] != label[(s + 1) & 3]) crossed[count++] = s;
    if (count == 0) return;
    const auto key = [&](int s) { return side_key(x, y, s); };
    // From side s to side t with t after s, anticlockwise: on the right lie the corners s + 1 .. t.
    const auto chord = [&](int s, int t) { add(key(s), key(t), label[(t + 1) & 3], label[(s + 1) & 3]); };
    if (count == 2) return chord(crossed[0], crossed[1]);
    if (count == 4) {
      const bool rising = part[0] == part[2], falling = part[1] == part[3];
      const bool join_rising = rising && (label[0] == 0 || !(falling && label[1] == 0));
      if (join_rising) {  // cut off corners 1 and 3
        chord(0, 1);
        return chord(2, 3);
      }
      if (falling) {  // cut off corners 2 and 0
        chord(1, 2);
        return add(key(3), key(0), label[1], label[0]);
      }
    }
    const std::int64_t middle = 3 * static_cast<std::int64_t>(corner[0]) + 2;
    double cx = 0, cy = 0;
    for (int i = 0; i < count; ++i) {
      const int s = crossed[i];
      cx += s == 0 ? layer_.right[corner[0]] : s == 2 ? layer_.right[corner[3]] : s == 1 ? 1 : 0;
      cy += s == 1 ? layer_.up[corner[1]] : s == 3 ? layer_.up[corner[0]] : s == 2 ? 1 : 0;
      add(key(s), middle, label[s], label[(s + 1) & 3]);
    }
    junction_[middle] = {cx / count, cy / count};
  }

  /// Pieces to arcs: from junction to junction, then closed loops.
  void link() {
    // the two pieces at a point that is no junction
    std::unordered_map<std::int64_t, std::array<std::int32_t, 2>> ends;
    std::vector<std::pair<std::int64_t, std::int32_t>> starts;  // junction, piece
    for (std::size_t i = 0; i < pieces_.size(); ++i)
      for (std::int64_t key : {pieces_[i].a, pieces_[i].b}) {
        if (key % 3 == 2) {
          starts.emplace_back(key, static_cast<std::int32_t>(i));
          continue;
        }
        auto [it, fresh] = ends.insert({key, {static_cast<std::int32_t>(i), -1}});
        if (!fresh) it->second[1] = static_cast<std::int32_t>(i);
      }
    std::vector<char> used(pieces_.size(), 0);
    const auto follow = [&](std::int64_t key, std::int32_t piece) {
      Arc arc;
      const std::int64_t first = key;
      const bool forward = pieces_[piece].a == key;
      arc_labels_.push_back(forward ? std::make_pair(pieces_[piece].left, pieces_[piece].right)
                                    : std::make_pair(pieces_[piece].right, pieces_[piece].left));
      arc.chain.push_back(vertex(key));
      while (true) {
        used[piece] = 1;
        key = pieces_[piece].a == key ? pieces_[piece].b : pieces_[piece].a;
        arc.chain.push_back(vertex(key));
        if (key == first || key % 3 == 2) break;
        const auto& both = ends.at(key);
        piece = both[0] == piece ? both[1] : both[0];
      }
      arc.closed = key == first;
      arcs_.push_back(std::move(arc));
    };
    for (const auto& [key, piece] : starts)
      if (!used[piece]) follow(key, piece);
    for (std::size_t i = 0; i < pieces_.size(); ++i)
      if (!used[i]) follow(pieces_[i].a, static_cast<std::int32_t>(i));
  }

  const LabelLayer& layer_;
  std::vector<Piece> pieces_;
  std::unordered_map<std::int64_t, std::array<double, 2>> junction_;
  std::vector<Arc> arcs_;

 public:
  std::vector<std::pair<Label, Label>> arc_labels_;  // left, right
};

}  // namespace

Section layer_section(const LabelLayer& layer, double tolerance_px) {
  LayerTracer tracer(layer);
  const std::vector<Arc> arcs = tracer.run();
  const std::vector<std::vector<GridPoint>> kept =
      simplify_free_arcs(arcs, tolerance_px * std::min(layer.unit[0], layer.unit[1]));
  Section section;
  section.z_mm = layer.z_mm;
  section.interpolated = true;
  SectionEdges edges(section);
  for (std::size_t a = 0; a < arcs.size(); ++a)
    edges.add(kept[a], tracer.arc_labels_[a].first, tracer.arc_labels_[a].second);
  return section;
}

}  // namespace stackmesh
