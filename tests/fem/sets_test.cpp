// Sets of blocks whose faces can be counted by hand; parts; selections; names.
#include <filesystem>
#include <set>

#include "base/error.h"
#include "blocks.h"
#include "fem/boundary_faces.h"
#include "fem/element_quality.h"
#include "fem/load_case.h"
#include "fem/name_sets.h"
#include "fem/solver_names.h"
#include "fem/split_parts.h"
#include "image/read_label_table.h"
#include "volume/raise_order.h"
#include "volume/refine_tets.h"

using namespace stackmesh;
using blocks::block;

namespace {

std::size_t faces_of(const SolverModel& m, const std::string& name) {
  for (const FaceSet& s : m.sets.surfaces)
    if (s.name == name) return s.faces.size();
  return 0;
}
const NodeSet* nodes_of(const SolverModel& m, const std::string& name) {
  for (const NodeSet& s : m.sets.node_sets)
    if (s.name == name) return &s;
  return nullptr;
}
std::size_t count_nodes(const SolverModel& m, const std::string& name) {
  return nodes_of(m, name) ? nodes_of(m, name)->nodes.size() : 0;
}

void expect_error(const std::function<void()>& call, ErrorKind kind, const std::vector<std::string>& parts) {
  try {
    call();
    ADD_FAILURE() << "no error was thrown";
  } catch (const Error& e) {
    const std::string text = e.what();
    EXPECT_EQ(static_cast<int>(e.kind()), static_cast<int>(kind)) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos);
    for (const std::string& p : parts)
      EXPECT_NE(text.find(p), std::string::npos) << "'" << p << "' is not in: " << text;
  }
}

/// Two labels side by side along x: 3 + 2 cells, 2 x 4 across.
TetMesh two_labels() {
  return block(5, 2, 4, {1, 1, 1}, [](int i, int, int) { return i < 3 ? 4 : 9; });
}
const std::vector<LabelInfo> kNames = {{4, "left lung"}, {9, "Left_Lung"}};

TEST(NameSets, CountsOfABlockOfTwoLabels) {
  const SolverModel m = name_sets(two_labels(), kNames, {});
  ASSERT_EQ(m.labels.size(), 2u);
  EXPECT_EQ(m.labels[0].name, "left_lung");
  EXPECT_EQ(m.labels[1].name, "Left_Lung_2");  // unique whatever the case
  // Outer faces: two triangles a cell face.
  EXPECT_EQ(faces_of(m, "left_lung_outer"), 2u * (2 * 3 * 4 + 2 * 3 * 2 + 2 * 4));
  EXPECT_EQ(faces_of(m, "left_lung_to_Left_Lung_2"), 2u * 2 * 4);
  EXPECT_EQ(faces_of(m, "Left_Lung_2_to_left_lung"), 2u * 2 * 4);
  EXPECT_EQ(count_nodes(m, "left_lung_to_Left_Lung_2"), 3u * 5);
  EXPECT_EQ(nodes_of(m, "left_lung_to_Left_Lung_2")->nodes, nodes_of(m, "Left_Lung_2_to_left_lung")->nodes);
  EXPECT_EQ(faces_of(m, "left_lung_cap_low"), 2u * 3 * 2);
  EXPECT_EQ(faces_of(m, "left_lung_cap_high"), 2u * 3 * 2);
  EXPECT_EQ(count_nodes(m, "Left_Lung_2_cap_high"), 3u * 3);
  EXPECT_EQ(faces_of(m, "cap_low"), 2u * 5 * 2);
  // The rest of the outer faces is split along the block's edges: for label 4 the sides y low, y high, x low.
  std::multiset<std::size_t> sides;
  for (int i = 1; i <= 4; ++i) sides.insert(faces_of(m, "left_lung_outer_" + std::to_string(i)));
  EXPECT_EQ(sides, (std::multiset<std::size_t>{0, 2u * 2 * 4, 2u * 3 * 4, 2u * 3 * 4}));
  // Every set's nodes are those of its faces, and every tet is of the label that groups it.
  EXPECT_TRUE(std::is_sorted(m.mesh.labels.begin(), m.mesh.labels.end()));
  for (const FaceSet& s : m.sets.surfaces) {
    std::set<std::int32_t> nodes;
    for (const TetFace f : s.faces)
      for (const int k : kTetFaces[f.face]) nodes.insert(m.mesh.tets[f.tet][k]);
    EXPECT_EQ(std::vector<std::int32_t>(nodes.begin(), nodes.end()), nodes_of(m, s.name)->nodes) << s.name;
  }
}

