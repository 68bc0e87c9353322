// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/hdf5/value.h"

#include "io/hdf5/head.h"
#include "tests/support/shapes.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

// Round trip through arrays and a file image, bit for bit.
template <class T>
T round_trip(const T& value) {
  const Arrays arrays = content_by_head(image_with_head({ArrayForm<T>::arrays(value), {}}))->arrays;
  return ArrayForm<T>::read(arrays);
}

void expect_same(const Scores& a, const Scores& b) {
  EXPECT_THAT(a.values, Pointwise(testing::NanSensitiveDoubleEq(), b.values));
  EXPECT_EQ(a.n_points, b.n_points);
  EXPECT_EQ(a.n_picks, b.n_picks);
}

TEST(Value, MeshComesBackToTheBit) {
  const Mesh mesh = shapes::bumpy_sphere(2);
  const Mesh back = round_trip(mesh);
  EXPECT_EQ(back.vertices, mesh.vertices);
  EXPECT_EQ(back.faces, mesh.faces);
}

TEST(Value, ScanKeepsItsCamera) {
  const Scan back = round_trip(Scan{shapes::random_cloud(10, 1), {1, 2, 3}});
  EXPECT_EQ(back.points, shapes::random_cloud(10, 1));
  EXPECT_EQ(back.camera, Vec3(1, 2, 3));
}

TEST(Value, DescriptorsKeepTheirSupport) {
  const Descriptors back = round_trip(Descriptors{std::vector<float>(66, 0.5F), 0.25, 9});
  EXPECT_EQ(back.size(), 2U);
  EXPECT_EQ(back.radius, 0.25);
  EXPECT_EQ(back.neighbours, 9);
}

TEST(Value, GroundTruthKeepsParticipantsWithoutPicks) {
  const GroundTruth truth{{0.5, 1.0}, {{1, 0}, {}, {1}}, true};
  const GroundTruth back = round_trip(truth);
  EXPECT_EQ(back.saliency, truth.saliency);
  EXPECT_EQ(back.picks, truth.picks);
  EXPECT_TRUE(back.simulated);
  EXPECT_TRUE(round_trip(GroundTruth{}).picks.empty());
}

TEST(Value, GroundTruthKeepsViewersAndWhatTheyDidNotSee) {
  constexpr double kUnseen = kNan;
  const GroundTruth truth{{0.5, kUnseen}, {}, false, {{0.5, kUnseen}, {kUnseen, kUnseen}, {0.25, 1}}};
  const GroundTruth back = round_trip(truth);
  EXPECT_TRUE(std::isnan(back.saliency[1]));
  ASSERT_EQ(back.viewers.size(), 3U);
  EXPECT_EQ(back.viewers[0][0], 0.5);
  EXPECT_TRUE(std::isnan(back.viewers[1][0]));
  EXPECT_EQ(back.viewers[2], truth.viewers[2]);
}

TEST(Value, GroundTruthRefusesViewersOfAnotherShape) {
  Arrays arrays = ArrayForm<GroundTruth>::arrays({{0.5, 1}, {}, false, {{1, 2}}});
  std::get<std::vector<double>>(arrays.back().values).push_back(3);
  EXPECT_THROW(ArrayForm<GroundTruth>::read(arrays), InputError);
}

TEST(Value, ScoresKeepUndefinedMetricsAndCurvesAndTablesTheirOrder) {
  const std::vector<Scores> rows = {{{0.5, 0.6, -1}, 100, 7}, {{kNan, 0.7, 2}, 101, 8}, {{0, kNan, 0}, 3, 1}};
  const HumanCurve curve = round_trip(HumanCurve(rows));
  const ScoreTable table = round_trip(ScoreTable{rows});
  ASSERT_EQ(curve.size(), 3U);
  ASSERT_EQ(table.rows.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    expect_same(round_trip(rows[i]), rows[i]);
    expect_same(curve[i], rows[i]);
    expect_same(table.rows[i], rows[i]);
  }
  const Arrays arrays = ArrayForm<ScoreTable>::arrays({rows});
  EXPECT_THAT(arrays[0].shape, ElementsAre(3, 3));
  EXPECT_THAT(arrays[1].shape, ElementsAre(3, 2));
  EXPECT_TRUE(round_trip(HumanCurve{}).empty());
  EXPECT_TRUE(round_trip(ScoreTable{}).rows.empty());
}

TEST(Value, AHumanCurveCutOffIsNoCurve) {
  Arrays arrays = ArrayForm<HumanCurve>::arrays(HumanCurve(3, Scores{{0.5, 0.6}, 100, 7}));
  EXPECT_EQ(arrays[0].shape, (std::vector<std::size_t>{3, 2}));
  std::get<std::vector<double>>(arrays[0].values).pop_back();
  EXPECT_THROW(ArrayForm<HumanCurve>::read(arrays), InputError);
}

