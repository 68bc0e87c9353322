// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/inputs/inputs.h"

#include <fmt/format.h>

#include "pipeline/rules/rules.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

Dataset numbered(const TemporaryFolder& folder) {
  Dataset dataset;
  for (const char* name : {"1", "2", "5", "10", "cow"})
    dataset.items.push_back({.name = name, .file = folder.write(std::string(name) + ".off", name)});
  return dataset;
}

std::vector<std::string> names(const Inputs& inputs) {
  std::vector<std::string> result;
  for (const Family& family : inputs.units.families()) result.push_back(family.name);
  return result;
}

TEST(Inputs, SelectsNamesAndRangesInTheDataSetsOrder) {
  const TemporaryFolder folder;
  const Dataset dataset = numbered(folder);
  EXPECT_THAT(names(read_inputs(dataset, "")), ElementsAre("1", "2", "5", "10", "cow"));
  EXPECT_THAT(names(read_inputs(dataset, "cow, 2-9")), ElementsAre("2", "5", "cow"));
  EXPECT_THAT(names(read_inputs(dataset, "10,1")), ElementsAre("1", "10"));
}

TEST(Inputs, AListOfNamesMayHoldCommasAndBlanks) {
  Dataset dataset;
  for (const char* name : {"1", "a, b", " c"}) {
    dataset.items.push_back({.name = name, .file = std::string(name) + ".off"});
  }
  const auto chosen = [&](const ItemChoice& choice) { return names(read_inputs(dataset, choice)); };
  EXPECT_THAT(chosen(ItemChoice(std::vector<std::string>{"a, b"})), ElementsAre("a, b"));
  EXPECT_THAT(chosen(ItemChoice(std::vector<std::string>{" c", "1"})), ElementsAre("1", " c"));
  EXPECT_THROW(chosen("a, b"), ConfigError);
  EXPECT_THROW(chosen(ItemChoice(std::vector<std::string>{"1-3"})), UnknownNameError);
  EXPECT_THAT([&] { chosen(ItemChoice(std::vector<std::string>(1000, "x"))); },
              Refuses<UnknownNameError>("items x, x, x, x, x and 995 more: the data set has no item 'x'"));
  EXPECT_THROW(chosen(ItemChoice(std::vector<std::string>{})), ConfigError);
}

// A list of a million shapes takes a gigabyte.
TEST(Inputs, TheListOfTheDataSetIsInMemoryOnce) {
  Dataset dataset;
  for (const char* name : {"1", "2"})
    dataset.items.push_back(
        {.name = name, .file = fmt::format("/a/path/too/long/for/a/short/string/{}.off", name)});
  const auto place = [](const Item& item) { return item.file.data(); };
  const char* const first = place(dataset.items[0]);
  const char* const second = place(dataset.items[1]);
  const Inputs inputs = read_inputs(std::move(dataset), "1", {}, {}, Others::simulated);
  const std::vector<Family>& families = inputs.units.families();
  ASSERT_EQ(families.size(), 2U);
  EXPECT_EQ(place(item_of(families[0].source)), first);
  EXPECT_EQ(place(item_of(families[1].source)), second);
  const Project project = make_project({}, inputs);
  EXPECT_EQ(&project.units.families(), &families);
}

TEST(Inputs, NamesWhatASelectionDoesNotFind) {
  const TemporaryFolder folder;
  const Dataset dataset = numbered(folder);
  for (const char* bad : {"3", "20-30", "9-2", "horse", "1-x", ","})
    EXPECT_THROW(read_inputs(dataset, bad), ConfigError) << bad;
}

TEST(Inputs, DigestsContentNotPaths) {
  const TemporaryFolder a, b;
  const Inputs first = read_inputs(numbered(a)), second = read_inputs(numbered(b));
  const auto digest = [](const Inputs& inputs, std::size_t i) {
    return inputs.shape_files->at(i)[0].digest();
  };
  EXPECT_EQ(digest(first, 0), digest(second, 0));
  EXPECT_NE(digest(first, 0), digest(first, 1));
}

TEST(Inputs, AnUnreadableFileIsKeptForItsItem) {
  Dataset dataset;
  dataset.items.push_back({.name = "gone", .file = "/no/such/mesh.off"});
  const Inputs inputs = read_inputs(dataset);
  File& file = inputs.shape_files->at(0)[0];
  EXPECT_FALSE(file.digest());
  EXPECT_THAT([&] { file.read(); }, Refuses("/no/such/mesh.off"));
}

}  // namespace
}  // namespace salbench
