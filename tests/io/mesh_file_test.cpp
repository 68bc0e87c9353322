// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/shapes/mesh_file.h"

#include "stages/geometry/mesh_check.h"
#include "tests/support/data.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

void expect_refusal(const std::filesystem::path& path, std::string_view why) {
  EXPECT_THAT([&] { read_mesh(path); }, Refuses(why)) << path;
}

TEST(MeshFile, ChoosesTheFormatByTheExtensionInAnyCase) {
  const TemporaryFolder folder;
  EXPECT_EQ(read_mesh(folder.write("a.OFF", "OFF 1 0 0\n1 2 3\n")).vertices.size(), 1U);
  EXPECT_EQ(read_mesh(folder.write("a.Obj", "v 1 2 3\n")).vertices.size(), 1U);
  EXPECT_EQ(read_mesh(folder.write("a.ply",
                                   "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n"
                                   "property float y\nproperty float z\nend_header\n1 2 3\n"))
                .vertices.size(),
            1U);
  EXPECT_TRUE(has_mesh_extension("dir.off/x.PLY"));
  EXPECT_FALSE(has_mesh_extension("dir.off/x"));
  EXPECT_FALSE(has_mesh_extension(".off"));
}

TEST(MeshFile, SaysWhatIsWrongWithTheFileItself) {
  const TemporaryFolder folder;
  expect_refusal(folder / "absent.off", "absent.off:");
  expect_refusal(folder.write("empty.off", ""), "empty.off:");
  expect_refusal(folder.write("a.stl", "solid\n"), "a.stl:");
  std::filesystem::create_directory(folder / "folder.off");
  expect_refusal(folder / "folder.off", "folder.off:");
  expect_refusal(folder.write("bad.off", "OFF\n1 0 0\n1 2 x\n"), "bad.off:3: \"x\"");
}

TEST(MeshFile, ReadsEveryBenchmarkMesh) {
  const auto data = real_data();
  if (!data) GTEST_SKIP() << kNoRealData;
  std::vector<std::size_t> sizes;
  for (const auto& entry : std::filesystem::directory_iterator(*data / "SchellingData" / "Meshes")) {
    SCOPED_TRACE(entry.path());
    const auto [mesh, report] = check_mesh(read_mesh(entry.path()));
    sizes.push_back(mesh.vertices.size());
    EXPECT_EQ(report.components, 1);
    EXPECT_EQ(report.boundary_edges, 0);
    EXPECT_EQ(report.nonmanifold_edges, 0);
    EXPECT_EQ(report.misoriented_edges, 0);
    EXPECT_EQ(report.duplicate_faces, 0);
    EXPECT_EQ(report.isolated_vertices, 0);
  }
  ASSERT_EQ(sizes.size(), 380U);
  std::ranges::sort(sizes);
  EXPECT_EQ(sizes.front(), 1343U);
  EXPECT_EQ(sizes.back(), 27824U);
  EXPECT_EQ(sizes[190], 9015U);  // the upper median
}

}  // namespace
}  // namespace salbench
