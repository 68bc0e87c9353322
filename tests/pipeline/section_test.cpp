// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/config/section.h"

#include <fmt/format.h>

#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

enum class Method { faces, pca };

struct Sample {
  bool flag = false;
  std::int32_t count = 9;
  double radius = 0.01;
  Method method = Method::faces;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("flag", self.flag, {"a switch"});
    visit("count", self.count, {"how many", "points"});
    visit("radius", self.radius, {"how far", "R", above(0)});
    visit("method", self.method, {"how"});
  }
  static Sample text() { return {.flag = true}; }
};
void check(const Sample& sample) {
  check_ranges(sample);
  if (sample.flag && sample.count == 0) throw OptionError("count", "must not be 0 where flag is true");
}

std::string error_of(const std::string& yaml) {
  try {
    const Section root = Section::from_text(yaml, "x.yaml");
    Sample sample;
    root.child("sample").read(sample);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace

template <>
struct EnumNames<Method> {
  static constexpr std::array<std::string_view, 2> names{"faces", "pca"};
};

namespace {

TEST(Section, OverwritesWhatItNamesAndKeepsTheRest) {
  Sample sample;
  Section::from_text("flag: true\nmethod: pca\nradius: 2.5e-1", "x").read(sample);
  EXPECT_TRUE(sample.flag);
  EXPECT_EQ(sample.method, Method::pca);
  EXPECT_EQ(sample.radius, 0.25);
  EXPECT_EQ(sample.count, 9);
}

TEST(Section, AnEmptySectionIsAllDefaults) {
  Sample sample;
  const Section root = Section::from_text("sample:\n", "x");
  root.child("sample").read(sample);
  root.child("absent").read(sample);
  EXPECT_EQ(sample.count, 9);
}

TEST(Section, ErrorsNameFileLineKeyAndTheNearestValidKeyOnOneLine) {
  struct Slip {
    const char *yaml, *named;
  };
  for (const auto& [yaml, named] :
       {Slip{"# c\nsample:\n  radios: 1",
             "x.yaml:3: sample.radios is not a known key; did you mean 'radius'?"},
        Slip{"sample: {zzzzzzzz: 1}", "known are: flag, count, radius, method"},
        Slip{"sample:\n  count: many", "x.yaml:2: sample.count is 'many'"},
        Slip{"sample:\n  count: 9.5", "x.yaml:2: sample.count is '9.5'"},
        Slip{"sample:\n  method: face", "x.yaml:2: sample.method is 'face', not one of faces, pca"},
        Slip{"sample:\n\n  radius: -1", "x.yaml:3: sample.radius must be a number above 0"},
        Slip{"sample:\n  radius: nan", "x.yaml:2: sample.radius is 'nan'"},
        Slip{"sample: {flag: true, count: 0}", "x.yaml:1: sample.count must not be 0"},
        Slip{"sample:\n  flag: true\n  flag: false", "x.yaml:3: the key 'flag'"},
        Slip{"sample: 3", "x.yaml:1: sample must"},
        Slip{"sample: {count: [1]}", "x.yaml:1: sample.count must"}, Slip{"a: [1\nb: 2", "not valid YAML"},
        Slip{"sample: {\"a\\nb\": 1}", "x.yaml:1: sample.a?b is not a known key"},
        Slip{"sample: {count: \"1\\n2\"}", "sample.count is '1?2'"},
        Slip{"{\"\\a\": 1, \"\\a\": 2}", "the key '?'"},
        Slip{"sample: \"\\\x01\"", "x.yaml:1: not valid YAML: unknown escape character: ?"}})
    EXPECT_THAT(error_of(yaml), HasSubstr(named)) << yaml;
}

TEST(Section, AnErrorKnowsWhatIsWrongWithoutItsPlace) {
  try {
    Sample sample;
    Section::from_text("sample:\n  radios: 1", "x.yaml").child("sample").read(sample);
    FAIL();
  } catch (const SectionError& error) {
    EXPECT_EQ(error.what_is_wrong, "sample.radios is not a known key; did you mean 'radius'?");
  }
}

TEST(DidYouMean, LooksPastTheCaseAndNotAtOtherWords) {
  const std::vector<std::string_view> known = {"auc", "nss", "LS", "CS", "VIS"};
  EXPECT_EQ(did_you_mean("AUC", known), "did you mean 'auc'?");
  EXPECT_EQ(did_you_mean("acu", known), "did you mean 'auc'?");
  EXPECT_EQ(did_you_mean("ls", known), "did you mean 'LS'?");
  EXPECT_EQ(did_you_mean("SL", known), "did you mean 'LS'?");
  EXPECT_EQ(did_you_mean("Cs", {"CS", "cs"}), "did you mean 'CS'?");
  for (const char* word : {"XX", "X", "", "zzzzzzzz"}) EXPECT_EQ(did_you_mean(word, known, "none"), "none");
}

// The system would cut a path there: salbench would write elsewhere, or retry forever.
TEST(Section, ANulCharacterIsRefusedWhereverItStands) {
  constexpr const char* kHasNul = "has the character U+0000";
  for (const char* yaml : {"cache: \"a\\0b\"\n", "models: {\"A\\0B\": }\n"})
    EXPECT_THAT([&] { Section::from_text(yaml, "x.yaml").child("models"); }, Refuses<ConfigError>(kHasNul))
        << yaml;
  EXPECT_THAT([] { Section::from_text("names: [a, \"b\\0c\"]\n", "x.yaml").words("names"); },
              Refuses<ConfigError>(kHasNul));
}

std::string repeated(std::string_view text, int n) {
  std::string all;
  for (int i = 0; i < n; ++i) all += text;
  return all;
}

// a0 is a leaf; each of the others consists of nine copies of the previous.
std::string multiplied(std::string_view leaf, std::string_view open, std::string_view element,
                       std::string_view close) {
  std::string yaml = fmt::format("a0: &a0 {}\n", leaf);
  for (int i = 1; i < 30; ++i) {
    yaml += fmt::format("a{}: &a{} {}", i, i, open);
    for (int j = 0; j < 9; ++j) yaml += fmt::format(fmt::runtime(element), j, i - 1);
    yaml += fmt::format("{}\n", close);
  }
  return yaml;
}

std::string wrong_with(const std::string& yaml) {
  try {
    const Section root = Section::from_text(yaml, "x.yaml");
    root.words("names");
    Sample sample;
    root.child("sample").read(sample);
    root.reject_unknown({"names", "sample"});
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "no error";
}

// Anything that requires more time, memory or stack than a configuration can need ends in a readable line.
TEST(Section, Bombs) {
  const std::string lists = multiplied("[x, x]", "[", "*a{1}, ", "]"), megabyte(1U << 20U, 'x');
  const std::string mappings = multiplied("{LS: }", "{", "k{0}: *a{1}, ", "}");
  struct Bomb {
    const char* name;
    std::string yaml, said;
  };
  for (const Bomb& bomb :
       {Bomb{"lists of aliases", lists + "names: *a29\n", "x.yaml:31: names "},
        Bomb{"mappings of aliases", mappings + "sample: *a29\n", "sample.k0 is not a known key"},
        Bomb{"a list in itself", "names: &n [cc, *n]\n", "x.yaml:1: names "},
        Bomb{"all in itself", "&r {sample: *r}\n", "sample.sample is not a known key"},
        Bomb{"brackets", "names: " + repeated("[", 500'000),
             "x.yaml:1: 500 levels of mappings and lists are too many"},
        Bomb{"brackets that close", "names: " + repeated("[", 100'000) + repeated("]", 100'000),
             "levels of mappings"},
        Bomb{"few brackets", "names: " + repeated("[", 400) + repeated("]", 400),
             "names must be a list of names"},
        Bomb{"dashes", "names:\n" + repeated("- ", 100'000) + "x\n", "x.yaml:2: 500 levels"},
        Bomb{"tags", "names: " + repeated("!!map ", 100'000) + "{}", "not valid YAML"},
        Bomb{"a large scalar", "sample: {method: " + megabyte + "}\n",
             "x.yaml:1: more than the 1048576 bytes that can be read"},
        Bomb{"a long number", "sample: {count: " + repeated("9", 1'000'000) + "}\n", "...9"},
        Bomb{"a long key", "? " + repeated("k", 1'000'000) + "\n: 1\n", "is not a known key; known are: "},
        Bomb{"many keys",
             [] {
               std::string keys = "sample:\n";
               for (int i = 0; i < 60'000; ++i) keys += fmt::format("  k{}: 1\n", i);
               return keys;
             }(),
             "x.yaml:2: sample.k0 is not a known key"},
        Bomb{"nothing but blanks", repeated(" ", 1 << 21), "x.yaml:1: more than the 1048576 bytes"}}) {
    SCOPED_TRACE(bomb.name);
    const std::string said = wrong_with(bomb.yaml);
    EXPECT_THAT(said, HasSubstr(bomb.said));
    EXPECT_LT(said.size(), 1200U);
  }
}

TEST(Section, AFileIsReadNoFurtherThanItMayBeLong) {
  const TemporaryFolder folder;
  const auto path = folder.write("x.yaml", "names: [a]\n");
  std::filesystem::resize_file(path, std::uintmax_t{1} << 40U);
  EXPECT_THAT([&] { Section::from_file(path.string()); },
              Refuses<ConfigError>("x.yaml:1: more than the 1048576 bytes"));
}

// A line for each odd shape and each failure.
TEST(Section, ARecordOfARunMayBeLong) {
  const TemporaryFolder folder;
  const std::string remarks = repeated("  - {item: 1, remark: \"has quads\"}\n", 50'000);
  for (const char* head : {"", "# SIMULATED\n"}) {
    const auto path =
        folder.write("run.yaml", head + std::string("program: salbench 1.1.0\nremarks:\n") + remarks);
    EXPECT_EQ(Section::from_file(path.string()).list("remarks").size(), 50'000U);
  }
  const auto other = folder.write("x.yaml", "# program: salbench\nremarks:\n" + remarks);
  EXPECT_THROW(Section::from_file(other.string()), ConfigError);
}

TEST(Section, AMissingFileIsAnError) { EXPECT_THROW(Section::from_file("/no/such/file.yaml"), ConfigError); }

TEST(OptionsText, ReadsBackToTheBit) {
  const Sample sample{true, 12, 0.1 + 0.2, Method::pca};
  EXPECT_EQ(options_text(sample), "flag: true\ncount: 12\nradius: 0.30000000000000004\nmethod: pca\n");
  Sample back;
  Section::from_text(options_text(sample), "x").read(back);
  EXPECT_EQ(options_text(back), options_text(sample));
}

struct Grown {
  double radius = 0.01;
  std::int32_t enough = 6;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("radius", self.radius, {"how far"});
    visit("enough", self.enough, {"how many", "points", at_least(1), "6"});
  }
};

TEST(OptionsText, AKeyLeavesOutWhatOlderKeysImply) {
  EXPECT_EQ(key_text(Grown{}), "radius: 0.01\n");
  EXPECT_EQ(key_text(Grown{.enough = 12}), "radius: 0.01\nenough: 12\n");
  EXPECT_EQ(options_text(Grown{}), "radius: 0.01\nenough: 6\n");
}

TEST(OptionsText, AnnotatedSaysMeaningUnitAndWhatIsAccepted) {
  EXPECT_EQ(options_text(Sample{}, true),
            "# a switch\nflag: false\n"
            "# how many (points)\ncount: 9\n"
            "# how far (R; > 0)\nradius: 0.01\n"
            "# how (faces, pca)\nmethod: faces\n");
}

TEST(OptionsText, ProtocolsHaveTheirPresets) {
  EXPECT_TRUE(preset<Sample>(Protocol::text).flag);
  EXPECT_FALSE(preset<Sample>(Protocol::published).flag);
}

}  // namespace
}  // namespace salbench
