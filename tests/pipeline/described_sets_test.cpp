// SPDX-License-Identifier: GPL-3.0-or-later
// What a description can say of a data set beside where its files lie: splits, masks, views as units, and
// point clouds in columns with their ground truth.
#include <algorithm>
#include <cmath>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cache/folder_store.h"
#include "pipeline/inputs/given_maps.h"
#include "pipeline/results/conclusions.h"
#include "stages/core/errors.h"
#include "tests/pipeline/data_sets.h"

namespace salbench {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::IsNan;
using testing::SizeIs;
using testing::StartsWith;
using testing::ThrowsMessage;

const Mesh kTetrahedron = shapes::tetrahedron();

class DescribedSets : public DataSets {
 protected:
  std::string place(const std::string& name) const { return (data_ / name).string(); }
  std::vector<std::string> units() const {
    std::vector<std::string> names;
    for (const Family& family : toy_->inputs.units.families()) names.push_back(family.name);
    return names;
  }
};

// --- splits -----------------------------------------------------------------------------------------------

class WithSplits : public DescribedSets {
 protected:
  WithSplits() {
    for (const char* name : {"ant", "bee", "cat", "dog", "eel"}) {
      data_.write(fmt::format("off/{}.off", name), off_text(kTetrahedron));
      data_.write(fmt::format("maps/{}.val", name), "0\n1\n2\n3\n");
    }
  }
  std::string split_by(const std::string& splits) {
    return description("places:\n  - meshes: off/*\n    truth: {saliency: 'maps/{item}.val'}\n" + splits);
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
  EXPECT_THAT(run_splits("splits: {file: splits.csv}\n"),
              ElementsAre("ant:train", "bee:test", "cat:train", "dog:", "eel:val"));
  EXPECT_THAT(toy_->inputs.notes, Contains(HasSubstr("own.yaml:4): dog")));
  EXPECT_THAT(run_splits("splits: {file: splits.csv}\n", "train"), ElementsAre("ant:train", "cat:train"));
  data_.write("parts.csv", "part;name\n");
  EXPECT_THAT([&] { run_splits("splits: {file: parts.csv}\n"); },
              ThrowsMessage<InputError>(HasSubstr("parts.csv")));
}

TEST_F(WithSplits, TheFirstLinesOfAListAreOneSplit) {
  data_.write("paths.txt", "rgb/dog.obj\nD:\\data\\ant.obj,maps/ant.csv\n\nbee\nrgb/eel.obj\nrgb/cat.obj\n");
  EXPECT_THAT(run_splits("splits: {list: paths.txt, shares: {train: 80%, test: 0.2}}\n"),
              ElementsAre("ant:train", "bee:train", "cat:test", "dog:train", "eel:train"));
  EXPECT_THAT(run_splits("splits: {list: paths.txt, shares: {train: 0.5, test: 0.5}}\n"),
              ElementsAre("ant:train", "bee:test", "cat:test", "dog:train", "eel:test"))
      << "int(5 * 0.5) lines";
}

TEST_F(WithSplits, ADescriptionMayNameTheItems) {
  EXPECT_THAT(run_splits("splits:\n  items:\n    train: [ant, bee, cat]\n    test: [dog, eel]\n"),
              ElementsAre("ant:train", "bee:train", "cat:train", "dog:test", "eel:test"));
}

TEST_F(WithSplits, TablesHaveMeansPerSplit) {
  run_splits("splits:\n  items:\n    train: [ant, bee, cat]\n    test: [dog, eel]\n");
  const std::vector<ResultRow> rows = toy_->results();
  const std::vector<Metric> metrics = chosen_metrics(toy_->config.metrics);
  const Conclusions conclusions = conclude(rows, metrics, {}, 1);
  const Table results = results_table(rows, metrics), summary = summary_table(conclusions);
  EXPECT_THAT(std::vector(results.columns.begin(), results.columns.begin() + 3),
              ElementsAre("dataset", "split", "item"));
  EXPECT_EQ(std::get<std::string>(results.rows.back()[1]), "test");
  ASSERT_THAT(summary.columns.at(1), "split");
  const auto means = [&](const std::string& split) {
    for (const auto& row : summary.rows)
      if (row[1] == Cell(split) && row[2] == Cell(std::string("RS")) && row[3] == Cell(std::string("cc")))
        return std::pair(std::get<std::int64_t>(row[4]), std::get<double>(row[5]));
    return std::pair(std::int64_t{-1}, 0.0);
  };
  const auto [n_all, all] = means("");
  const auto [n_train, train] = means("train");
  const auto [n_test, test] = means("test");
  EXPECT_EQ(std::tuple(n_all, n_train, n_test), std::tuple(5, 3, 2));
  EXPECT_NEAR(5 * all, 3 * train + 2 * test, 1e-12);
  EXPECT_EQ(&conclusions.datasets[0], conclusions.of("meshes")) << "all splits together come first";
}

TEST_F(WithSplits, TablesOfOneSplitNameItAndHaveEachRowOnce) {
  run_splits("splits:\n  items:\n    train: [ant, bee, cat]\n    test: [dog, eel]\n", "test");
  const std::vector<ResultRow> rows = toy_->results();
  const Conclusions conclusions = conclude(rows, chosen_metrics(toy_->config.metrics), {}, 1);
  ASSERT_THAT(conclusions.datasets, SizeIs(1));
  EXPECT_THAT(conclusions.datasets[0].scores.label(),
              ElementsAre(Cell(std::string("meshes")), Cell(std::string("test"))));
}

TEST_F(WithSplits, TablesOfASetWithoutSplitsHaveNoSuchColumn) {
  run_splits("");
  const std::vector<Metric> metrics = chosen_metrics(toy_->config.metrics);
  const std::vector<ResultRow> rows = toy_->results();
  EXPECT_EQ(results_table(rows, metrics).columns[1], "item");
  EXPECT_EQ(summary_table(conclude(rows, metrics, {}, 1)).columns[1], "model");
}

TEST_F(WithSplits, AnItemInTwoSplitsFailsAlone) {
  data_.write("splits.csv",
              "item,split\nant,train\nbee,test\nant,test\nbee,test\ncat,val\ndog,val\neel,val\n");
  run_splits("splits: {file: splits.csv}\n");
  EXPECT_THAT(failures(), ElementsAre(fmt::format(
                              "{0}:4: 'ant' is in the split 'test', and by {0}:2 in 'train': keep one "
                              "of them",
                              place("splits.csv"))));
  EXPECT_EQ(truth(1).saliency, (ScalarField{0, 1, 2, 3}));
}

TEST_F(WithSplits, ANameThatIsNoItemIsNotedWithItsLine) {
  data_.write("splits.csv", "item,split\nant,train\nbeee,test\n");
  run_splits("splits: {file: splits.csv}\n");
  EXPECT_THAT(failures(), IsEmpty());
  EXPECT_THAT(
      toy_->inputs.notes,
      Contains(StartsWith(place("splits.csv") + ":3: the split 'test' names 'beee', which is no item")));
}

TEST_F(WithSplits, AnUnknownSplitNamesThoseThatThereAre) {
  const std::string splits = "splits:\n  items:\n    train: [ant, bee, cat]\n    test: [dog, eel]\n";
  EXPECT_THAT([&] { run_splits(splits, "tets"); },
              ThrowsMessage<ConfigError>("split 'tets': the data set has no such split; did you mean 'test'? "
                                         "it has test, train (" +
                                         (folder_ / "own.yaml").string() + ":4)"));
  EXPECT_THAT([&] { run_splits("", "test"); },
              ThrowsMessage<ConfigError>(HasSubstr("split 'test': the data set has no splits")));
  EXPECT_THAT([&] { run_splits("splits: {file: splits.csv}\n", "test"); },
              ThrowsMessage<ConfigError>(HasSubstr(place("splits.csv") + ": is missing (")));
}

TEST_F(WithSplits, WrongDescriptionsAreNamedWithTheirLine) {
  const auto refused = [&](const std::string& splits, const std::string& why) {
    EXPECT_THAT([&] { run_splits(splits); },
                ThrowsMessage<ConfigError>(AllOf(HasSubstr("own.yaml:4"), HasSubstr(why))))
        << splits;
  };
  refused("splits: {file: a.csv, list: b.txt}\n", "one of file");
  refused("splits: {list: b.txt, shares: {train: 80%, test: 30%}}\n", "sum to 1");
  refused("splits: {list: b.txt}\n", "sum to 1");
  refused("splits: {list: b.txt, shares: {train: 180%}}\n", "splits.shares.train is not a share");
  refused("splits: {fle: b.txt}\n", "did you mean 'file'?");
}

// --- masks and views --------------------------------------------------------------------------------------

class WithViews : public DescribedSets {
 protected:
  WithViews() {
    write_view("1", "1\n2\n3\n4\n", "1\n1\n0\n1\n");
    write_view("2", "5\n0\n0\n8\n", "1\n1\n1\n0\n");
    data_.write("off/cat.off", off_text(kTetrahedron));
  }
  void write_view(const std::string& view, const std::string& values, const std::string& mask) {
    data_.write("fix/cat_" + view + ".txt", values);
    data_.write("seen/cat_" + view + "_visibility.txt", mask);
  }
  std::string described(const std::string& more = "    views: scored\n") {
    return description(
        "places:\n  - meshes: off/*\n    truth: {saliency: 'fix/{item}_{view}.txt', mask: "
        "'seen/{item}_{view}_visibility.txt'}\n" +
        more);
  }
};

TEST_F(WithViews, AreAveragedWhereTheyHaveAVertexSeen) {
  run(described(""));
  EXPECT_THAT(failures(), IsEmpty());
  EXPECT_EQ(truth().saliency, (ScalarField{3, 1, 0, 4}));
  EXPECT_THAT(units(), ElementsAre("cat"));
}

TEST_F(WithViews, AreUnitsOfTheirOwnIfTheyAreScored) {
  run(described());
  EXPECT_THAT(failures(), IsEmpty());
  EXPECT_THAT(units(), ElementsAre("cat_1", "cat_2"));
  EXPECT_THAT(truth(0).saliency, ElementsAre(1, 2, IsNan(), 4));
  EXPECT_THAT(truth(1).saliency, ElementsAre(5, 0, 0, IsNan()));
  std::set<std::pair<std::string, std::string>> rows;
  for (const ResultRow& row : toy_->results()) {
    rows.emplace(row.item, row.view);
    EXPECT_EQ(row.scores.n_points, 3);
  }
  EXPECT_THAT(rows, ElementsAre(std::pair("cat", "1"), std::pair("cat", "2")));
  const DatasetScores scores(toy_->results(), "meshes", Observation::mesh);
  EXPECT_EQ(scores.own(0, scores.find("RS")).units.size(), 1U) << "the mesh is the unit of inference";
}

// A family is claimed by its mesh: threads that come to another view of it take up other work first.
TEST_F(WithViews, ShareWhatIsComputedOfTheirMesh) {
  for (int view = 3; view < 9; ++view) write_view(std::to_string(view), "1\n2\n3\n4\n", "1\n1\n0\n1\n");
  FolderStore store(folder_ / "cache", Access::read_write);
  ToyRun toy(data_.path(), store,
             fmt::format("dataset: {{layout: {}, scans: false}}\nmodels: {{MS: , RS: }}\n", described()));
  toy.run(4);
  const auto computed = [&](std::string_view stage) {
    return toy.resolver->records()[toy.index(stage)].seconds.size();
  };
  EXPECT_EQ(computed("mesh"), 1U);
  EXPECT_EQ(computed("map.MS"), 1U);
  EXPECT_EQ(computed("map.RS"), 8U) << "random numbers are of the unit";
  EXPECT_EQ(computed("ground_truth"), 2U) << "six views are as the first";
}

TEST_F(WithViews, AreChosenByTheirNameOrByThatOfTheirMesh) {
  const Dataset dataset = find_dataset(data_.path(), layouts_of(described()));
  EXPECT_EQ(read_inputs(dataset, "cat").count(kMeshes), 2U);
  EXPECT_EQ(read_inputs(dataset, "cat_2").count(kMeshes), 1U);
}

TEST_F(WithViews, ShareAGivenMapUnlessTheyHaveTheirOwn) {
  const Inputs inputs = read_inputs(find_dataset(data_.path(), layouts_of(described())));
  const auto maps = [&] {
    const auto given = std::make_shared<const GivenMaps>(find_given_maps(folder_ / "given", false));
    std::vector<std::string> places;
    const FileColumnPtr column = map_files(given, inputs.units, {kMeshes}).at(kMeshes);
    for (const FilesOfUnit& files : column->files)
      places.push_back(std::filesystem::path(files.at(0).place).filename());
    return places;
  };
  folder_.write("given/cat.val", "1\n2\n3\n4\n");
  EXPECT_THAT(maps(), ElementsAre("cat.val", "cat.val"));
  folder_.write("given/cat_2.val", "1\n2\n3\n4\n");
  EXPECT_THAT(maps(), ElementsAre("cat.val", "cat_2.val"));
}

TEST_F(WithViews, FailAloneWithoutTheirMask) {
  std::filesystem::remove(data_ / "seen/cat_2_visibility.txt");
  run(described());
  EXPECT_THAT(failures(), ElementsAre(AllOf(StartsWith(place("seen/cat_2_visibility.txt") + ": is missing"),
                                            HasSubstr("own.yaml:3"))));
  EXPECT_THAT(truth(0).saliency, ElementsAre(1, 2, IsNan(), 4));
}

TEST_F(WithViews, FailAloneWithAWrongMask) {
  const auto failure = [&](const std::string& mask) {
    data_.write("seen/cat_2_visibility.txt", mask);
    run(described());
    return failures();
  };
  const std::string file = place("seen/cat_2_visibility.txt");
  EXPECT_THAT(failure("1\n1\n0\n"),
              ElementsAre(file + ":3: the file has 3 values, but the mesh has 4 vertices"));
  EXPECT_THAT(failure("1\n1\n0.5\n1\n"), ElementsAre(StartsWith(file + ":3: a mask has 0 for hidden")));
  EXPECT_THAT(failure("0\n0\n0\n0\n"), ElementsAre(StartsWith(file + ": hides everything")));
}

TEST_F(WithViews, MasksWithoutGroundTruthAreNoted) {
  data_.write("seen/cat_3_visibility.txt", "1\n1\n0\n1\n");
  run(described());
  EXPECT_THAT(toy_->inputs.notes,
              Contains(place("seen/cat_3_visibility.txt") + ": mask without ground truth"));
}

TEST_F(WithViews, WhatAMaskHoldsIsPartOfTheKey) {
  run(described());
  const Digest before = toy_->decision("ground_truth", 0).key;
  data_.write("seen/cat_1_visibility.txt", "1\n1\n1\n0\n");
  run(described());
  EXPECT_NE(toy_->decision("ground_truth", 0).key, before);
  EXPECT_THAT(truth(0).saliency, ElementsAre(1, 2, 3, IsNan()));
}

TEST_F(WithViews, WrongDescriptionsAreNamedWithTheirLine) {
  const auto refused = [&](const std::string& place, const std::string& why) {
    EXPECT_THAT([&] { run(description("places:\n  - " + place)); },
                ThrowsMessage<ConfigError>(AllOf(HasSubstr("own.yaml:2"), HasSubstr(why))));
  };
  refused("{meshes: 'off/*', views: scored, truth: {saliency: 'fix/{item}.txt'}}\n", "has no {view}");
  refused("{meshes: 'off/*', truth: {saliency: 'fix/{item}.txt', mask: 'm/{item}_{view}'}}\n",
          "must have the");
  refused("{meshes: 'off/*', truth: {picks: 'fix/{item}.txt', mask: 'm/{item}'}}\n", "without saliency");
}

// --- point clouds in columns ------------------------------------------------------------------------------

class InColumns : public DescribedSets {
 protected:
  static constexpr const char* kColumns =
      "columns: {position: [1, 2, 3], normal: [4, 5, 6], density: 7, flag: 8, normalise_normals: true, "
      "padding: any";

