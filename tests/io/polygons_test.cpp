// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/shapes/polygons.h"

#include "io/shapes/mesh_file.h"
#include "stages/core/rng.h"
#include "stages/geometry/mesh_check.h"
#include "stages/geometry/mesh_ops.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

using Flat = std::vector<Eigen::Vector2d>;

// Throws InputError for a rejected polygon.
Mesh split(const std::vector<Vec3>& corners, PolygonCounts* counts = nullptr) {
  Mesh mesh{corners, {}};
  std::vector<std::int32_t> polygon(corners.size());
  std::iota(polygon.begin(), polygon.end(), 0);
  Polygons polygons;
  polygons.add(polygon, 7, mesh.faces);
  const PolygonCounts found = polygons.split(mesh, [](std::size_t place, const std::string& why) {
    throw InputError(std::to_string(place) + ": " + why);
  });
  if (counts != nullptr) *counts = found;
  return mesh;
}

std::vector<Vec3> in_plane(const Flat& corners, const Eigen::Matrix3d& turned = Eigen::Matrix3d::Identity(),
                           const Vec3& offset = Vec3::Zero()) {
  std::vector<Vec3> placed;
  for (const auto& corner : corners) placed.push_back(turned * Vec3(corner.x(), corner.y(), 0) + offset);
  return placed;
}

double doubled_area(const Flat& corners) {
  double sum = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto &a = corners[i], &b = corners[(i + 1) % corners.size()];
    sum += a.x() * b.y() - a.y() * b.x();
  }
  return sum;
}

// The triangles fill the polygon: there are n - 2, none is inverted, and their areas sum to its area. For
// triangles of a closed line, signed areas always do.
void expect_filled(const Flat& corners, const Mesh& mesh, const Vec3& normal) {
  ASSERT_EQ(mesh.faces.size(), corners.size() - 2);
  double sum = 0;
  std::vector<bool> used(corners.size(), false);
  for (const Triangle& face : mesh.faces) {
    const double area = face_area_vector(mesh, face).dot(normal);
    EXPECT_GE(area, -1e-9);
    sum += area;
    for (const std::int32_t v : face) used[static_cast<std::size_t>(v)] = true;
  }
  EXPECT_NEAR(sum, doubled_area(corners), 1e-9 * doubled_area(corners));
  EXPECT_EQ(std::count(used.begin(), used.end(), true), std::ssize(corners));
}

std::vector<Triangle> fan(std::size_t n) {
  std::vector<Triangle> faces;
  for (std::int32_t i = 2; i < static_cast<std::int32_t>(n); ++i) faces.push_back({0, i - 1, i});
  return faces;
}

std::vector<Triangle> sorted(std::vector<Triangle> faces) {
  for (Triangle& face : faces) std::ranges::rotate(face, std::ranges::min_element(face));
  std::ranges::sort(faces);
  return faces;
}

Eigen::Matrix3d any_rotation(Rng& rng) {
  return Eigen::Quaterniond(rng.uniform() - 0.5, rng.uniform() - 0.5, rng.uniform() - 0.5,
                            rng.uniform() - 0.5)
      .normalized()
      .toRotationMatrix();
}

// The fan around the first corner covers the notch, and one of its triangles is inverted.
const Flat kArrow = {{0, 0}, {2, 1}, {0, 2}, {1, 1}};
const Flat kComb = {{0, 0}, {7, 0}, {7, 3}, {6, 3}, {6, 1}, {5, 1}, {5, 3}, {4, 3},
                    {4, 1}, {3, 1}, {3, 3}, {2, 3}, {2, 1}, {1, 1}, {1, 3}, {0, 3}};

TEST(Polygons, AConcaveOneIsFilledAndNotItsHull) {
  PolygonCounts counts;
  const Mesh mesh = split(in_plane(kArrow), &counts);
  EXPECT_EQ(sorted(mesh.faces), sorted({{0, 1, 3}, {1, 2, 3}}));
  EXPECT_EQ(counts.split, 1);
  EXPECT_EQ(counts.concave, 1);
}

// Whichever corner comes first.
void expect_filled_from_everywhere(Flat corners, Rng& rng) {
  for (std::size_t first = 0; first < corners.size(); ++first) {
    const Eigen::Matrix3d turned = any_rotation(rng);
    SCOPED_TRACE(first);
    expect_filled(corners, split(in_plane(corners, turned, {10, -20, 30})), turned.col(2));
    std::ranges::rotate(corners, corners.begin() + 1);
  }
}

TEST(Polygons, EveryFirstCornerAndEveryPlaneGivesTheSameArea) {
  Rng rng(1, "polygons", "");
  for (const Flat& shape : {kArrow, kComb}) expect_filled_from_everywhere(shape, rng);
}