TEST(NameSets, OuterAndInnerWallAndBaseOfACupComeApart) {
  // A cup: a block with a hole from above, two cells deep.
  const TetMesh cup =
      block(4, 4, 3, {1, 1, 1}, [](int i, int j, int k) { return k > 0 && i > 0 && i < 3 && j > 0 && j < 3 ? 0 : 1; });
  SetOptions options;
  options.sharp_deg = 100;  // the block's own edges are no feature: walls stay whole
  const SolverModel m = name_sets(cup, {{1, "wall"}}, options);
  EXPECT_EQ(faces_of(m, "wall_cap_high"), 2u * (16 - 4));  // the rim
  EXPECT_EQ(faces_of(m, "wall_cap_low"), 2u * 16);
  EXPECT_EQ(faces_of(m, "wall_outer_1"), 2u * 4 * 4 * 3);        // epicardium
  EXPECT_EQ(faces_of(m, "wall_outer_2"), 2u * (4 * 2 * 2 + 4));  // endocardium with its floor
  EXPECT_EQ(faces_of(m, "wall_outer_3"), 0u);
}

TEST(NameSets, AnIslandBetweenOtherLabelsJoinsTheNearestPatch) {
  // On the side x low a ring of label 2 lies round one cell of label 1.
  const TetMesh ring = block(3, 8, 8, {1, 1, 1}, [](int i, int j, int k) {
    return i == 0 && std::abs(j - 4) <= 1 && std::abs(k - 4) <= 1 && !(j == 4 && k == 4) ? 2 : 1;
  });
  SetOptions options;
  options.sharp_deg = 100;
  const SolverModel m = name_sets(ring, {{1, "wall"}, {2, "ring"}}, options);
  EXPECT_EQ(faces_of(m, "wall_outer_1"), 2u * (64 - 8 + 64 + 2 * 24));  // all but the caps
  EXPECT_EQ(faces_of(m, "wall_outer_2"), 0u);
  EXPECT_EQ(faces_of(m, "ring_outer"), 2u * 8);
}

TEST(NameSets, ALoosePieceKeepsItsOwnPatchHoweverSmall) {
  const TetMesh crumb =
      block(13, 10, 10, {1, 1, 1}, [](int i, int j, int k) { return i < 10 || (i == 12 && j == 5 && k == 5) ? 1 : 0; });
  SetOptions options;
  options.sharp_deg = 100;
  const SolverModel m = name_sets(crumb, {{1, "wall"}}, options);
  EXPECT_EQ(faces_of(m, "wall_outer_1"), 2u * 4 * 100);
  EXPECT_EQ(faces_of(m, "wall_outer_2"), 12u);
}

