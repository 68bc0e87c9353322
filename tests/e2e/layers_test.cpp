// SPDX-License-Identifier: GPL-3.0-or-later
// The test `layers` looks at the tree itself; this one sees that it would find a breach.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/e2e/process.h"

namespace salbench {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

class Layers : public testing::Test {
 protected:
  void SetUp() override {
    tree_.write("stages/core/types.h", "#include <vector>\n");
    tree_.write("stages/fpfh/fpfh.cpp", "#include \"stages/core/types.h\"\n");
    tree_.write("stages/core/embree.cpp", "#include <embree4/rtcore.h>\n#include <embree3/rtcore.h>\n");
    tree_.write("stages/scan/scan.cpp",
                "#include \"stages/scan/scan.h\"\n#include \"stages/core/embree.h\"\n");
    tree_.write("io/shapes/off.cpp", "#include \"stages/core/types.h\"\n");
    tree_.write("cache/key.cpp", "#include \"io/arrays.h\"\n");
    tree_.write("pipeline/engine/graph.cpp", "#include <tbb/flow_graph.h>\n#include \"cache/key.h\"\n");
  }
  Outcome check() const { return run_process({SALBENCH_LAYERS, tree_.path().string()}); }
  void expect_breach(const std::string& path, const std::string& text, const std::string& said) const {
    const std::filesystem::path file = tree_.write(path, text);
    const Outcome outcome = check();
    EXPECT_EQ(outcome.status, 1) << path;
    EXPECT_THAT(outcome.out, HasSubstr(said));
    std::filesystem::remove(file);
  }

  TemporaryFolder tree_;
};

TEST_F(Layers, AnOrderlyTreePasses) {
  const Outcome outcome = check();
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.out + outcome.err, IsEmpty());
}

TEST_F(Layers, EveryKindOfBreachIsNamed) {
  expect_breach("stages/fpfh/a.cpp", "\n#include \"io/shapes/off.h\"\n",
                "stages/fpfh/a.cpp:2: includes io/shapes/off.h");
  expect_breach("stages/fpfh/a.h", "#include \"stages/scan/scan.h\"\n",
                "stages/fpfh/a.h:1: includes stages/scan");
  expect_breach("stages/core/a.h", "#include \"stages/fpfh/fpfh.h\"\n", "stages/core may include");
  expect_breach("io/a.h", "#include \"stages/fpfh/fpfh.h\"\n", "io may include");
  expect_breach("io/a.h", "#include \"cache/key.h\"\n", "io may include");
  expect_breach("cache/a.h", "#include \"pipeline/engine/plan.h\"\n", "cache may include");
  expect_breach("pipeline/rules/a.h", "#include \"tests/support/shapes.h\"\n", "pipeline/rules may include");
  expect_breach("pipeline/config/a.h", "#include \"pipeline/rules/rules.h\"\n",
                "pipeline/config may include");
  expect_breach("pipeline/engine/a.h", "#include \"pipeline/rules/rules.h\"\n",
                "pipeline/engine may include");
  expect_breach("pipeline/engine/a.h", "#include \"stages/core/types.h\"\n", "know nothing of shapes");
  expect_breach("tests/engine/a_test.cpp", "#include \"io/hdf5/value.h\"\n", "know nothing of shapes");
  expect_breach("pipeline/inputs/a.h", "#include \"pipeline/rules/rules.h\"\n",
                "pipeline/inputs may include");
  expect_breach("pipeline/rules/a.h", "#include \"pipeline/results/results.h\"\n",
                "pipeline/rules may include");
  expect_breach("pipeline/results/a.h", "#include \"pipeline/commands/run.h\"\n",
                "pipeline/results may include");
  expect_breach("pipeline/a.h", "#include \"io/table.h\"\n", "pipeline has rooms");
  expect_breach("pipeline/inputs/a.cpp", "#include <tbb/flow_graph.h>\n",
                "the flow graph is already included by");
  expect_breach("stages/scan/a.h", "#include <embree3/rtcore.h>\n", "Embree belongs in a .cpp");
  expect_breach("stages/scan/a.cpp", "#include <embree4/rtcore.h>\n",
                "already included by stages/core/embree.cpp");
  expect_breach("pipeline/config/a.h", "#include <yaml-cpp/yaml.h>\n",
                "belongs in a .cpp of pipeline/config");
  expect_breach("pipeline/inputs/a.cpp", "#include <yaml-cpp/yaml.h>\n",
                "belongs in a .cpp of pipeline/config");
}

}  // namespace
}  // namespace salbench
