// SPDX-License-Identifier: GPL-3.0-or-later
// Maps that are scored on faces, against values that are published per face.
// tests/pipeline/faces_twin_test.py computes the scores again.
#include "stages/core/faces.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/core/errors.h"
#include "tests/pipeline/data_sets.h"
#include "tests/support/cloud_text.h"

namespace salbench {
namespace {

using testing::Contains;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::IsNan;
using testing::Not;
using testing::SizeIs;
using testing::ThrowsMessage;

constexpr const char* kPerFace =
    "places: [{meshes: 'off/*', truth: {saliency: 'maps/{item}.csv'}}]\n"
    "values: {per: face, unseen: '-1'}\n";
const std::string kOnFaces = "scans: false, score_on: faces";

// A value in each of n lines.
std::string values_of_faces(std::size_t n) {
  std::string lines;
  for (std::size_t i = 0; i < n; ++i) lines += fmt::format("{}\n", i % 7);
  return lines;
}

class OnFaces : public DataSets {
 protected:
  GroundTruth truth_of_faces() const {
    return value_as<GroundTruth>(*toy_->resolver->value({toy_->index("face_truth"), mesh_unit(0)}));
  }
  std::vector<std::string> stages() const {
    std::vector<std::string> names;
    for (const Rule& rule : toy_->project.rules) names.push_back(rule.stage);
    return names;
  }
};

TEST_F(OnFaces, TruthHasTheValuesOfTheFacesThatAreLeft) {
  Mesh mesh = shapes::tetrahedron();
  const Triangle first = mesh.faces[0], last = mesh.faces[3];
  mesh.faces = {{0, 0, 1}, mesh.faces[0], {first[1], first[2], first[0]}, mesh.faces[1], mesh.faces[2], last,
                {2, 1, 2}, last};
  data_.write("off/cat.off", off_text(mesh));
  data_.write("maps/cat.csv", "9\n1\n8\n2\n-1\n4\n7\n6\n");
  run(description(kPerFace), kOnFaces);
  EXPECT_THAT(failures(), IsEmpty());
  EXPECT_THAT(truth_of_faces().saliency, ElementsAre(1, 2, IsNan(), 4));
  EXPECT_THAT(truth_of_faces().picks, IsEmpty());
  ASSERT_THAT(toy_->results(), SizeIs(1)) << "of RS; HS needs people who picked faces";
  EXPECT_EQ(toy_->results()[0].scores.n_points, 3);
  EXPECT_TRUE(std::isfinite(score_of("RS", "cc")));
  EXPECT_THAT(score_of("RS", "nss"), IsNan());
}

TEST_F(OnFaces, ScoresReadTheMapOfFaces) {
  const Mesh sphere = shapes::bumpy_sphere(2);
  data_.write("off/cat.off", off_text(sphere));
  data_.write("maps/cat.csv", values_of_faces(sphere.faces.size()));
  run(description(kPerFace), kOnFaces);
  EXPECT_THAT(failures(), IsEmpty());
  const auto map = [&](const char* stage) {
    return value_as<ScalarField>(*toy_->resolver->value({toy_->index(stage), mesh_unit(0)}));
  };
  EXPECT_THAT(map("map.RS"), SizeIs(sphere.vertices.size()));
  EXPECT_EQ(map("face_map.RS"), values_by_face(map("map.RS"), sphere.vertices.size(), sphere.faces));
  EXPECT_THAT(map("matched.RS"), SizeIs(sphere.faces.size()));
  EXPECT_EQ(toy_->results()[0].scores.n_points, static_cast<std::int64_t>(sphere.faces.size()));
  run(description(kPerFace));
  EXPECT_THAT(stages(), Not(Contains(HasSubstr("face_"))));
}

TEST_F(OnFaces, WithoutValuesPerFaceAnItemFailsWithARemedy) {
  write_toy_item(data_.path(), "21", shapes::bumpy_sphere(2));
  run("schelling", kOnFaces);
  EXPECT_THAT(failures(), ElementsAre(HasSubstr("21.off: its ground truth has no values per face; write "
                                                "dataset: {score_on: vertices}")));
}

TEST_F(OnFaces, APointCloudFailsWithARemedy) {
  data_.write("off/cat.xyz", xyz_text(shapes::bumpy_sphere(1).vertices));
  data_.write("maps/cat.csv", values_of_faces(42));
  run(description("places: [{meshes: 'off/*', truth: {saliency: 'maps/{item}.csv'}}]\n"), kOnFaces);
  EXPECT_THAT(failures(), Each(HasSubstr("cat.xyz: a point cloud has no faces to score; write dataset: "
                                         "{score_on: vertices}")));
  EXPECT_THAT(failures(), Not(IsEmpty()));
}

TEST_F(OnFaces, ScansAndSimulatedPeopleAreScoredOnVertices) {
  const auto read = [](const std::string& dataset) {
    return [=] { read_config(Section::from_text("dataset: " + dataset, "config"), "test"); };
  };
  EXPECT_THAT(read("{score_on: faces}"), ThrowsMessage<ConfigError>(HasSubstr("write scans: false")));
  EXPECT_THAT(read("{score_on: faces, scans: false, participants: simulated}"),
              ThrowsMessage<ConfigError>(HasSubstr("they pick vertices")));
}

TEST_F(OnFaces, ACommandMayAnswerPerFaceAndThenHasAnotherKey) {
  data_.write("off/cat.off", off_text(shapes::bumpy_sphere(2)));
  data_.write("maps/cat.csv", values_of_faces(320));
  const auto run_command = [&](const std::string& more) {
    toy_ = std::make_unique<ToyRun>(
        data_.path(), store_,
        fmt::format("dataset: {{layout: {}, {}}}\nmetrics: {{names: [cc], matching: none}}\n"
                    "models: {{MINE: {{command: 'cp {} {{out}} && test {{mesh}}'}}}}\n",
                    description(kPerFace), more, place("maps/cat.csv")));
    toy_->run();
  };
  run_command(kOnFaces);
  EXPECT_THAT(failures(), IsEmpty());
  EXPECT_NEAR(toy_->results().at(0).value(0), 1, 1e-12) << "the ground truth itself";
  run_command("scans: false");
  EXPECT_THAT(failures(), ElementsAre(HasSubstr("320 values, but the shape has 162 points")));
}

}  // namespace
}  // namespace salbench
