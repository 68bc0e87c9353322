// SPDX-License-Identifier: GPL-3.0-or-later
#include "cache/key.h"

#include <fmt/format.h>

#include "tests/support/test.h"

namespace salbench {
namespace {

TEST(Key, EveryComponentCounts) {
  const Recipe base{"fpfh", 1, "radius: 1\n", "7/52", {{"mesh", {1, 2}}}};
  std::vector<Recipe> others(6, base);
  others[0].stage = "map.PS";
  others[1].stage_version = 2;
  others[2].options = "radius: 2\n";
  others[3].seed = "8/52";
  others[4].inputs[0].first = "scan";
  others[5].inputs[0].second = {1, 3};
  for (const Recipe& other : others) EXPECT_NE(key_of(other), key_of(base));
  EXPECT_EQ(key_of(Recipe(base)), key_of(base));
}

// Possible names of mesh files; text of names without a line break is unchanged from earlier versions.
TEST(Key, InputsAreToldApartWhateverTheyAreCalled) {
  const Digest digest{1, 2};
  const Recipe recipe{
      "set", 1, {}, {}, {{"a: b", digest}, {"c\\n /d", digest}, {"", digest}, {"line\nbreak\n", digest}}};
  EXPECT_EQ(inputs_text(recipe),
            fmt::format("a: b: {0}\nc\\n /d: {0}\n: {0}\nline\n/break\n/: {0}\n", digest.hex()));
}

TEST(Key, FieldsDoNotRunIntoEachOther) {
  EXPECT_NE(key_of({"ab", 1, "c", "", {}}), key_of({"a", 1, "bc", "", {}}));
}

}  // namespace
}  // namespace salbench