  // 12 points on a helix, with directions twice as long as normals.
  InColumns() {
    for (int i = 0; i < 12; ++i)
      lines_.push_back(fmt::format("{} {} {} {} {} 0 {} {}\n", std::cos(i), std::sin(i), 0.1 * i,
                                   20 * std::cos(i), 20 * std::sin(i), 0.5 * i, i % 5 == 2 ? 1 : 0));
  }
  std::string described(const std::string& more = "") {
    return description(
        fmt::format("domain: points\nplaces: [{{meshes: 'Gaze/*'}}]\n{}{}}}\n", kColumns, more));
  }
  void run_lines(const std::string& layout) {
    data_.write("Gaze/cat.txt", fmt::format("{}", fmt::join(lines_, "")));
    run(layout);
  }
  GroundTruth cloud_truth() const {
    return value_as<GroundTruth>(
        *toy_->resolver->value({toy_->index("cloud_ground_truth", kClouds), Unit{kClouds, 0}}));
  }
  PointCloud cloud() const {
    return value_as<PointCloud>(*toy_->resolver->value({toy_->index("cloud", kClouds), Unit{kClouds, 0}}));
  }

  std::vector<std::string> lines_;
};

TEST_F(InColumns, PositionNormalDensityAndFlagAreRead) {
  run_lines(described());
  EXPECT_THAT(failures(), IsEmpty());
  EXPECT_THAT(cloud().points, SizeIs(12));
  EXPECT_EQ(cloud().points[3], Vec3(std::cos(3), std::sin(3), 0.1 * 3));
  EXPECT_NEAR((cloud().normals[3] - Vec3(std::cos(3), std::sin(3), 0)).norm(), 0, 1e-12);
  EXPECT_EQ(cloud_truth().saliency[5], 2.5);
  EXPECT_THAT(cloud_truth().picks, ElementsAre(ElementsAre(2, 7)));
  EXPECT_EQ(toy_->results()[0].dataset, "clouds");
  EXPECT_EQ(toy_->results()[0].scores.n_points, 12);
}

TEST_F(InColumns, PaddingAndDuplicatesAreLeftOutWithTheirTruth) {
  lines_.insert(lines_.begin() + 4, lines_[2]);
  lines_.push_back("0 0 0 0 0 0 0 0\n");
  lines_.insert(lines_.end(), 2, lines_[1]);
  lines_.insert(lines_.end(), 2, "0 0 0 0 0 0 0 0\n");
  run_lines(described(", duplicates: dropped"));
  EXPECT_THAT(failures(), IsEmpty());
  EXPECT_THAT(cloud().points, SizeIs(12));
  EXPECT_THAT(cloud().dropped, ElementsAre(4, 13, 14, 15, 16, 17));
  EXPECT_EQ(cloud_truth().saliency[5], 2.5);
  EXPECT_THAT(cloud_truth().picks, ElementsAre(ElementsAre(2, 7)));
}

TEST_F(InColumns, DirectionsOfAnyLengthAreAnErrorUnlessTheyAreToBeNormalised) {
  data_.write("Gaze/cat.txt", fmt::format("{}", fmt::join(lines_, "")));
  run(description(
      "places: [{meshes: 'Gaze/*'}]\ncolumns: {position: [1, 2, 3], normal: [4, 5, 6], density: 7}\n"));
  EXPECT_THAT(failures(), ElementsAre(AllOf(StartsWith(place("Gaze/cat.txt") + ":1: the normal"),
                                            HasSubstr("normalise_normals"))));
}

TEST_F(InColumns, WrongFlagsAndShortLinesAreNamed) {
  lines_[3] = "1 1 1 1 0 0 0.5 0.5\n";
  run_lines(described());
  EXPECT_THAT(failures(), ElementsAre(StartsWith(place("Gaze/cat.txt") + ":4: the flag is neither 0 nor 1")));
  lines_[3] = "1 1 1 1 0 0 0.5\n";
  run_lines(described());
  EXPECT_THAT(failures(), ElementsAre(StartsWith(place("Gaze/cat.txt") + ":4: the line has 7 columns")));
}

TEST_F(InColumns, WhichColumnsAreReadIsPartOfTheKeys) {
  run_lines(described());
  const auto names = [&] {
    return std::pair(toy_->inputs.shape_files->files[0][0].name, toy_->inputs.truth_files->files[0][0].name);
  };
  EXPECT_EQ(
      names().first,
      "point cloud file .txt (position: [1, 2, 3], normal: [4, 5, 6], normalise_normals: true, padding: "
      "any, density: 7, flag: 8)");
  EXPECT_EQ(names().second, "ground truth in columns (density: 7, flag: 8)");
}

TEST_F(InColumns, ACommaSeparatedTextWithAHeaderIsReadByName) {
  data_.write("Gaze/cat.csv",
              "d,x,y,z\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n5,1,1,0\n6,1,0,1\n7,0,1,1\n8,1,1,1\n9,2,0,0\n");
  run(description("places: [{meshes: 'Gaze/*'}]\ncolumns: {position: [x, y, z], density: d}\n"));
  EXPECT_EQ(cloud().points[2], Vec3(0, 1, 0));
  EXPECT_EQ(cloud_truth().saliency, (ScalarField{1, 2, 3, 4, 5, 6, 7, 8, 9}));
}

}  // namespace
}  // namespace salbench
