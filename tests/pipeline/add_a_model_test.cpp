// docs/add_a_model.md, followed: a model that is not in the catalog takes part in a run like those that are.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/results.h"
#include "stages/core/mesh_ops.h"
#include "tests/support/job_counts.h"
#include "tests/support/memory_store.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/toy_data.h"

namespace salbench {
namespace {

struct FarOptions {
  double power = 1;

  static FarOptions text() { return {.power = 2}; }

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("power", self.power, {"of the distance", {}, at_least(0)});
  }
};

ScalarField far_saliency(const ModelInput& input, const FarOptions& options) {
  const Vec3 center = centroid(input.points);
  ScalarField saliency;
  for (const Vec3& p : input.points) saliency.push_back(std::pow((p - center).norm(), options.power));
  return saliency;
}

Model far_model(const std::string& yaml, Protocol protocol) {
  return model_row("FAR", 1, kReadsPoints, far_saliency).bind(Section::from_text(yaml, "far.yaml"), protocol);
}

TEST(AddAModel, ItsSectionIsReadOverTheProtocolsDefaults) {
  EXPECT_EQ(far_model("", Protocol::published).options, "power: 1\n");
  EXPECT_EQ(far_model("", Protocol::text).options, "power: 2\n");
  EXPECT_EQ(far_model("power: 3", Protocol::text).options, "power: 3\n");
  EXPECT_THROW(far_model("powr: 3", Protocol::text), ConfigError);
  EXPECT_THROW(far_model("power: -1", Protocol::text), ConfigError);
  EXPECT_EQ(far_model("power: 3", Protocol::text).annotated_options, "# of the distance (>= 0)\npower: 3\n");
}

TEST(AddAModel, ItIsMappedMatchedScoredAndReported) {
  TemporaryFolder data;
  write_toy_item(data.path(), "1", shapes::bumpy_sphere(2));
  MemoryStore store;
  {
    ToyRun others(data.path(), store);
    others.run();
    store.take_saved();
  }
  Config config = toy_config();
  config.models.push_back(far_model("", Protocol::published));
  ToyRun run(data.path(), store, config);
  run.run();
  // Nothing of the other models is touched.
  const auto computed = store.take_saved();
  const JobCounts jobs(config, 1);
  EXPECT_THAT(computed, testing::SizeIs(jobs.of("map.FAR") + jobs.of("matched.FAR") + jobs.of("scores.FAR") +
                                        jobs.of("mean_histogram.FAR")));
  EXPECT_THAT(computed, testing::Each(testing::HasSubstr("FAR")));
  const auto rows = collect_results(run.config, run.context, run.plan, run.runner);
  const auto scored =
      std::count_if(rows.begin(), rows.end(), [](const ResultRow& row) { return row.model == "FAR"; });
  EXPECT_EQ(static_cast<std::size_t>(scored), jobs.shapes());
  EXPECT_THAT(to_csv(summary_table(rows)), testing::HasSubstr("meshes,FAR,auc,1,"));
}

}  // namespace
}  // namespace salbench
