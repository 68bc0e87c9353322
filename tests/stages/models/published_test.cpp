// SPDX-License-Identifier: GPL-3.0-or-later
// Models against the benchmark authors' published results, with the `published` protocol. The program behind
// their MS is unknown: there the agreement is close, not exact.
#include "tests/stages/metrics/published.h"

#include <functional>

#include "io/shapes/mesh_file.h"
#include "stages/descriptors/fpfh.h"
#include "stages/models/cs.h"
#include "stages/models/ls.h"
#include "stages/models/ms.h"
#include "stages/models/ps.h"
#include "stages/normals/normals.h"
#include "tests/support/correlation.h"
#include "tests/support/data.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

struct Published {
  const char* name;
  std::function<ScalarField(const Mesh&)> map_of;
  double nss, cc;                                   // largest mean errors over the meshes with scores
  std::vector<std::pair<int, double>> correlation;  // smallest, with the paper's figure, by mesh
};
void PrintTo(const Published& model, std::ostream* out) { *out << model.name; }

Descriptors descriptors_of(const Mesh& mesh) {
  return fpfh(mesh.vertices, mesh_normals(mesh), FpfhOptions{});
}

const Published kModels[] = {
    {"LS",
     [](const Mesh& mesh) {
       return ls_saliency(mesh.vertices, mesh_normals(mesh), descriptors_of(mesh), LsOptions{});
     },
     0.002,
     0.002,
     {{2, 0.995}, {65, 0.99}, {336, 0.995}}},
    {"PS",
     [](const Mesh& mesh) { return ps_saliency(mesh.vertices, descriptors_of(mesh), {}); },
     0.005,
     0.005,
     {{2, 0.995}, {65, 0.995}}},
    {"MS",
     [](const Mesh& mesh) { return ms_saliency(mesh.vertices, mesh.faces, MsOptions{}); },
     0.04,
     0.04,
     {{2, 0.97}, {65, 0.955}}},
};

Mesh read(const std::filesystem::path& data, int item) {
  return read_mesh(data / "SchellingData" / "Meshes" / (std::to_string(item) + ".off"));
}

class PublishedModel : public testing::TestWithParam<Published> {};

TEST_P(PublishedModel, HasTheScoresAndTheMapsOfThePaper) {
  const auto data = real_data();
  if (!data) GTEST_SKIP() << kNoRealData;
  const auto& [name, map_of, most_nss, most_cc, correlation] = GetParam();
  const auto map_of_item = [&](const published::path& folder, int item) {
    return GetParam().map_of(read(folder, item));
  };
  const published::MeanErrors errors = published::mean_errors(*data, name, map_of_item);
  EXPECT_EQ(errors.meshes, 12);
  EXPECT_LE(errors.nss, most_nss);
  EXPECT_LE(errors.cc, most_cc);
  for (const auto& [item, least] : correlation)
    EXPECT_GE(published::correlation_with_figure(*data, name, item, map_of_item(*data, item)), least) << item;
}
INSTANTIATE_TEST_SUITE_P(Published, PublishedModel, testing::ValuesIn(kModels),
                         testing::PrintToStringParamName());

TEST(CsPublished, MapsAreThoseOfTheAuthors) {
  const auto data = real_data();
  if (!data) GTEST_SKIP() << kNoRealData;
  std::vector<double> agreement;
  for (int item = 1; item <= 400; item += 3) {  // a third of the 92
    const auto file = *data / "reference" / "CS" / (std::to_string(item) + ".val");
    if (!std::filesystem::exists(file)) continue;
    const Mesh mesh = read(*data, item);
    const ScalarField map = cs_saliency(mesh.vertices, mesh_normals(mesh), CsOptions{});
    agreement.push_back(spearman(map, published::numbers(file)));
  }
  ASSERT_GT(agreement.size(), 25U);
  std::ranges::sort(agreement);
  EXPECT_GE(agreement[agreement.size() / 2], 0.99) << "median";
  EXPECT_GE(agreement[agreement.size() / 10], 0.95) << "a tenth is below";
}

}  // namespace
}  // namespace salbench
