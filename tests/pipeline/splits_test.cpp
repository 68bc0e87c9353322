// SPDX-License-Identifier: GPL-3.0-or-later
// Splits of a data set, in items and tables.

#include "pipeline/results/tables.h"
#include "tests/pipeline/data_sets.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

const Mesh kTetrahedron = shapes::tetrahedron();
constexpr const char* kTable = "from_table(listing, f'{root}/splits.csv')";
constexpr const char* kNames =
    "from_names(listing, {'train': ['ant', 'bee', 'cat'], 'test': ['dog', 'eel']}, 'by us')";

class WithSplits : public DataSets {
 protected:
  WithSplits() {
    for (const char* name : {"ant", "bee", "cat", "dog", "eel"}) {
      data_.write(fmt::format("off/{}.off", name), off_text(kTetrahedron));
      data_.write(fmt::format("maps/{}.val", name), "0\n1\n2\n3\n");
    }
  }
  // splits: a call of a function of salbench.datasets.splits; may be empty.
  std::string split_by(const std::string& splits) {
    return data_set(R"(
from salbench.datasets.splits import from_list, from_names, from_table

def items(root):
    listing = Listing([Item(one.item, [one.path], saliency=f"{root}/maps/{one.item}.val")
                       for one in match(root, "off/{item}.off")])
    return )" + (splits.empty() ? "listing" : splits) +
                    "\n");
  }
  // Each item with its split: "ant:train".
  std::vector<std::string> run_splits(const std::string& splits, const std::string& chosen = "''") {
    run(split_by(splits), "scans: false, split: " + chosen);
    std::vector<std::string> found;
    for (const Family& family : toy_->inputs.units.families())
      found.push_back(family.name + ":" + item_of(family.source).split);
    return found;
  }
};

TEST_F(WithSplits, ATableNamesTheSplitOfEachItem) {
  data_.write("splits.csv", "item,split\nbee,test\nant,train\neel,val\ncat,train\n");
  EXPECT_THAT(run_splits(kTable), ElementsAre("ant:train", "bee:test", "cat:train", "dog:", "eel:val"));
  EXPECT_THAT(run_splits(kTable, "train"), ElementsAre("ant:train", "cat:train"));
}

// The digest covers the assignment of items to splits: order, remarks, the format of the source and the
// choice of items have no effect.
TEST_F(WithSplits, SplitsHaveADigest) {
  const auto digest = [&](const std::string& splits, const std::string& chosen = "''") {
    run_splits(splits, chosen);
    return toy_->inputs.splits;
  };
  data_.write("splits.csv", "item,split\nbee,test\nant,train\neel,val\ncat,train\n");
  const std::string first = digest(kTable);
  EXPECT_EQ(first, xxh128("ant,train\nbee,test\ncat,train\neel,val\n").hex()) << "as xxh128sum prints it";
  EXPECT_EQ(digest(kTable, "train"), first);
  EXPECT_EQ(digest("from_names(listing, {'train': ['cat', 'ant'], 'val': ['eel'], 'test': ['bee']})"), first);
  data_.write("splits.csv", "split,item\ntrain,ant\nval,eel\ntrain,cat\ntest,bee\n");
  EXPECT_EQ(digest(kTable), first);
  data_.write("splits.csv", "item,split\nbee,test\nant,train\neel,val\ncat,test\n");
  EXPECT_NE(digest(kTable), first);
  EXPECT_EQ(digest(""), "");
}

TEST_F(WithSplits, ASplitTakesWhatIsInAnotherToo) {
  data_.write("paths.txt", "ant\nbee\ncat\ndog\neel\n");
  const std::string splits =
      "from_list(listing, f'{root}/paths.txt', {'train': 0.4, 'train+test': 0.2, 'test': 0.4})";
  EXPECT_THAT(run_splits(splits, "train"), ElementsAre("ant:train", "bee:train", "cat:train+test"));
  EXPECT_THAT(run_splits(splits, "test"), ElementsAre("cat:train+test", "dog:test", "eel:test"));
  EXPECT_THAT(run_splits(splits, "train+test"), ElementsAre("cat:train+test"));
  EXPECT_THAT([&] { run_splits(splits, "tests"); }, Refuses<UnknownNameError>("it has test, train ("));
}

TEST_F(WithSplits, TablesHaveMeansPerSplit) {
  run_splits(kNames);
  const std::vector<ResultRow> rows = toy_->results();
  const Table all_rows = results_table(rows, metrics()), table = means_table(rows, metrics());
  EXPECT_THAT(std::vector(all_rows.columns.begin(), all_rows.columns.begin() + 3),
              ElementsAre("dataset", "split", "item"));
  EXPECT_EQ(std::get<std::string>(all_rows.rows.back()[1]), "test");
  ASSERT_THAT(table.columns.at(1), "split");
  const auto means = [&](const std::string& split) {
    for (const auto& row : table.rows)
      if (row[1] == Cell(split) && row[2] == Cell(std::string("cc")) && row[3] == Cell(std::string("RS")))
        return std::pair(std::get<std::int64_t>(row[4]), std::get<double>(row[5]));
    return std::pair(std::int64_t{-1}, 0.0);
  };
  const auto [n_all, all] = means("");
  const auto [n_train, train] = means("train");
  const auto [n_test, test] = means("test");
  EXPECT_EQ(std::tuple(n_all, n_train, n_test), std::tuple(5, 3, 2));
  EXPECT_NEAR(5 * all, 3 * train + 2 * test, 1e-12);
  EXPECT_EQ(table.rows[0][1], Cell(std::string())) << "all splits together come first";
}

TEST_F(WithSplits, TablesOfOneSplitNameItAndHaveEachRowOnce) {
  run_splits(kNames, "test");
  const Table table = means_table(toy_->results(), metrics());
  EXPECT_THAT(table.rows, SizeIs(metrics().size())) << "of RS; HS needs people, which this set has not";
  for (const auto& row : table.rows) EXPECT_EQ(row[1], Cell(std::string("test")));
}

TEST_F(WithSplits, AnItemInTwoSplitsFailsAloneAndStillHasMaps) {
  data_.write("splits.csv",
              "item,split\nant,train\nbee,test\nant,test\nbee,test\ncat,val\ndog,val\neel,val\n");
  run_splits(kTable);
  EXPECT_THAT(failures(), ElementsAre(AllOf(HasSubstr("splits.csv:4: 'ant'"), HasSubstr("splits.csv:2"))));
  EXPECT_EQ(truth(1).saliency, (ScalarField{0, 1, 2, 3}));
  EXPECT_EQ(toy_->decision("ground_truth", 0).state, State::failed);
  EXPECT_TRUE(toy_->decision("map.RS", 0).computed());
}

TEST_F(WithSplits, AnUnknownSplitNamesThoseThatThereAre) {
  EXPECT_THAT([&] { run_splits(kNames, "tets"); },
              Refuses<UnknownNameError>("split 'tets'", "did you mean 'test'?", "test, train (by us)"));
  EXPECT_THAT([&] { run_splits("", "test"); }, Refuses<UnknownNameError>("split 'test'"));
  EXPECT_THAT([&] { run_splits(kTable, "test"); }, Refuses<ConfigError>(place("splits.csv")));
}

}  // namespace
}  // namespace salbench
