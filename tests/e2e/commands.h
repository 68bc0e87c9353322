// SPDX-License-Identifier: GPL-3.0-or-later
// Models that are commands, in the configuration of a toy, and what their runs leave.
#pragma once

#include <filesystem>
#include <ostream>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/file.h"
#include "tests/e2e/workspace.h"

namespace salbench {

inline std::string command_config(const std::string& options, const std::string& others = "PS: , ") {
  return "dataset: {scans: false}\nmodels: {" + others + "MINE: {" + options + "}}\n";
}

// Writes the number of each point's line: a saliency that any command can make.
inline constexpr const char* kCount =
    R"(n=$(grep -a -m1 'element vertex' {mesh} | cut -d' ' -f3); seq $n > {out})";

inline std::size_t lines_of(const std::filesystem::path& file) {
  return std::filesystem::exists(file) ? lines_with(read_file(file), "run").size() : 0;
}

inline std::vector<std::vector<std::string>> cells_of(const std::string& csv, const std::string& model) {
  std::vector<std::vector<std::string>> rows;
  for (const std::string& line : lines_with(csv, "," + model + ",")) {
    std::vector<std::string>& cells = rows.emplace_back();
    std::istringstream stream(line);
    for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
  }
  return rows;
}

// With one short line that says why; the other items go on.
inline void expect_first_alone_to_fail(const Workspace& toy, const Outcome& run, const std::string& says) {
  EXPECT_EQ(run.status, 1) << run.err;
  const auto lines = lines_with(run.err, "error: 1: map.MINE: ");
  ASSERT_THAT(lines, testing::SizeIs(1)) << run.err;
  EXPECT_THAT(lines[0], testing::ContainsRegex(says));
  EXPECT_LT(lines[0].size(), 6000U);
  EXPECT_THAT(cells_of(toy.results(), "MINE"), testing::SizeIs(1));
  EXPECT_THAT(lines_with(toy.results(), ",PS,"), testing::SizeIs(3));
}

struct Hostile {
  const char* name;
  const char* command;
  const char* says;   // a regular expression
  int timeout = 600;  // seconds; where it is to pass as few as a sound command never needs
};

inline void PrintTo(const Hostile& param, std::ostream* out) { *out << param.name; }

}  // namespace salbench
