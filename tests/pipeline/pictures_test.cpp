// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures are computed only on request, and do not affect scores.

#include "pipeline/engine/maintain.h"
#include "tests/pipeline/runner_fixture.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

const std::string kWithPictures = std::string(kToyConfig) + "picture: {size: 40}\n";

Config toy_config_with(Pictures pictures) {
  Config config = toy_config();
  config.picture.size = 40;
  config.pictures = pictures;
  return config;
}

class PicturesTest : public RunnerTest {
 protected:
  // As `salbench export --for-report` does.
  std::vector<std::string> take_pictures() {
    Config config = toy_config_with(Pictures::computed);
    config.cached_alone = true;
    return run(config);
  }
};

TEST(PictureRows, AreThereWhereTheConfigurationHasTheirSection) {
  EXPECT_FALSE(has_rule(make_rules(toy_config()), kMeshes, "picture"));
  EXPECT_THAT(config_yaml(toy_config()), Not(HasSubstr("picture")));
  for (const std::string yaml : {"picture:\n", "picture: {size: 77}\n"}) {
    const Config config = toy_config(yaml);
    const Rules rules = make_rules(config);
    EXPECT_TRUE(has_rule(rules, kMeshes, "picture") && has_rule(rules, kScans, "picture"));
  }
  EXPECT_EQ(toy_config("picture: {size: 77}").picture.size, 77);
  EXPECT_FALSE(has_rule(make_rules(toy_config("picture:\ndataset: {scans: false}")), kScans, "picture"));
}

TEST(PictureRows, TheirOptionsAreACommentWhereTheyAreOff) {
  EXPECT_THAT(annotated_config_yaml(toy_config()), HasSubstr("# picture:\n#   # width and height"));
}

TEST_F(PicturesTest, ARunThatIsAskedForThemComputesThemOnceAndTheSameScores) {
  run(kToyConfig);
  const std::string without = results();
  const auto added = run(kWithPictures);
  EXPECT_THAT(failures(), IsEmpty());
  EXPECT_THAT(added, SizeIs(jobs_.shapes()));
  EXPECT_THAT(added, Each(StartsWith("picture@")));
  EXPECT_EQ(results(), without);
  EXPECT_THAT(run(kWithPictures), IsEmpty());
  EXPECT_THAT(run(kToyConfig), IsEmpty());
}

TEST_F(PicturesTest, AloneTheyNeedNoModel) {
  std::set<std::string> stages;
  for (const std::string& saved : take_pictures()) stages.insert(saved.substr(0, saved.find('@')));
  EXPECT_THAT(stages, ElementsAre("ground_truth", "mesh", "normals", "picture", "scan", "scan_ground_truth",
                                  "scan_normals", "surface"));
  EXPECT_THAT(take_pictures(), IsEmpty());
}

TEST_F(PicturesTest, AnotherOptionTakesNewPicturesAndNothingElse) {
  run(kWithPictures);
  const auto again = run(std::string(kToyConfig) + "picture: {size: 40, azimuth: 10}\n");
  EXPECT_THAT(again, SizeIs(jobs_.shapes()));
  EXPECT_THAT(again, Each(StartsWith("picture@")));
}

TEST_F(PicturesTest, FromTheCacheOnlyTheyAreFoundOrNotApplicable) {
  const auto find = [&] {
    EXPECT_THAT(run(toy_config_with(Pictures::cached)), Not(Contains(StartsWith("picture@"))));
    EXPECT_THAT(failures(), IsEmpty());
    std::size_t found = 0;
    for (const Level level : {kMeshes, kScans})
      for (const Decision& job : toy_->plan().decisions[toy_->index("picture", level)]) {
        found += job.known() ? 1U : 0U;
        EXPECT_TRUE(job.known() || job.reason == Reason::only_cached);
      }
    return found;
  };
  EXPECT_EQ(find(), 0U);
  take_pictures();
  EXPECT_EQ(find(), jobs_.shapes());
  for (const char* stage : {"mesh", "scan"}) store_.remove(stage, stage == std::string("mesh") ? "1" : "2_3");
  EXPECT_EQ(find(), jobs_.shapes()) << "although what they read had to be computed again";
}

TEST_F(PicturesTest, AreCollectedOnlyWithTheirOptions) {
  take_pictures();
  const auto needed = [&](Config config) {
    const ToyRun toy(data_.path(), store_, std::move(config));
    KeepSet keep;
    add_needed(toy.project, toy.plan(), keep);
    const Job picture{toy.index("picture"), mesh_unit(0)};
    return toy.plan()[picture].known() && keep.covers("picture", "1", toy.plan()[picture].key);
  };
  EXPECT_TRUE(needed(toy_config_with(Pictures::cached)));
  Config other = toy_config_with(Pictures::cached);
  other.picture.size = 50;
  EXPECT_FALSE(needed(other));
}

}  // namespace
}  // namespace salbench
