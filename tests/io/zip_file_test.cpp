// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/zip_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/file.h"
#include "stages/core/errors.h"
#include "tests/support/temporary_folder.h"

namespace salbench {
namespace {

using testing::HasSubstr;
using testing::SizeIs;
using testing::StartsWith;
using testing::ThrowsMessage;

constexpr ZipLimits kLimits = {.entries = 4, .bytes = 1000};

class ZipFile : public testing::Test {
 protected:
  std::vector<ZipEntry> read(std::string_view bytes, const ZipLimits& limits = kLimits) const {
    return read_zip(folder_.write("a.zip", bytes), limits);
  }
  void expect_refusal(std::string_view bytes, const std::string& said,
                      const ZipLimits& limits = kLimits) const {
    EXPECT_THAT([&] { read(bytes, limits); }, ThrowsMessage<InputError>(HasSubstr(said))) << said;
  }

  TemporaryFolder folder_;
};

const std::vector<ZipEntry> kTwo = {{"card.yaml", "name: A\n"}, {"maps/1.npy", std::string("\0\1\2", 3)}};

// The same bytes in another place, of the directory at the end too.
std::string replaced(std::string text, std::string_view what, std::string_view by) {
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size()))
    text.replace(at, what.size(), by);
  return text;
}

TEST_F(ZipFile, ComesBackAsItWasWritten) {
  const std::string bytes = zip_of(kTwo);
  EXPECT_EQ(bytes, zip_of(kTwo));
  const auto entries = read(bytes);
  ASSERT_THAT(entries, SizeIs(2));
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(entries[i].name, kTwo[i].name);
    EXPECT_EQ(entries[i].bytes, kTwo[i].bytes);
  }
  EXPECT_THAT(read(zip_of({{"empty", ""}})), SizeIs(1));
}

TEST_F(ZipFile, NamesThatLeaveTheFolderAreRefused) {
  for (const char* name : {"/etc/passwd", "../out", "a/../../b", "a//b", "./a", "C:\\x", "a\\b"})
    expect_refusal(zip_of({{name, "x"}}), "the entry ");
  expect_refusal(replaced(zip_of({{"a?b", "x"}}), "a?b", "a\nb"), "has a character in its name");
}

TEST_F(ZipFile, ReasonsGoWithoutTheNameOfTheFile) {
  const auto reason = [&](const auto& call) -> std::string {
    try {
      call();
    } catch (const FileError& error) {
      EXPECT_EQ(error.what(), (folder_.path() / "a.zip").string() + ": " + error.reason);
      return error.reason;
    }
    return {};
  };
  EXPECT_THAT(reason([&] { read("no archive, but as long as one"); }), StartsWith("cannot be read as a ZIP"));
  EXPECT_THAT(reason([&] { read(std::string((1U << 20U) + 2000, 'x')); }), HasSubstr("can be read"));
  std::filesystem::remove(folder_.path() / "a.zip");
  EXPECT_THAT(reason([&] { read_zip(folder_.path() / "a.zip", kLimits); }), StartsWith("cannot be read: "));
}

TEST_F(ZipFile, MoreThanExpectedIsRefused) {
  expect_refusal(zip_of({{"a", ""}, {"b", ""}, {"c", ""}, {"d", ""}, {"e", ""}}),
                 "has 5 entries, expected at most 4");
  expect_refusal(zip_of({{"a", std::string(600, 'x')}, {"b", std::string(600, 'x')}}),
                 "unpacks to more than 1000");
  expect_refusal(std::string((1U << 20U) + 2000, 'x'), "can be read");
}

TEST_F(ZipFile, ATwinIsRefused) {
  expect_refusal(replaced(zip_of({{"maps/1", "x"}, {"maps/2", "y"}}), "maps/2", "maps/1"), "a.zip: ");
}

TEST_F(ZipFile, DamageAtEveryByteAndLengthIsARefusalOrNoDamage) {
  const std::string sound = zip_of({{"a", "0123456789"}});
  std::size_t refused = 0;
  for (std::size_t i = 0; i < sound.size(); ++i) {
    std::string bad = sound;
    bad[i] = static_cast<char>(bad[i] ^ 0x55);
    try {
      const auto entries = read(bad);
      if (!entries.empty()) {
        EXPECT_EQ(entries[0].bytes, "0123456789") << i;
      }
    } catch (const InputError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, sound.size() / 2);
  for (std::size_t length = 0; length < sound.size(); ++length)
    expect_refusal(std::string_view(sound).substr(0, length), "a.zip: ");
}

// Bits of the entry's flags, here and in the directory: encrypted.
TEST_F(ZipFile, AnEncryptedEntryAndALinkAreRefused) {
  std::string encrypted = zip_of({{"a", std::string(100, 'x')}});
  const std::size_t directory = encrypted.find("PK\1\2");
  encrypted[6] |= 1;
  encrypted[directory + 8] |= 1;
  encrypted[22] = encrypted[directory + 24] =
      88;  // unpacked: without the 12 bytes that encryption puts before
  expect_refusal(encrypted, "is encrypted");
  std::string link = zip_of({{"a", "x"}});
  link[link.find("PK\1\2") + 41] = static_cast<char>(0xa1);  // S_IFLNK in the high byte of the attributes
  expect_refusal(link, "is a link or a device");
}

}  // namespace
}  // namespace salbench
