// SPDX-License-Identifier: GPL-3.0-or-later
#include "cache/artefact_name.h"

#include <gtest/gtest.h>

namespace salbench {
namespace {

TEST(ArtefactName, ReadsBack) {
  const ArtefactName name{"52_3", {1, 2}, {3, 4}, 5, 0x1234};
  const auto back = parse_artefact_name(name.text());
  ASSERT_TRUE(back);
  EXPECT_EQ(back->item, "52_3");
  EXPECT_EQ(back->key, name.key);
  EXPECT_EQ(back->content, name.content);
  EXPECT_EQ(back->checksum, 5U);
  EXPECT_EQ(back->size, 0x1234U);
}

TEST(ArtefactName, OtherFilesAreNoArtefacts) {
  const std::string good = ArtefactName{"52", {1, 2}, {3, 4}, 5, 6}.text();
  for (const std::string& bad : {std::string("README"), std::string(".h5"), good + ".part", good.substr(3),
                                 good.substr(0, good.size() - 5) + "zz.h5", std::string("a.b.c.d.e.h5")})
    EXPECT_FALSE(parse_artefact_name(bad)) << bad;
}

TEST(ArtefactName, NoneOfItsNumbersMayBeOtherText) {
  const std::string key = Digest{1, 2}.hex(), content = Digest{3, 4}.hex();
  const auto read = [](const std::string& key_text, const std::string& content_text, const std::string& sum,
                       const std::string& size) {
    return parse_artefact_name("52." + key_text + "." + content_text + "." + sum + "." + size + ".h5");
  };
  EXPECT_TRUE(read(key, content, "5", "6"));
  EXPECT_FALSE(read("key", content, "5", "6"));
  EXPECT_FALSE(read(key, "content", "5", "6"));
  EXPECT_FALSE(read(key, content, "sum", "6"));
  EXPECT_FALSE(read(key, content, "5", "size"));
}

TEST(ArtefactName, LabelsHoldNothingThatAFileSystemMinds) {
  EXPECT_EQ(item_label("my mesh/v1.2 ü"), "my_mesh_v1_2___");
  EXPECT_EQ(item_label(std::string(200, 'x')).size(), 60U);
}

}  // namespace
}  // namespace salbench
