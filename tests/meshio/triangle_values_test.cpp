// Triangles of .vtu and .vtk lie on faces of tets, and viewers draw both: they must carry the same values.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <vector>

#include "blocks.h"
#include "fem/assign_materials.h"
#include "fem/name_sets.h"
#include "meshio/write_mesh.h"

using namespace stackmesh;

namespace {

TEST(TriangleValues, AreThoseOfTheTetBehind) {
  // Three labels in a row, a modulus that differs from tet to tet; with parts, too, whose faces have nodes of their
  // own.
  for (const bool parts : {false, true}) {
    SetOptions options;
    if (parts) options.parts = {{"A", {1, 3}}, {"B", {2}}};
    SolverModel model =
        name_sets(blocks::block(3, 2, 2, {1, 1, 1}, [](int i, int, int) { return i + 1; }), {}, options);
    assign_materials(model, nullptr, nullptr);
    for (std::size_t t = 0; t < model.mesh.tets.size(); ++t) model.sets.modulus_mpa[t] = 100.0 + static_cast<double>(t);
    const std::string path =
        (std::filesystem::temp_directory_path() / ("triangle_values_" + std::to_string(::getpid()) + ".vtu")).string();
    AtomicFiles files;
    write_model(files, path, model, {});
    files.commit();
    std::FILE* file = std::fopen(path.c_str(), "rb");
    ASSERT_NE(file, nullptr);
    std::string bytes(std::filesystem::file_size(path), '\0');
    ASSERT_EQ(std::fread(bytes.data(), 1, bytes.size(), file), bytes.size());
    std::fclose(file);
    std::filesystem::remove(path);
    // The appended arrays, by the offsets in the header.
    const auto array = [&](const std::string& name) {
      const std::size_t at = bytes.find("Name=\"" + name + "\""), offset = bytes.find("offset=\"", at) + 8;
      const std::size_t begin =
          bytes.find("<AppendedData encoding=\"raw\">\n_") + 31 + std::stoul(bytes.substr(offset, 20));
      std::uint64_t size = 0;
      std::memcpy(&size, &bytes[begin], 8);
      return std::make_pair(begin + 8, static_cast<std::size_t>(size));
    };
    const auto numbers = [&](const std::string& name, auto kind) {
      const auto [begin, size] = array(name);
      std::vector<decltype(kind)> values(size / sizeof kind);
      std::memcpy(values.data(), &bytes[begin], size);
      return values;
    };
    const auto label = numbers("label", std::int32_t{});
    const auto modulus = numbers("modulus_MPa", double{});
    const auto corners = numbers("connectivity", std::int32_t{});
    const std::size_t tets = model.mesh.tets.size(), cells = label.size();
    ASSERT_GT(cells, tets);
    ASSERT_EQ(modulus.size(), cells);
    for (std::size_t i = tets; i < cells; ++i) {
      std::array<std::int32_t, 3> face;
      for (int k = 0; k < 3; ++k) face[k] = corners[4 * tets + 3 * (i - tets) + k];
      bool found = false;
      for (std::size_t t = 0; t < tets; ++t) {
        int on = 0;
        for (int k = 0; k < 4; ++k) on += std::count(face.begin(), face.end(), corners[4 * t + k]);
        found = found || (on == 3 && modulus[t] == modulus[i] && label[t] == label[i]);
      }
      EXPECT_TRUE(found) << "triangle " << i;
    }
  }
}

}  // namespace