// Corners at random distances around a centre, and on both sides of a bent line: concave, without crossings.
TEST(Polygons, RandomConcaveOnesAreFilled) {
  Rng rng(2, "polygons", "");
  for (int round = 0; round < 500; ++round) {
    Flat corners;
    const std::size_t n = 4 + rng.below(40);
    if (round % 2 == 0) {
      for (std::size_t i = 0; i < n; ++i) {
        const double angle = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n);
        corners.push_back((0.05 + rng.uniform()) * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
      }
    } else {
      const auto wave = [&](double x) { return 5 * std::sin(2 * x); };
      for (std::size_t i = 0; i < n; ++i)
        corners.emplace_back(0.3 * static_cast<double>(i), wave(0.3 * static_cast<double>(i)));
      for (std::size_t i = n; i-- > 0;)
        corners.emplace_back(0.3 * static_cast<double>(i),
                             wave(0.3 * static_cast<double>(i)) + 0.01 + rng.uniform());
    }
    const Eigen::Matrix3d turned = any_rotation(rng);
    SCOPED_TRACE(round);
    expect_filled(corners, split(in_plane(corners, turned, turned.col(0) * 100)), turned.col(2));
  }
}

TEST(Polygons, ConvexOnesKeepTheirFan) {
  Rng rng(3, "polygons", "");
  for (int round = 0; round < 500; ++round) {
    const std::size_t n = 4 + rng.below(12);
    std::vector<double> angles;
    for (std::size_t i = 0; i < n; ++i) angles.push_back(2 * std::numbers::pi * rng.uniform());
    std::ranges::sort(angles);
    Flat corners;
    for (const double angle : angles) corners.emplace_back(3 * std::cos(angle), std::sin(angle));
    PolygonCounts counts;
    EXPECT_EQ(split(in_plane(corners, any_rotation(rng), {1e3, 1e3, 0}), &counts).faces, fan(n));
    EXPECT_EQ(counts.split, 1);
    EXPECT_EQ(counts.concave, 0);
  }
  // With corners within a straight edge, and as a warped quad of a grid.
  EXPECT_EQ(split({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {0, 1, 0}}).faces, fan(6));
  EXPECT_EQ(split({{0, 0, 0}, {1, 0, 0.3}, {1, 1, 0}, {0, 1, 0.3}}).faces, fan(4));
}

// The whole polygon is visible from its reflex corner, which comes first.
TEST(Polygons, AConcaveOneThatItsFanFillsKeepsIt) {
  PolygonCounts counts;
  EXPECT_EQ(split(in_plane({{1, 1}, {0, 0}, {2, 1}, {0, 2}}), &counts).faces, fan(4));
  EXPECT_EQ(counts.concave, 1);
}

// Brute-force reference in exact integers: true if two edges without a common corner meet.
bool crosses(const Flat& p) {
  const auto side = [](const auto& a, const auto& b, const auto& c) {
    const double area = (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
    return area > 0 ? 1 : area < 0 ? -1 : 0;
  };
  const std::size_t n = p.size();
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) {
      const auto &a = p[i], &b = p[(i + 1) % n], &c = p[j], &d = p[(j + 1) % n];
      if (side(a, b, c) * side(a, b, d) < 0 && side(c, d, a) * side(c, d, b) < 0) return true;
    }
  return false;
}

TEST(Polygons, RandomOnesAreFilledOrCrossThemselves) {
  Rng rng(4, "polygons", "");
  int filled = 0, refused = 0;
  for (int round = 0; round < 3000; ++round) {
    Flat corners;
    for (std::size_t i = 0, n = 4 + rng.below(4); i < n; ++i)
      corners.emplace_back(static_cast<double>(rng.below(1000000)), static_cast<double>(rng.below(1000000)));
    if (doubled_area(corners) < 0) std::ranges::reverse(corners);
    SCOPED_TRACE(round);
    if (crosses(corners)) {
      EXPECT_THAT([&] { split(in_plane(corners)); },
                  ThrowsMessage<InputError>(
                      testing::ContainsRegex("^7: edges . and . of the face .* cross each other: ")));
      ++refused;
    } else {
      expect_filled(corners, split(in_plane(corners)), Vec3::UnitZ());
      ++filled;
    }
  }
  EXPECT_GT(filled, 500);
  EXPECT_GT(refused, 500);
}

