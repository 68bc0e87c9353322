// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/results/score_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/core/errors.h"
#include "tests/support/temporary_folder.h"

namespace salbench {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;

class ScoreFileTest : public testing::Test {
 protected:
  ScoreFile read(std::string_view text, const ScoreColumns& columns = {}) const {
    return read_scores(folder_.write("scores.csv", text), columns);
  }
  std::string refusal(std::string_view text, const ScoreColumns& columns = {}) const {
    try {
      read(text, columns);
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  }

  TemporaryFolder folder_;
};

TEST_F(ScoreFileTest, RowsWithAViewAreScans) {
  const ScoreFile file = read("item,view,model,nss,auc\n1,,LS,2,.5\n1,3,LS,,.7\n");
  ASSERT_THAT(file.rows, SizeIs(2));
  EXPECT_EQ(file.rows[0].dataset, "meshes");
  EXPECT_EQ(file.rows[1].dataset, "scans");
  ASSERT_THAT(file.metrics, SizeIs(2));
  EXPECT_EQ(file.metrics[0].name, "auc");  // in the program's order
  EXPECT_THAT(file.rows[0].scores.values, ElementsAre(.5, 2));
  EXPECT_TRUE(std::isnan(file.rows[1].value(1)));
}

TEST_F(ScoreFileTest, LccIsMadeOfCcWhereItIsMissing) {
  EXPECT_THAT(read("item,model,cc\n1,LS,-.5\n").rows[0].scores.values, ElementsAre(-.5, .5));
  EXPECT_THAT(read("item,model,cc,lcc\n1,LS,-.5,.25\n").rows[0].scores.values, ElementsAre(-.5, .25));
}

TEST_F(ScoreFileTest, OtherColumnsCountIfTheyAreNamed) {
  const char* text = "item,model,auc,mine,error\n1,LS,.5,3,4\n";
  EXPECT_THAT(read(text).notes, ElementsAre(HasSubstr("left out: mine, error")));
  const ScoreFile file = read(text, {.higher_is_better = {"mine"}, .lower_is_better = {"error"}});
  EXPECT_THAT(file.notes, SizeIs(0));
  EXPECT_THAT(file.rows[0].scores.values, ElementsAre(.5, 3, 4));
  EXPECT_TRUE(file.metrics[1].higher_is_better);
  EXPECT_FALSE(file.metrics[2].higher_is_better);
}

TEST_F(ScoreFileTest, ClassesComeFromAFileOfTheirOwn) {
  const auto classes = folder_.write("classes.csv", "item,class\n1,cup\n");
  const auto scores = folder_.write("scores.csv", "item,model,auc\n1,LS,.5\n2,LS,.5\n");
  const ScoreFile file = read_scores(scores, {}, classes);
  EXPECT_EQ(file.rows[0].category, "cup");
  EXPECT_EQ(file.rows[1].category, "");
}

TEST_F(ScoreFileTest, BadTablesAreRefusedByLine) {
  EXPECT_THAT(refusal("item,model\n1,LS\n"), HasSubstr("no column is a metric"));
  EXPECT_THAT(refusal("model,auc\nLS,.5\n"), HasSubstr("item"));
  EXPECT_THAT(refusal("item,model,auc\n1,LS,good\n"), HasSubstr("scores.csv:2"));
  EXPECT_THAT(refusal("item,model,auc\n1,LS,inf\n"), HasSubstr("scores.csv:2"));
  EXPECT_THAT(refusal("item,model,auc\n1,LS,.5\n1,LS,.6\n"),
              HasSubstr("scores.csv:3: a second row of item '1'"));
  EXPECT_THAT(refusal("dataset,item,model,auc\nshapes,1,LS,.5\n"),
              HasSubstr("scores.csv:2: data set 'shapes'"));
  EXPECT_THAT(refusal("item,model,auc\n"), HasSubstr("no scores"));
  EXPECT_THAT(refusal("item,model,auc\n1,LS,.5\n", {.higher_is_better = {"mine"}, .lower_is_better = {}}),
              HasSubstr("no column 'mine'"));
}

}  // namespace
}  // namespace salbench
