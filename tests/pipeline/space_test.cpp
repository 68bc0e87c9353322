// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/results/space.h"

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cache/layout.h"
#include "stages/scan/scan.h"
#include "tests/support/cache_files.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/toy_data.h"

namespace salbench {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kAll = "scan: {step_degrees: 0.5}\nmodels: {PS: , RS: }\n";

class SpaceTest : public testing::Test {
 protected:
  void add_item(int number) const {
    write_toy_item(data_.path(), std::to_string(number), shapes::bumpy_sphere(3, 0.1 + 0.02 * number));
  }
  SpaceNeed need(const std::string& yaml = kAll) const {
    FolderStore cache(cache_.path(), Access::read_only);
    const ToyRun toy(data_.path(), cache, yaml);
    return space_needed(toy.config, toy.inputs, toy.project, toy.plan(), cache);
  }
  std::size_t run(const std::string& items = "") const {  // returns how many jobs there were
    FolderStore cache(cache_.path(), Access::read_write);
    ToyRun toy(data_.path(), cache, kAll, items);
    toy.run();
    return toy.resolver->computed();
  }
  std::uint64_t bytes_on_disk() const {
    std::uint64_t bytes = 0;
    for (const auto& file : list_segments(cache_.path())) bytes += std::filesystem::file_size(file);
    return bytes;
  }

  TemporaryFolder data_, cache_;
};

TEST_F(SpaceTest, WithoutACacheIsEstimatedFromAboveAndNotByFar) {
  add_item(1), add_item(2);
  const SpaceNeed need = this->need();
  EXPECT_EQ(need.by_cache, 0U);
  EXPECT_EQ(run(), need.artefacts);
  const std::uint64_t bytes = bytes_on_disk();
  EXPECT_GT(need.bytes, bytes);
  EXPECT_LT(need.bytes, 2 * bytes);
  const std::size_t files = list_segments(cache_.path()).size();
  EXPECT_GE(need.files, files);
  EXPECT_LE(need.files, 3 * files);
}

TEST_F(SpaceTest, OfNothingToDoIsNothing) {
  add_item(1);
  run();
  const SpaceNeed need = this->need();
  EXPECT_EQ(need.artefacts, 0U);
  EXPECT_EQ(need.bytes, 0U);
  EXPECT_EQ(need.files, 0U);
}

TEST_F(SpaceTest, WithArtefactsOfTheSameRulesFollowsTheirSizes) {
  for (int i = 1; i <= 9; ++i) add_item(i);
  run("1-8");
  const std::uint64_t eight = bytes_on_disk();
  const SpaceNeed ninth = need();
  EXPECT_GT(ninth.by_cache, 0U);
  run();
  const auto grown = static_cast<double>(bytes_on_disk() - eight);
  const auto estimated = static_cast<double>(ninth.bytes);
  EXPECT_GT(estimated, grown * 0.95);
  EXPECT_LT(estimated, grown * 1.3);
}

TEST_F(SpaceTest, GrowsWithTheRaysOfAScan) {
  add_item(1);
  const std::uint64_t coarse = need().bytes;
  const SpaceNeed fine = need("scan: {step_degrees: 0.125}\nmodels: {PS: , RS: }\n");  // 16 times the rays
  EXPECT_GT(fine.bytes, 2 * coarse);
  EXPECT_LT(fine.bytes, 16 * coarse);
}

TEST(PointsOfScan, OfABallAreTheRaysThatMeetIt) {
  const ScanOptions options{.step_degrees = 0.25};
  const Mesh ball = shapes::bumpy_sphere(4, 0);
  double points = 0;
  for (int view = 0; view < kViews; ++view)
    points += static_cast<double>(simulate_scan(ball, view, options).points.size());
  EXPECT_NEAR(points / kViews, points_of_scan(options), 0.02 * points_of_scan(options));
}

TEST(Shortage, IsNamedWithWhatToDo) {
  const SpaceNeed need{.artefacts = 7000, .files = 7500, .bytes = 5'120'000'000};
  EXPECT_THAT(shortage(need, {}), IsEmpty());
  EXPECT_THAT(shortage(need, {.bytes = 5'120'000'000, .files = 7500}), IsEmpty());
  EXPECT_THAT(shortage(need, {.bytes = 2'040'000'000}),
              AllOf(HasSubstr("needs about 5.1 GB in 7500 files, and 2.0 GB are free: free some space"),
                    HasSubstr("--cache"), HasSubstr("--items")));
  EXPECT_THAT(shortage(need, {.files = 7499}), HasSubstr("and 7499 files are free"));
}

}  // namespace
}  // namespace salbench
