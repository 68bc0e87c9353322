// SPDX-License-Identifier: GPL-3.0-or-later
#include "cache/key.h"

#include <set>

#include <gtest/gtest.h>

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

// Names that a mesh's file may have; the text of those without a line break is that of earlier versions.
TEST(Key, InputsReadBackWhateverTheyAreCalled) {
  const Digest digest{1, 2};
  Recipe recipe{"set", 1, {}, {}, {{"a: b", digest}, {"c\\n /d", digest}, {"", digest}}};
  EXPECT_EQ(inputs_text(recipe),
            "a: b: " + digest.hex() + "\nc\\n /d: " + digest.hex() + "\n: " + digest.hex() + "\n");
  for (const char* name : {"line\nbreak", "\n", "\nat the beginning", "at the end\n", "\n\n", "return\r",
                           "tab\t", "\x1b[31m", "a: 00000000000000010000000000000002\nb", "\xff"})
    recipe.inputs.emplace_back(name, digest);
  EXPECT_EQ(inputs_from_text(inputs_text(recipe)), recipe.inputs);
  EXPECT_EQ(inputs_from_text(""), decltype(Recipe::inputs){});
  for (const char* wrong : {"a", "a: 1\n", "/", "\n", "a: \n"})
    EXPECT_EQ(inputs_from_text(wrong), std::nullopt) << wrong;
}

TEST(Key, FieldsDoNotRunIntoEachOther) {
  EXPECT_NE(key_of({"ab", 1, "c", "", {}}), key_of({"a", 1, "bc", "", {}}));
}

}  // namespace
}  // namespace salbench
