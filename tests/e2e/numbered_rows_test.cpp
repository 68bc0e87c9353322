// SPDX-License-Identifier: GPL-3.0-or-later
// Ground truth and maps whose rows say which vertex they are about: shuffled, they give the scores of the
// others.
#include <algorithm>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/file.h"
#include "io/ground_truth_file.h"
#include "tests/e2e/workspace.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

// Last first, numbered from `base`.
std::string shuffled(const ScalarField& values, const std::string& header, std::size_t base) {
  std::string lines = header;
  for (std::size_t i = values.size(); i-- > 0;) lines += fmt::format("{},{}\n", i + base, values[i]);
  return lines;
}

class NumberedRows : public testing::Test {
 protected:
  NumberedRows() {
    toy_.write("gaze.yaml",
               "places:\n  - meshes: Meshes/*.off\n    truth:\n      saliency: \"gaze/{item}.csv\"\n"
               "      picks: \"RawData/{item}_{participant}.pid\"\n"
               "values: {column: density}\n");
    toy_.configure(fmt::format("dataset: {{scans: false, layout: '{}'}}\nmodels: {{PS: , RS: }}\n",
                               (toy_ / "gaze.yaml").string()));
  }

  ScalarField truth(const std::string& item) const {
    const fs::path file = toy_.data() / "Distributions" / (item + ".val");
    return parse_values(read_file(file), file.string());
  }
  void write_truth(const std::function<std::string(const ScalarField&)>& text) const {
    fs::create_directories(toy_.data() / "gaze");
    for (const char* item : {"1", "2"})
      write_file(toy_.data() / fmt::format("gaze/{}.csv", item), text(truth(item)));
  }
  std::string scores() const {
    const Outcome run = toy_.salbench("run");
    EXPECT_EQ(run.status, 0) << run.err;
    return toy_.results();
  }

  Workspace toy_;
};

TEST_F(NumberedRows, OfGroundTruthAreObeyed) {
  write_truth(
      [](const ScalarField& values) { return fmt::format("density\n{}\n", fmt::join(values, "\n")); });
  const std::string ordered = scores();
  for (const char* header : {"vertex,density\n", "index,density\n", "id,density\n", "# vertex,density\n"})
    for (const std::size_t base : {0U, 1U}) {
      write_truth([&](const ScalarField& values) { return shuffled(values, header, base); });
      EXPECT_EQ(scores(), ordered) << header << base;
    }
}

TEST_F(NumberedRows, OfGroundTruthThatNumberNoVertexFailTheirItem) {
  write_truth([](const ScalarField& values) { return shuffled(values, "vertex,density\n", 2); });
  const Outcome run = toy_.salbench("run");
  EXPECT_EQ(run.status, 1);
  EXPECT_THAT(run.err, HasSubstr("1.csv:2: column \"vertex\" has 163; it numbers the vertices"));
}

TEST_F(NumberedRows, OfMapsAreObeyed) {
  toy_.configure(kMeshesOnly);
  const auto scores_of = [&](const std::function<std::string(const ScalarField&)>& text) {
    for (const char* item : {"1", "2"}) toy_.write(fmt::format("own/{}.val", item), text(truth(item)));
    const Outcome run = toy_.salbench("evaluate", {"--maps", (toy_ / "own").string(), "--name", "OWN"});
    EXPECT_EQ(run.status, 0) << run.err;
    return toy_.results();
  };
  const std::string ordered =
      scores_of([](const ScalarField& values) { return fmt::format("{}\n", fmt::join(values, "\n")); });
  for (const char* header : {"vertex,saliency\n", "Vertex ID,saliency\n", "# vertex,saliency\n"})
    EXPECT_EQ(scores_of([&](const ScalarField& values) { return shuffled(values, header, 0); }), ordered)
        << header;
}

}  // namespace
}  // namespace salbench