TEST(Value, CentreDensityRoundTripsAndNeedsAllItsBins) {
  CentreDensity density;
  density.marked[3] = 0.25;
  density.points[99] = 1.0 / 3;
  density.shapes = 7;
  const CentreDensity read = round_trip(density);
  EXPECT_EQ(read.marked, density.marked);
  EXPECT_EQ(read.points, density.points);
  EXPECT_EQ(read.shapes, 7);
  Arrays arrays = ArrayForm<CentreDensity>::arrays(density);
  arrays[1].values = std::vector<double>(99);
  EXPECT_THROW(ArrayForm<CentreDensity>::read(arrays), InputError);
}

TEST(Value, FieldsNormalsFacesAndHistogramsComeBack) {
  EXPECT_EQ(round_trip(ScalarField{1, 2, 3}), (ScalarField{1, 2, 3}));
  EXPECT_EQ(round_trip(Normals{{0, 0, 1}}), (Normals{{0, 0, 1}}));
  EXPECT_EQ(round_trip(Faces{{0, 1, 2}}), (Faces{{0, 1, 2}}));
  EXPECT_EQ(round_trip(Faces{}), Faces{});
  Histogram histogram{};
  histogram[99] = 3;
  EXPECT_EQ(round_trip(histogram), histogram);
}

Picture toy_picture() {
  Picture picture;
  picture.size = 200;  // large enough to be compressed
  for (std::int32_t i = 0; i < 200 * 200; ++i) {
    picture.primitive.push_back(i % 7 - 1);
    picture.weights.insert(picture.weights.end(), {0.25F, 0.5F, 0.25F});
    picture.depth.push_back(i % 7 == 0 ? std::numeric_limits<float>::infinity() : 1.5F);
    picture.shade.push_back(static_cast<std::uint8_t>(i % 256));
    picture.coverage.push_back(static_cast<std::uint8_t>(255 - i % 256));
  }
  for (std::size_t i = 0; i < 16; ++i) picture.view_projection[i] = 1.0 / static_cast<double>(i + 1);
  return picture;
}

TEST(Value, PicturesComeBackPacked) {
  const Picture picture = toy_picture();
  const Picture back = round_trip(picture);
  EXPECT_EQ(back.size, picture.size);
  EXPECT_EQ(back.primitive, picture.primitive);
  EXPECT_EQ(back.weights, picture.weights);
  EXPECT_EQ(back.depth, picture.depth);
  EXPECT_EQ(back.shade, picture.shade);
  EXPECT_EQ(back.coverage, picture.coverage);
  EXPECT_EQ(back.view_projection, picture.view_projection);
  EXPECT_LT(hdf5_image({ArrayForm<Picture>::arrays(picture), {}}).size(), 4 * picture.pixels());  // out of 22
}

TEST(Value, APictureWhoseDataSetsDoNotBelongTogetherIsNamed) {
  Picture other = toy_picture();
  other.shade.pop_back();
  Arrays arrays = ArrayForm<Picture>::arrays(other);
  EXPECT_THAT([&] { ArrayForm<Picture>::read(arrays); }, Refuses("shade"));
  arrays[0].shape = {400, 100};
  EXPECT_THAT([&] { ArrayForm<Picture>::read(arrays); }, Refuses("primitive"));
}

TEST(Value, ACloudComesBackAndItsDroppedPointsAscendWithinTheFile) {
  const auto with = [](std::vector<std::int32_t> dropped) {
    return ArrayForm<PointCloud>::arrays(
        {.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 2}}, .dropped = std::move(dropped)});
  };
  const PointCloud cloud = ArrayForm<PointCloud>::read(with({1, 4, 5}));
  EXPECT_EQ(cloud.points.size(), 3U);
  EXPECT_THAT(cloud.dropped, ElementsAre(1, 4, 5));
  for (const std::vector<std::int32_t>& dropped :
       {std::vector{4, 1}, std::vector{1, 1}, std::vector{-1}, std::vector{0, 5}})
    EXPECT_THAT([&] { ArrayForm<PointCloud>::read(with(dropped)); }, Refuses("dropped"));
}

TEST(Value, MissingOrStrangeArraysAreNamed) {
  Arrays arrays = ArrayForm<Mesh>::arrays(shapes::tetrahedron());
  arrays.pop_back();
  EXPECT_THAT([&] { ArrayForm<Mesh>::read(arrays); }, Refuses("faces"));
}

}  // namespace
}  // namespace salbench