TEST(NameSets, AVoidsWallIsASetOfItsOwn) {
  // The cup again, and what its faces on the hole say of it: label 7 lies there, and no tet has it.
  const auto is_hole = [](int i, int j, int k) { return k > 0 && i > 0 && i < 3 && j > 0 && j < 3; };
  TetMesh cup = block(4, 4, 3, {1, 1, 1}, [&](int i, int j, int k) { return is_hole(i, j, k) ? 0 : j < 2 ? 1 : 3; });
  for (const BoundaryFace& f : boundary_faces(cup)) {
    const Vec3 out = f.centre + 0.3 * f.normal;
    const bool hole = out.z < 3 && is_hole(static_cast<int>(std::floor(out.x)), static_cast<int>(std::floor(out.y)),
                                           static_cast<int>(std::floor(out.z)));
    if (f.out == 0) cup.faces.push_back({f.v, f.in, hole ? 7 : 0});
  }
  const SolverModel m = name_sets(cup, {{1, "wall"}, {3, "septum"}, {7, "blood"}}, {});
  ASSERT_EQ(m.labels.size(), 2u);
  EXPECT_EQ(faces_of(m, "wall_inner_blood"), 2u * (4 * 2 + 2));
  EXPECT_EQ(faces_of(m, "septum_inner_blood"), 2u * (4 * 2 + 2));
  EXPECT_EQ(faces_of(m, "inner_blood"), 2u * (4 * 2 * 2 + 4));
  EXPECT_EQ(faces_of(m, "wall_outer"), 2u * (8 + 2 * 2 * 3 + 4 * 3 + 8 - 2));
  EXPECT_EQ(faces_of(m, "wall_to_septum"), faces_of(m, "septum_to_wall"));
  for (InterfaceTriangle& f : cup.faces) f.above = f.above == 7 ? 2 : 0;
  // no name: its number
  EXPECT_EQ(faces_of(name_sets(cup, {{1, "wall"}, {3, "septum"}}, {}), "wall_inner_2"), 2u * (4 * 2 + 2));
}

TEST(NameSets, RoundEndHasNoCap) {
  TetMesh ball = block(4, 4, 4, {1, 1, 1});
  for (Vec3& p : ball.points) {  // the cube's surface to a sphere
    const Vec3 d = p - Vec3{2, 2, 2};
    const double cube = std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)}), length = norm(d);
    if (length > 0) p = Vec3{2, 2, 2} + (cube / length) * d;
  }
  const SolverModel m = name_sets(ball, {}, {});
  EXPECT_GT(faces_of(m, "label_1_outer"), 0u);
  EXPECT_EQ(faces_of(m, "label_1_cap_low") + faces_of(m, "label_1_cap_high"), 0u);
}

