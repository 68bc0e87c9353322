// SPDX-License-Identifier: GPL-3.0-or-later
// Artefacts are plain HDF5 files: another program reads them without a line of ours.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/e2e/workspace.h"
#include "tests/support/job_counts.h"

namespace salbench {
namespace {

TEST(Artefact, PythonReadsWhatARunLeaves) {
  const Workspace toy;
  ASSERT_EQ(toy.salbench("run").status, 0);
  const Outcome read = run_process(
      {kPython, SALBENCH_READ_ARTEFACT, toy.cache().string(), (toy.out() / "results.csv").string()});
  ASSERT_EQ(read.status, 0) << read.err;
  EXPECT_EQ(read.out, fmt::format("ok: {} artefacts, {} of them scores\n", toy.artefacts().size(),
                                  JobCounts().of_kind("scores")));
}

}  // namespace
}  // namespace salbench
