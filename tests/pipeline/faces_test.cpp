// SPDX-License-Identifier: GPL-3.0-or-later
// Maps scored on faces, against values published per face. tests/pipeline/faces_twin_test.py recomputes the
// scores.
#include "stages/geometry/faces.h"

#include "pipeline/inputs/listing.h"
#include "pipeline/rules/given_maps.h"
#include "tests/pipeline/data_sets.h"
#include "tests/support/cloud_text.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

constexpr const char* kItems = R"(
def items(root):
    return [Item(one.item, [one.path, f"{root}/maps/{one.item}.csv"]) for one in match(root, "off/{item}.*")]
)";
const std::string kPerFace = std::string(kItems) + R"(
from salbench.datasets.reading import from_faces

def read(item):
    shape = mesh(item.files[0])
    shape.face_truth = face_values(item.files[1], shape, unseen=-1)
    shape.ground_truth = from_faces(shape, shape.face_truth)
    return shape
)";
const std::string kOnFaces = "scans: false, score_on: faces";

// One value per line, n lines.
std::string values_of_faces(std::size_t n) {
  std::string lines;
  for (std::size_t i = 0; i < n; ++i) lines += fmt::format("{}\n", i % 7);
  return lines;
}

class OnFaces : public DataSets {
 protected:
  GroundTruth truth_of_faces() const { return toy_->value<GroundTruth>("face_truth", mesh_unit(0)); }
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
  run(data_set(kPerFace), kOnFaces);
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
  run(data_set(kPerFace), kOnFaces);
  EXPECT_THAT(failures(), IsEmpty());
  const auto map = [&](const char* stage) { return toy_->value<ScalarField>(stage, mesh_unit(0)); };
  EXPECT_THAT(map("map.RS"), SizeIs(sphere.vertices.size()));
  EXPECT_EQ(map("face_map.RS"), values_by_face(map("map.RS"), sphere.vertices.size(), sphere.faces));
  EXPECT_THAT(map("matched.RS"), SizeIs(sphere.faces.size()));
  EXPECT_EQ(toy_->results()[0].scores.n_points, static_cast<std::int64_t>(sphere.faces.size()));
  run(data_set(kPerFace));
  EXPECT_THAT(stages(), Not(Contains(HasSubstr("face_"))));
}

// A cube with square sides, except for one of two triangles.
constexpr const char* kSquares =
    "OFF\n8 7 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n4 0 3 2 1\n3 4 5 6\n3 4 6 7\n"
    "4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n";

// Vertices take precedence if both counts match.
TEST_F(OnFaces, AGivenMapOfPolygonsIsReadAsThatOfTriangles) {
  const std::string eight_of_both =
      "OFF\n8 8 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n4 0 3 2 1\n3 4 5 6\n3 4 6 7\n"
      "3 0 1 5\n3 0 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n";
  const auto read = [&](const std::string& mesh, std::size_t n, bool on_faces) {
    data_.write("cat.off", mesh);
    folder_.write("given/cat.val", values_of_faces(n));
    const Inputs inputs = read_inputs(find_dataset(data_.path(), "folder"));
    const auto given = find_given_maps(folder_ / "given", false);
    const auto files = map_files(given, inputs.units, {kMeshes}, on_faces).at(kMeshes);
    return files->at(0).at(0).read().content;
  };
  EXPECT_THAT(std::get<ScalarField>(read(kSquares, 7, true)),
              ElementsAre(0, 0, 1, 2, 3, 3, 4, 4, 5, 5, 6, 6));
  for (const auto& [mesh, n, on_faces] :
       std::vector<std::tuple<std::string, std::size_t, bool>>{{kSquares, 7, false},
                                                               {kSquares, 8, true},
                                                               {kSquares, 12, true},
                                                               {kSquares, 5, true},
                                                               {eight_of_both, 8, true}})
    EXPECT_EQ(std::get<std::string>(read(mesh, n, on_faces)), values_of_faces(n)) << "as it stands";
}

TEST_F(OnFaces, AsManyValuesAsFacesInPlaceOfVerticesAreToldApart) {
  data_.write("cat.off", kSquares);
  for (const auto& [n, is_of_faces] : {std::pair(7, true), {12, true}, {6, false}}) {
    data_.write("Distributions/cat.val", values_of_faces(static_cast<std::size_t>(n)));
    run("folder");
    ASSERT_THAT(failures(), Contains(HasSubstr("cat.val")));
    EXPECT_EQ(failures()[0].find("7 faces, split into 12 triangles") != std::string::npos, is_of_faces);
  }
}

TEST_F(OnFaces, WithoutValuesPerFaceAnItemFailsWithARemedy) {
  write_toy_item(data_.path(), "21", shapes::bumpy_sphere(2));
  run("schelling", kOnFaces);
  EXPECT_THAT(failures(), ElementsAre(AllOf(HasSubstr("21.off: "), HasSubstr("score_on: vertices"))));
}

TEST_F(OnFaces, APointCloudFailsWithARemedy) {
  data_.write("off/cat.xyz", xyz_text(shapes::bumpy_sphere(1).vertices));
  data_.write("maps/cat.csv", values_of_faces(42));
  run(data_set(std::string(kItems) + R"(
def read(item):
    shape = cloud(item.files[0])
    shape.ground_truth = values(item.files[1], len(shape.points))
    return shape
)"),
      kOnFaces);
  EXPECT_THAT(failures(), Contains(AllOf(HasSubstr("cat.xyz: "), HasSubstr("score_on: vertices"))));
}

TEST_F(OnFaces, ACommandMayAnswerPerFaceAndThenHasAnotherKey) {
  data_.write("off/cat.off", off_text(shapes::bumpy_sphere(2)));
  data_.write("maps/cat.csv", values_of_faces(320));
  const auto run_command = [&](const std::string& more) {
    Runs::run(
        fmt::format("dataset: {{layout: {0}, {1}}}\nmetrics: {{names: [cc], matching: none}}\n"
                    "models: {{MINE: {{command: 'cp {2} {{out}} && test {{mesh}}', depends: [{2}]}}}}\n",
                    data_set(kPerFace), more, place("maps/cat.csv")));
  };
  run_command(kOnFaces);
  EXPECT_THAT(failures(), IsEmpty());
  EXPECT_NEAR(toy_->results().at(0).value(0), 1, 1e-12) << "the ground truth itself";
  run_command("scans: false");
  EXPECT_THAT(failures(), ElementsAre(HasSubstr("320 values, but the shape has 162 points")));
}

}  // namespace
}  // namespace salbench