TEST(NameSets, FacesOnTheImagesOwnSidesAreNamed) {
  SetOptions options;
  ImageBox box;
  box.origin = {0, 0, 0};
  box.axes = {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  box.length_mm = {7, 2, 4};  // the block ends two cells short of the image's high x side
  box.spacing_mm = {1, 1, 1};
  options.image = box;
  const SolverModel m = name_sets(two_labels(), kNames, options);
  EXPECT_EQ(faces_of(m, "border_x_low"), 2u * 2 * 4);
  EXPECT_EQ(faces_of(m, "border_x_high"), 0u);
  EXPECT_EQ(faces_of(m, "border_y_high"), 2u * 5 * 4);
  EXPECT_EQ(faces_of(m, "border_z_low"), 2u * 5 * 2);
}

TEST(NameSets, SecondOrderSetsHoldMidSideNodes) {
  TetMesh mesh = raise_order(two_labels()).mesh;
  const SolverModel m = name_sets(mesh, kNames, {});
  // A 2 x 4 grid of squares with one diagonal each: 15 corners, 3 * 4 + 2 * 5 + 8 edges.
  EXPECT_EQ(count_nodes(m, "left_lung_to_Left_Lung_2"), 15u + 12 + 10 + 8);
}

double area_of(const SolverModel& m, const FaceSet& set) {
  double area = 0;
  for (const TetFace f : set.faces) {
    const auto v = outward_nodes(m.mesh, f);
    area += 0.5 * norm(cross(m.mesh.points[v[1]] - m.mesh.points[v[0]], m.mesh.points[v[2]] - m.mesh.points[v[0]]));
  }
  return area;
}

/// However often a mesh is cut, a set is the same piece of its surface: also one selected by the faces' centres, of
/// which some are in and some of the faces cut from them are not.
TEST(NameSets, OfACutMeshAreThoseOfTheMeshBefore) {
  SetOptions options;
  options.selections = {"ball=sphere:1,1,2,1.6", "front=plane:0,0,4,0,0,1"};
  options.parts = {{"A", {4}}, {"B", {9}}};
  options.skins = {{4, 0.5}};
  for (const bool curved : {false, true}) {
    const TetMesh mesh = curved ? raise_order(two_labels(), {}).mesh : two_labels();
    const SolverModel whole = name_sets(mesh, kNames, options);
    for (int times = 1; times < 3; ++times) {
      options.times_cut = times;
      const SolverModel cut = name_sets(refine_tets(mesh, times), kNames, options);
      ASSERT_EQ(cut.mesh.tets.size(), whole.mesh.tets.size() << (3 * times));
      ASSERT_EQ(cut.sets.surfaces.size(), whole.sets.surfaces.size());
      ASSERT_EQ(cut.sets.node_sets.size(), whole.sets.node_sets.size());
      for (std::size_t i = 0; i < whole.sets.surfaces.size(); ++i) {
        const FaceSet &before = whole.sets.surfaces[i], &after = cut.sets.surfaces[i];
        EXPECT_EQ(after.name, before.name);
        EXPECT_EQ(after.faces.size(), before.faces.size() << (2 * times)) << before.name;
        EXPECT_NEAR(area_of(cut, after), area_of(whole, before), 1e-9) << before.name;
      }
      EXPECT_EQ(cut.sets.shells[0].faces.size(), whole.sets.shells[0].faces.size() << (2 * times));
      EXPECT_EQ(cut.mesh.faces.size(), whole.mesh.faces.size() << (2 * times));
    }
    options.times_cut = 0;
    // Selected anew, the ball has other faces: it is the inheritance that keeps the set.
    const SolverModel anew = name_sets(refine_tets(mesh, 1), kNames, options);
    EXPECT_NE(faces_of(anew, "ball"), 4 * faces_of(whole, "ball"));
  }
  options.times_cut = 1;
  EXPECT_THROW(name_sets(two_labels(), kNames, options), Error);  // was not cut
}

TEST(Parts, NodesAreSharedWithinAPartAndDoubledBetweenParts) {
  // Four labels along x, one cell each; parts A = 1, 3 and B = 2, 4.
  const TetMesh mesh = block(4, 1, 1, {1, 1, 1}, [](int i, int, int) { return i + 1; });
  SetOptions options;
  options.parts = {{"A", {1, 3}}, {"B", {2, 4}}};
  const SolverModel m = name_sets(mesh, {}, options);
  EXPECT_EQ(m.mesh.points.size(), 20u + 3 * 4);  // three planes of four nodes are between parts
  EXPECT_EQ(faces_of(m, "contact_A_B"), 6u);
  EXPECT_EQ(faces_of(m, "contact_B_A"), 6u);
  EXPECT_EQ(count_nodes(m, "contact_A_B"), 12u);
  EXPECT_EQ(count_nodes(m, "rim_A_B"), 12u);  // each plane's four corners are its outline
  ASSERT_EQ(m.sets.pairs.size(), 1u);
  EXPECT_EQ(m.sets.pairs[0].primary, "contact_A_B");
  // The two sides share no node, lie on each other, and no element joins the parts.
  std::set<std::int32_t> a(nodes_of(m, "contact_A_B")->nodes.begin(), nodes_of(m, "contact_A_B")->nodes.end());
  std::multiset<double> xa, xb;
  for (const std::int32_t v : a) xa.insert(m.mesh.points[v].x);
  for (const std::int32_t v : nodes_of(m, "contact_B_A")->nodes) {
    EXPECT_EQ(a.count(v), 0u);
    xb.insert(m.mesh.points[v].x);
  }
  EXPECT_EQ(xa, xb);
  std::map<std::int32_t, std::set<int>> parts;
  for (std::size_t t = 0; t < m.mesh.tets.size(); ++t)
    for (const std::int32_t v : m.mesh.tets[t]) parts[v].insert(m.mesh.labels[t] % 2);
  for (const auto& [v, p] : parts) EXPECT_EQ(p.size(), 1u);
}

TEST(Parts, JoiningEqualNodesUndoesTheSplit) {
  const TetMesh mesh =
      raise_order(block(2, 2, 2, {1, 1, 1}, [](int i, int j, int) { return i == 0 ? 1 : 2 + j; })).mesh;
  SetOptions options;
  options.parts = {{"A", {1}}, {"B", {2}}};
  SolverModel split = name_sets(mesh, {}, options);
  EXPECT_EQ(join_equal_nodes(split.mesh), split.mesh.points.size() - mesh.points.size());
  const SolverModel again = name_sets(split.mesh, {}, {}), meant = name_sets(mesh, {}, {});
  EXPECT_EQ(again.mesh.points.size(), mesh.points.size());
  ASSERT_EQ(again.sets.surfaces.size(), meant.sets.surfaces.size());
  for (const FaceSet& s : meant.sets.surfaces) EXPECT_EQ(faces_of(again, s.name), s.faces.size()) << s.name;
  EXPECT_EQ(join_equal_nodes(split.mesh), 0u);
}

TEST(Parts, TripleLinesHaveACopyForEachPart) {
  const TetMesh mesh = block(2, 2, 2, {1, 1, 1}, [](int i, int j, int) { return i == 0 ? 1 : 2 + j; });
  SetOptions options;
  options.parts = {{"A", {1}}, {"B", {2}}};  // label 3 is the rest
  const SolverModel m = name_sets(mesh, {}, options);
  EXPECT_EQ(count_nodes(m, "triple_A_B_rest"), 3u * 3);  // a line of three nodes along z
  // A|others: 9 doubled, B|rest: 6 more of which 3 are on the line
  EXPECT_EQ(m.mesh.points.size(), 27u + 6 + 3 + 3 + 3);
}

TEST(Parts, WithinAPartInterfacesStayShared) {
  const TetMesh mesh = block(4, 1, 1, {1, 1, 1}, [](int i, int, int) { return i + 1; });
  SetOptions options;
  options.parts = {{"A", {1, 2}}, {"B", {3, 4}}};
  EXPECT_EQ(name_sets(mesh, {}, options).mesh.points.size(), 20u + 4);
  options.parts = {{"A", {1, 2}}, {"B", {2}}};
  expect_error([&] { name_sets(mesh, {}, options); }, ErrorKind::usage, {"label 2 is in two parts"});
  options.parts = {{"A", {1, 7}}};
  expect_error([&] { name_sets(mesh, {}, options); }, ErrorKind::input, {"label 7 is not in the mesh", "--parts"});
}

TEST(Skins, AreShellsOnTheOuterFaces) {
  SetOptions options;
  options.skins = {{4, 0.3}};
  const SolverModel m = name_sets(two_labels(), kNames, options);
  ASSERT_EQ(m.sets.shells.size(), 1u);
  EXPECT_EQ(m.sets.shells[0].faces.size(), faces_of(m, "left_lung_outer"));
  EXPECT_EQ(m.sets.shells[0].name, "left_lung_skin");
}

std::size_t selected(const std::string& text, Space space = Space::lps) {
  SetOptions options;
  options.selections.push_back(text);
  TetMesh mesh = two_labels();
  mesh.space = space;
  return faces_of(name_sets(mesh, kNames, options), text.substr(0, text.find('=')));
}

TEST(Selections, PickTheFacesTheyDescribe) {
  EXPECT_EQ(selected("s=box:-1,-1,3.99,9,9,9"), 2u * 5 * 2);  // the top
  EXPECT_EQ(selected("s=plane:0,0,0,0,0,2"), 2u * 5 * 2);     // the bottom, by its plane
  EXPECT_EQ(selected("s=plane:3,0,0,1,0,0"), 2u * 2 * 4);     // the interface, once
  EXPECT_EQ(selected("s=normal:0,-1,0,20"), 2u * 5 * 4);      // one side, by its normals
  EXPECT_EQ(selected("s=normal:0,-1,0,20&of:9"), 2u * 2 * 4);
  EXPECT_EQ(selected("s=normal:0,-1,0,20&of:left lung"), 0u + 2 * 3 * 4);
  EXPECT_EQ(selected("s=sphere:0,0,0,0.8&normal:0,0,-1,10"), 2u);  // the corner's two triangles
  EXPECT_EQ(selected("s=in:left_lung_cap_low&box:0,0,-1,1,1,1"), 2u);
}

TEST(Selections, MarkupsAreTurnedIntoTheMeshsFrame) {
  const std::string path = testing::TempDir() + "points.mrk.json";
  const auto write = [&](const std::string& system, const std::string& position) {
    std::ofstream(path) << R"({"markups": [{"type": "Fiducial", "coordinateSystem": ")" << system
                        << R"(", "controlPoints": [{"id": "1", "position": )" << position
                        << R"(, "positionStatus": "defined"}]}]})";
  };
  write("LPS", "[0.5, 0.5, 0]");
  EXPECT_EQ(selected("s=points:" + path + ",0.5"), 2u);
  write("RAS", "[-0.5, -0.5, 0]");
  EXPECT_EQ(selected("s=points:" + path + ",0.5"), 2u);
  write("RAS", "[0.5, 0.5, 0]");
  EXPECT_EQ(selected("s=points:" + path + ",0.5", Space::ras), 2u);
  expect_error([&] { selected("s=points:" + path + ",0.1"); }, ErrorKind::input,
               {"selection 's' is empty", "nearest face"});
  std::ofstream(path) << "no json";
  expect_error([&] { selected("s=points:" + path + ",0.5"); }, ErrorKind::input, {"no Slicer markups file", path});
}

TEST(Selections, EmptyOnesNameTheNearestCandidate) {
  expect_error([] { selected("s=box:10,0,0,12,2,4"); }, ErrorKind::input,
               {"selection 's' is empty", "misses box by 5 mm", "Left_Lung_2_outer"});
  expect_error([] { selected("s=plane:0,0,-2,0,0,1"); }, ErrorKind::input, {"misses plane by 1.99 mm"});
  expect_error([] { selected("s=normal:0,0,1,5&of:4&in:Left_Lung_2_outer"); }, ErrorKind::input,
               {"selection 's' is empty"});
}

TEST(Selections, BadTextsAreUsageErrors) {
  for (const std::string text : {"box:0,0,0,1,1,1", "s=", "s=cube:1", "s=box:1,2", "s=box:0,0,0,1,1,x",
                                 "s=sphere:0,0,0,-1", "s=plane:0,0,0,0,0,0", "s=normal:1,0,0,0", "2s=of:4", "a b=of:4"})
    expect_error([&] { selected(text); }, ErrorKind::usage, {"--select"});
  expect_error([] { selected("s=of:77"); }, ErrorKind::input, {"label '77' is not in the mesh", "9 (Left_Lung_2)"});
  expect_error([] { selected("s=in:nothing"); }, ErrorKind::input, {"set 'nothing'"});
  expect_error([] { selected("left_lung_outer=of:4"); }, ErrorKind::usage, {"is there already"});
}

TEST(LabelTable, ReadsSlicersAndItkSnapsForm) {
  const std::string path = testing::TempDir() + "labels.txt";
  std::ofstream(path) << "# Color table\n0 background 0 0 0 0\n4 femur_left 255 0 10 255\n9 hip 1 2 3 255\n";
  auto table = read_label_table(path);
  ASSERT_EQ(table.size(), 2u);
  EXPECT_EQ(table[0].number, 4);
  EXPECT_EQ(table[0].name, "femur_left");
  EXPECT_EQ(*table[0].colour, (std::array<std::uint8_t, 3>{255, 0, 10}));
  std::ofstream(path) << "################\n# ITK-SnAP Label Description File\n    0     0    0    0        0  0  0    "
                         "\"Clear Label\"\n"
                         "    4   255    0    0        1  1  1    \"Left femur\"\n";
  table = read_label_table(path);
  ASSERT_EQ(table.size(), 1u);
  EXPECT_EQ(table[0].name, "Left femur");
  std::vector<LabelInfo> labels = {{4, ""}, {5, "kept"}};
  apply_label_table(table, labels);
  EXPECT_EQ(solver_names(labels)[0].name, "Left_femur");
  EXPECT_EQ(solver_names(labels)[1].name, "kept");
}

TEST(LabelTable, BadTablesSayTheLine) {
  const std::string path = testing::TempDir() + "bad_labels.txt";
  for (const auto& [text, part] : {std::pair<std::string, std::string>{"4\n", "line 1"},
                                   {"a b c\n", "line 1"},
                                   {"1 one\n1 two\n", "line 2"},
                                   {"# nothing\n", "names no label"},
                                   {"1 2 3 4 1 1 1 \"open\n", "line 1"}}) {
    std::ofstream(path) << text;
    expect_error([&] { read_label_table(path); }, ErrorKind::input, {path, part});
  }
  expect_error([] { read_label_table("/nowhere/table.ctbl"); }, ErrorKind::input, {"/nowhere/table.ctbl"});
}

TEST(SolverNames, AreCleanAndDistinctWhateverTheCase) {
  const auto names = solver_names({{1, "a b"},
                                   {2, "A_B"},
                                   {3, ""},
                                   {4, "9 lives"},
                                   {5, std::string(90, 'x')},
                                   {6, std::string(90, 'X')},
                                   {7, "nall"}});
  std::set<std::string> lower;
  for (const LabelInfo& l : names) {
    std::string text = l.name;
    EXPECT_LE(text.size(), 40u);
    EXPECT_TRUE(std::isalpha(static_cast<unsigned char>(text[0]))) << text;
    for (char& c : text) {
      EXPECT_TRUE(std::isalnum(static_cast<unsigned char>(c)) || c == '_') << text;
      c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
    EXPECT_TRUE(lower.insert(text).second) << text;
  }
  EXPECT_EQ(names[2].name, "label_3");
  EXPECT_EQ(lower.count("nall"), 0u);
}

TEST(ElementQuality, ListsElementsThatAreInsideOut) {
  TetMesh mesh = block(2, 2, 2, {1, 1, 1});
  EXPECT_TRUE(element_quality(mesh).non_positive.empty());
  std::swap(mesh.tets[7][0], mesh.tets[7][1]);
  EXPECT_EQ(element_quality(mesh).non_positive, std::vector<std::int32_t>{7});
  std::swap(mesh.tets[7][0], mesh.tets[7][1]);
  TetMesh second = raise_order(mesh).mesh;
  EXPECT_TRUE(element_quality(second).non_positive.empty());
  // an edge that runs through the element's far corner
  second.points[second.mid[3][0]] = second.points[second.tets[3][3]];
  const auto bad = element_quality(second).non_positive;
  EXPECT_TRUE(std::find(bad.begin(), bad.end(), 3) != bad.end());
  // A regular tet has a scaled Jacobian of 1.
  TetMesh regular;
  regular.points = {{1, 1, 1}, {-1, 1, -1}, {1, -1, -1}, {-1, -1, 1}};
  regular.tets = {{0, 1, 2, 3}};
  regular.labels = {1};
  EXPECT_NEAR(std::abs(element_quality(regular).scaled_jacobian[0]), 1, 1e-12);
}

TEST(LoadCase, ForceAndPressureAreInBalance) {
  for (const int order : {1, 2}) {
    TetMesh mesh = block(3, 3, 3, {1, 1, 1});
    for (Vec3& p : mesh.points) p = p + Vec3{0.1 * std::sin(2 * p.z), 0.1 * std::cos(3 * p.x), 0.05 * p.x * p.y};
    if (order == 2) mesh = raise_order(mesh).mesh;
    SolverModel m = name_sets(mesh, {}, {});
    LoadCase load;
    load.always.loaded.push_back({"label_1_outer", std::nullopt, 2.5});  // pressure on a closed surface sums to nothing
    load.always.loaded.push_back({"label_1_outer_1", std::nullopt, 2.5});
    apply_load_case(m, load, "law");
    ASSERT_EQ(m.sets.steps.size(), 1u);
    ASSERT_EQ(m.sets.steps[0].pressures.size(), 2u);
    EXPECT_TRUE(m.sets.steps[0].forces_n.empty());
    EXPECT_LT(norm(force_of(m, m.sets.steps[0].pressures[0])), 1e-10);
    EXPECT_GT(norm(force_of(m, m.sets.steps[0].pressures[1])), 2.5 * 7);
    m = name_sets(mesh, {}, {});
    load.always.loaded = {{"label_1_outer", Vec3{1, -2, 3}, std::nullopt}};
    apply_load_case(m, load, "law");
    Vec3 sum;
    for (const auto& [v, f] : m.sets.steps[0].forces_n) sum = sum + f;
    EXPECT_LT(norm(sum - Vec3{1, -2, 3}), 1e-12);
    // A force and a moment on a slanting set, about a point beside it.
    m = name_sets(mesh, {}, {});
    load.always.loaded = {{"P", Vec3{1, -2, 3}, std::nullopt, Vec3{5, -4, 20}}};
    load.points = {{"P", "label_1_outer_1", {7, -3, 2}, false}};
    apply_load_case(m, load, "law");
    EXPECT_TRUE(m.sets.points.empty());
    sum = {};
    Vec3 moment;
    for (const auto& [v, f] : m.sets.steps[0].forces_n) {
      sum = sum + f;
      moment = moment + cross(m.mesh.points[v] - Vec3{7, -3, 2}, f);
    }
    EXPECT_LT(norm(sum - Vec3{1, -2, 3}), 1e-12);
    EXPECT_LT(norm(moment - Vec3{5, -4, 20}), 1e-11);
    load.points.clear();
    if (order == 2) {  // even traction on a plane face: nothing at corners, a third at each mid-side node
      SolverModel flat = name_sets(raise_order(block(1, 1, 1, {1, 1, 1})).mesh, {}, {});
      load.always.loaded = {{"label_1_cap_high", Vec3{0, 0, 6}, std::nullopt}};
      apply_load_case(flat, load, "law");
      std::multiset<long> parts;
      for (const auto& [v, f] : flat.sets.steps[0].forces_n) parts.insert(std::lround(1000 * f.z));
      EXPECT_EQ(parts, (std::multiset<long>{0, 0, 0, 0, 1000, 1000, 1000, 1000, 2000}));
    }
  }
}

TEST(LoadCase, RefusesWhatDoesNotFit) {
  SolverModel m = name_sets(two_labels(), kNames, {});
  LoadCase load;
  load.always.held.push_back({"left_lung_cap", {0.0, 0.0, 0.0}});
  expect_error([&] { apply_load_case(m, load, "law.json"); }, ErrorKind::input,
               {"'left_lung_cap'", "law.json", "left_lung_cap_low"});
  load.always.held = {{"cap_low", {0.0, 0.0, 0.0}}, {"left_lung_cap_low", {std::nullopt, std::nullopt, 0.5}}};
  expect_error([&] { apply_load_case(m, load, "law.json"); }, ErrorKind::input, {"two different displacements"});
}

}  // namespace