// A bridge of two equal edges connects the hole to the outline, as exporters write it.
TEST(Polygons, HolesStayOpen) {
  const Flat one = {{0, 0}, {9, 0}, {9, 9}, {0, 9}, {0, 0}, {3, 3}, {3, 6}, {6, 6}, {6, 3}, {3, 3}};
  const Flat two = {{0, 0},  {19, 0}, {19, 9}, {0, 9},  {0, 0},  {3, 3}, {3, 6}, {6, 6},
                    {13, 6}, {16, 6}, {16, 3}, {13, 3}, {13, 6}, {6, 6}, {6, 3}, {3, 3}};
  EXPECT_EQ(doubled_area(one), 2 * (81 - 9));
  EXPECT_EQ(doubled_area(two), 2 * (171 - 18));
  Rng rng(5, "polygons", "");
  for (const Flat& shape : {one, two}) expect_filled_from_everywhere(shape, rng);
}

TEST(Polygons, OneThatWindsTwiceOrOverlapsItselfIsRefused) {
  Flat star;
  for (int i = 0; i < 5; ++i)
    star.emplace_back(std::cos(0.8 * std::numbers::pi * i), std::sin(0.8 * std::numbers::pi * i));
  const Flat bow_tie = {{0, 0}, {2, 2}, {2, 0}, {0, 2}}, uneven = {{0, 0}, {3, 3}, {3, 0}, {0, 1}};
  for (const Flat& crossing : {star, bow_tie, uneven})
    EXPECT_THAT([&] { split(in_plane(crossing)); }, Refuses("cross each other"));
  // Two triangles of opposite orientation that share a corner: no edges cross, and the orientation is
  // ambiguous.
  const Flat overlapping = {{0, 0}, {4, 0}, {4, 4}, {0, 0}, {-1, 0}, {-1, 1}};
  EXPECT_THAT([&] { split(in_plane(overlapping)); }, Refuses("7: the face overlaps itself"));
}

// Polygons without area, or fully covered by the fan, do no harm: mesh_check drops what has no area.
TEST(Polygons, DegenerateOnesDoNoHarm) {
  EXPECT_EQ(split(std::vector<Vec3>(5, Vec3(1, 2, 3))).faces, fan(5));
  EXPECT_EQ(split({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {4, 4, 4}}).faces, fan(4));
  EXPECT_EQ(split({{0, 0, 0}, {3, 3, 3}, {1, 1, 1}, {0.1, 0.1, 0.1}}).faces, fan(4));
  EXPECT_EQ(split({{0, 0, 0}, {0, 0, 0}, {1, 0, 0}, {1, 1, 0}}).faces, fan(4));
  EXPECT_EQ(split({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, 1, 0}, {0, 0, 0}}).faces, fan(5));
  EXPECT_EQ(split({{0, 0, 0}, {1e-200, 0, 0}, {1e-200, 1e-200, 0}, {0, 1e-200, 0}}).faces, fan(4));
  EXPECT_EQ(split({{-1e150, 0, 0}, {1e150, 0, 0}, {1e150, 1e150, 0}, {-1e150, 1e150, 0}}).faces, fan(4));
  // There and back along a bent line: no area remains.
  const Mesh back = split({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {2, 1, 0}, {1, 1, 0}, {1, 0, 0}});
  EXPECT_EQ(back.faces.size(), 4U);
  for (const Triangle& face : back.faces) EXPECT_EQ(face_area_vector(back, face).norm(), 0);
  EXPECT_THAT([&] { check_mesh(back); }, Refuses("degenerate"));
}

// Edges there and back on a straight line: where no ear is left, a corner within such a line is cut off.
TEST(Polygons, EdgesThatGoBackAlongThemselvesAreCutOff) {
  const Flat back = {{0, 0}, {4, 0}, {3, 0}, {1, 1}, {1, 3}, {1, 2}};
  EXPECT_EQ(split(in_plane(back)).faces, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}, {5, 0, 3}, {3, 4, 5}}));
  Rng rng(6, "polygons", "");
  expect_filled_from_everywhere(back, rng);
}

TEST(Polygons, LargeOnesEndInTime) {
  constexpr int kCorners = 1 << 14;
  Flat round, comb;
  for (int i = 0; i < 2 * kCorners; ++i) {
    const double angle = std::numbers::pi * i / kCorners;
    round.emplace_back(std::cos(angle), std::sin(angle));
  }
  EXPECT_EQ(split(in_plane(round)).faces, fan(round.size())) << "convex: any number of corners";
  for (int i = 0; i < kCorners - 2; ++i) comb.emplace_back(i, i % 2 == 0 ? 0 : 100);
  comb.emplace_back(kCorners, 200);
  comb.emplace_back(-1, 200);
  expect_filled(comb, split(in_plane(comb)), Vec3::UnitZ());
  comb.emplace_back(-1, 150);
  EXPECT_THAT([&] { split(in_plane(comb)); },
              Refuses("16385 corners: at most 16384 can be split into triangles"));
}

// --- through the readers ----------------------------------------------------------------------------------

