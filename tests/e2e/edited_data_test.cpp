// SPDX-License-Identifier: GPL-3.0-or-later
// A mesh that is edited while a run is under way, and put back: what is in the cache stays true.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/file.h"
#include "tests/e2e/workspace.h"
#include "tests/support/toy_data.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;
using testing::SizeIs;

// The run has planned with the mesh by the time it stores anything, and cannot read it before the claim on
// its family is given up.
TEST(EditedData, ResultsOfTheEditedFileAreNotTakenForThoseOfTheFormerOne) {
  const Workspace toy;
  ASSERT_EQ(toy.salbench("run").status, 0);
  const std::string results = toy.results();
  toy.forget_everything();

  const fs::path mesh = toy.data() / "Meshes/2.off";
  const std::string before = read_file(mesh);
  auto claim = toy.claim_family("2");
  Process run(toy.command("run"));
  ASSERT_TRUE(wait_until(run, [&] { return !toy.artefacts("mesh").empty(); }));
  write_file(mesh, off_text(shapes::bumpy_sphere(2, 0.1)));
  claim.reset();
  const Outcome outcome = run.wait();
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(toy.results(), results);
  EXPECT_THAT(lines_with(outcome.err, "warning: " + mesh.string() + ": changed"), SizeIs(1)) << outcome.err;

  write_file(mesh, before);
  ASSERT_EQ(toy.salbench("run").status, 0);
  EXPECT_EQ(toy.results(), results);
}

}  // namespace
}  // namespace salbench
