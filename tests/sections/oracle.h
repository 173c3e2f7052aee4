#pragma once
// Slices to trace, and what a contour must obey, told by means that share nothing with the tracer: counting
// pixels, ray casting, integers.
#include <cstdint>
#include <functional>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "model/label_volume.h"
#include "model/stack.h"
#include "sections/arcs.h"

namespace stackmesh::contour_tests {

/// Noise, blobs, stripes, boxes and checkerboards of up to eight labels, up to `largest` pixels wide; never
/// empty.
Slice random_slice(std::uint64_t seed, int largest = 22);

/// A slice from rows of digits, the first row at y = 0.
Slice slice_of(const std::vector<std::string>& rows);

/// A slice whose pixel (x, y) has the label that the function gives.
Slice slice_of(int width, int height, const std::function<int(int x, int y)>& label);

/// Copies of slices as a volume of 1 mm pixels, 1 mm apart.
LabelVolume volume_of(const std::vector<Slice>& slices);

/// The pixels of each label; [0] counts the background.
std::vector<std::int64_t> count_pixels(const Slice& slice);

/// Pairs of unlike neighbours, the outside being background.
std::int64_t count_cracks(const Slice& slice);

/// The arcs that the corner rule leaves when pixels of a label hang together elsewhere or not.
SliceArcs trace(const Slice& slice, bool joined, bool part);

/// A directed straight edge with its labels.
struct Edge {
  GridPoint a, b;
  int left, right;
};
std::vector<Edge> edges_of(const SliceArcs& traced, double simplify_px);
std::vector<Edge> edges_of(const Section& section);

/// The pixels whose centre has another label by the edges than in the slice: even-odd, one ray a row and
/// label.
std::int64_t count_relabelled_centres(const Slice& slice, const std::vector<Edge>& edges);

/// Pairs of edges that meet elsewhere than in a common end point. Every pair is tested, in integers.
std::int64_t count_clashes(const std::vector<Edge>& edges);

/// Vertices of the smallest connected piece of any label's boundary.
std::size_t smallest_boundary(const std::vector<Edge>& edges);

/// Points that edges end at.
std::size_t count_vertices(const std::vector<Edge>& edges);

}  // namespace stackmesh::contour_tests