constexpr const char* kVertices = "v 0 0 0\nv 2 1 0\nv 0 2 0\nv 1 1 0\n";
const std::vector<Triangle> kArrowFaces = sorted({{0, 1, 3}, {1, 2, 3}});

std::string ply(std::string_view face, std::string_view vertices) {
  return "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_indices\nelement vertex 4\n"
         "property float x\nproperty float y\nproperty float z\nend_header\n" +
         std::string(face) + "\n" + std::string(vertices);
}

TEST(Polygons, FacesMayStandBeforeTheirVertices) {
  EXPECT_EQ(sorted(parse_obj("f 1 2 3 4\n" + std::string(kVertices), "x.obj").faces), kArrowFaces);
  EXPECT_EQ(sorted(parse_obj(kVertices + std::string("f -4 -3 -2 -1\n"), "x.obj").faces), kArrowFaces);
  EXPECT_EQ(sorted(parse_off("OFF 4 1\n0 0 0\n2 1 0\n0 2 0\n1 1 0\n4 0 1 2 3\n", "x.off").faces),
            kArrowFaces);
  EXPECT_EQ(sorted(parse_ply(ply("4 0 1 2 3", "0 0 0\n2 1 0\n0 2 0\n1 1 0\n"), "x.ply").faces), kArrowFaces);
}

TEST(Polygons, OneThatCrossesItselfIsNamedByFileAndLine) {
  EXPECT_THAT([&] { parse_obj("f 1 2 3 4\nv 0 0 0\nv 9 9 0\nv 9 0 0\nv 0 9 0\n", "x.obj"); },
              Refuses("x.obj:1: edges 1 and 3"));
  EXPECT_THAT([&] { parse_off("OFF 4 2\n0 0 0\n9 9 0\n9 0 0\n0 9 0\n3 0 1 2\n4 0 1 2 3\n", "x.off"); },
              Refuses("x.off:7: edges 1 and 3"));
  const std::string text = ply("4 3 0 2 1", "0 0 0\n0 9 0\n9 0 0\n9 9 0\n");
  EXPECT_THAT([&] { parse_ply(text, "x.ply"); }, Refuses("x.ply:10: edges 1 and 3"));
}

TEST(Polygons, OneInABinaryFileIsNamedByItsNumber) {
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty char x\nproperty char y\n"
      "property char z\nelement face 2\nproperty list char char vertex_indices\nelement edge 1\n"
      "property char a\nend_header\n";
  bytes += std::string(
      "\0\0\0"
      "\7\7\0"
      "\7\0\0"
      "\0\7\0"
      "\3\0\1\2"
      "\4\0\1\2\3"
      "\0",
      12 + 4 + 5 + 1);
  EXPECT_THAT([&] { parse_ply(bytes, "x.ply"); }, Refuses("x.ply: face 2 (counted from 1): edges 1 and 3"));
}

TEST(Polygons, TheReadersCountThem) {
  PolygonCounts counts;
  parse_obj(kVertices + std::string("v 5 5 0\nf 1 2 3\nf 1 2 3 4\nf 1 2 5 3\nf 1 2 5 3 4\n"), "x.obj",
            &counts);
  EXPECT_EQ(counts.split, 3);
  EXPECT_EQ(counts.concave, 2);
}

TEST(Polygons, TrianglesKnowTheFaceOfTheFileThatTheyArePartOf) {
  const auto faces_with = [](const std::vector<std::size_t>& sizes) {
    Mesh mesh;
    for (int i = 0; i < 9; ++i) mesh.vertices.emplace_back(std::cos(0.1 * i), std::sin(0.1 * i), 0);
    Polygons polygons;
    for (const std::size_t size : sizes) {
      std::vector<std::int32_t> corners(size);
      std::iota(corners.begin(), corners.end(), 0);
      polygons.add(corners, 0, mesh.faces);
    }
    const PolygonCounts counts = polygons.split(mesh, [](std::size_t, const std::string&) {});
    EXPECT_EQ(faces_in_file(counts, mesh.faces.size()), sizes.size());
    return faces_of_triangles(counts, mesh.faces.size());
  };
  EXPECT_THAT(faces_with({}), IsEmpty());
  EXPECT_THAT(faces_with({3, 3, 3}), ElementsAre(0, 1, 2));
  EXPECT_THAT(faces_with({4, 4}), ElementsAre(0, 0, 1, 1));
  EXPECT_THAT(faces_with({3, 5, 3, 3, 4, 6, 3}), ElementsAre(0, 1, 1, 1, 2, 3, 4, 4, 5, 5, 5, 5, 6));
  EXPECT_EQ(text_of_faces(16, 32), "16 faces, split into 32 triangles");
  EXPECT_EQ(text_of_faces(12, 12), "12 faces");
}

}  // namespace
}  // namespace salbench
