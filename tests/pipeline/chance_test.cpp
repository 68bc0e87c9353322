// SPDX-License-Identifier: GPL-3.0-or-later
// Remarks on metrics by which chance or a constant map is as good as a model.
#include "pipeline/results/chance.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/rules/models.h"

namespace salbench {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

const double kNan = std::nan("");

Metrics two_metrics() {  // higher values are better, and lower ones
  MetricsOptions options;
  options.names = {"nss", "kl"};
  return chosen_metrics(options);
}

ResultRow row_of(const std::string& item, const std::string& model, double nss, double kl) {
  return {"meshes", item, "", "", model, {{nss, kl}}};
}

std::vector<std::string> remarks_on(const std::vector<ResultRow>& rows) {
  std::vector<std::string> lines;
  for (const ChanceRemark& remark : chance_remarks(rows, two_metrics(), Observation::mesh))
    lines.push_back(remark.dataset + ", " + remark.metric + ": " + remark.text);
  return lines;
}

TEST(ChanceRemarks, NameTheModelsPassedAndByHowMuch) {
  EXPECT_THAT(
      remarks_on({row_of("1", "A", 0.5, 1), row_of("1", "B", 0.2, 3), row_of("1", "HS", 0.1, 20),
                  row_of("1", "RS", 0, 2), row_of("1", "constant", 0, 1.5)}),
      ElementsAre("meshes, kl: chance (RS) is level with or ahead of B (by 1), HS (by 18); a constant map is "
                  "level with or ahead of B (by 1.5), HS (by 18.5)"));
}

TEST(ChanceRemarks, EqualMeansAreLevelWhateverTheOrderOfTheirSums) {
  EXPECT_THAT(remarks_on({row_of("1", "A", 0.1 + 0.2, 1), row_of("1", "RS", 0.3, 2)}),
              ElementsAre("meshes, nss: chance (RS) is level with or ahead of A (level)"));
  EXPECT_THAT(remarks_on({row_of("1", "A", 0.31, 1), row_of("1", "RS", 0.3, 2)}), IsEmpty());
}

// Where a shape has no score of the one, the other's does not count.
TEST(ChanceRemarks, AreAboutTheShapesThatBothHave) {
  const std::vector<ResultRow> rows = {row_of("1", "A", 0.5, kNan), row_of("2", "A", 0.5, 3),
                                       row_of("1", "RS", 0, 9), row_of("2", "RS", 0, 2.5),
                                       row_of("3", "RS", 5, 0)};
  EXPECT_THAT(remarks_on(rows), ElementsAre("meshes, kl: chance (RS) is level with or ahead of A (by 0.5)"));
  EXPECT_THAT(remarks_on({row_of("1", "A", kNan, kNan), row_of("1", "RS", 1, 1)}), IsEmpty());
  EXPECT_THAT(remarks_on({row_of("1", "A", 1, 1)}), IsEmpty()) << "no reference";
  EXPECT_THAT(remarks_on({}), IsEmpty());
}

}  // namespace
}  // namespace salbench
