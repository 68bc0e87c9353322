// SPDX-License-Identifier: GPL-3.0-or-later
// costs.csv: what maps took when they were computed, whichever run says it.
#include "pipeline/results/costs.h"

#include <cmath>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/file.h"
#include "tests/e2e/commands.h"
#include "tests/e2e/workspace.h"
#include "tests/support/text_column.h"

namespace salbench {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::Gt;
using testing::HasSubstr;
using testing::IsNan;

std::string costs_of(const Workspace& toy) { return read_file(toy.out() / "costs.csv"); }

std::vector<std::string> names_in(const Table& table, const std::string& model) {
  std::vector<std::string> names;
  for (const char* column : {"dataset", "item", "view", "model"}) {
    const std::vector<std::string> cells = text_column(table, column);
    names.resize(cells.size());
    for (std::size_t row = 0; row < cells.size(); ++row) names[row] += cells[row] + ",";
  }
  std::erase_if(names, [&](const std::string& name) { return !name.ends_with("," + model + ","); });
  return names;
}

TEST(Costs, AreThoseOfTheTimeWhenTheMapsWereComputed) {
  const Workspace toy("models: {PS: , RS: , HS: }\n");
  ASSERT_EQ(toy.salbench("run").status, 0);
  const std::string costs = costs_of(toy);
  const Table table = parse_csv(costs, "costs.csv"), results = read_csv(toy.out() / "results.csv");
  EXPECT_THAT(table.columns, ElementsAre("dataset", "item", "view", "model", "seconds", "processor_seconds",
                                         "input_seconds"));
  for (const char* model : {"PS", "RS"}) EXPECT_EQ(names_in(table, model), names_in(results, model));
  EXPECT_THAT(names_in(table, "HS"), testing::IsEmpty());
  for (const char* column : {"seconds", "processor_seconds", "input_seconds"})
    EXPECT_THAT(number_column(table, column), Each(Gt(0))) << column;

  const Outcome again = toy.salbench("run");
  EXPECT_THAT(again.out, HasSubstr("; 0 artefacts computed"));
  EXPECT_EQ(costs_of(toy), costs);
  // A part, by a configuration with another model beside: the rows are the same.
  toy.configure("models: {RS: , MS: , PS: }\n");
  ASSERT_EQ(toy.salbench("run", {"--items", "1"}).status, 0);
  const std::string part = costs_of(toy);
  for (const std::string& line : lines_with(costs, "s,1,")) EXPECT_THAT(part, HasSubstr(line + "\n"));
  EXPECT_THAT(lines_with(part, "s,2,"), testing::IsEmpty());
}

TEST(Costs, OfCommandsHaveNoProcessorTimeAndGivenMapsHaveNone) {
  const Workspace toy(
      fmt::format("dataset: {{scans: false}}\nmodels:\n  RS:\n  MINE:\n    command: \"{}\"\n", kCount));
  ASSERT_EQ(toy.salbench("export", {"--to", (toy / "maps").string(), "--format", "maps"}).status, 0);
  const Outcome run = toy.salbench("run", {"--maps", (toy / "maps/RS").string(), "--name", "OWN"});
  ASSERT_EQ(run.status, 0) << run.err;
  const Table table = read_csv(toy.out() / "costs.csv");
  EXPECT_THAT(text_column(table, "model"), ElementsAre("RS", "MINE", "RS", "MINE"));
  EXPECT_THAT(number_column(table, "seconds"), Each(Gt(0)));
  EXPECT_THAT(number_column(table, "processor_seconds"), ElementsAre(Gt(0), IsNan(), Gt(0), IsNan()));
}

}  // namespace
}  // namespace salbench
