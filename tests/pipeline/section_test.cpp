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
    root.words("names");
    Sample sample;
    root.child("sample").read(sample);
    root.reject_unknown({"names", "sample"});
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

TEST(Section, ReadsTheSwitchesOfYaml11) {
  for (const char* yes : {"true", "True", "TRUE", "yes", "on"})
    for (const char* no : {"false", "False", "FALSE", "no", "off"}) {
      Sample sample;
      Section::from_text(fmt::format("flag: {}", yes), "x").read(sample);
      EXPECT_EQ(key_text(sample).substr(0, 11), "flag: true\n") << yes;
      Section::from_text(fmt::format("flag: {}", no), "x").read(sample);
      EXPECT_EQ(key_text(sample).substr(0, 12), "flag: false\n") << no;
    }
}

TEST(Section, ReadsAListOfNamesAsEmptySections) {
  for (const char* yaml : {"names: [a, b]", "names:\n- a\n- b", "names: {a: , b: }"}) {
    const Section names = Section::from_text(yaml, "x").child_or_names("names");
    EXPECT_THAT(names.keys(), ElementsAre("a", "b")) << yaml;
    EXPECT_TRUE(names.child("b").keys().empty()) << yaml;
  }
  for (const char* yaml : {"names: [a, a]", "names: [a, {b: 1}]"})
    EXPECT_THAT([&] { Section::from_text(yaml, "x.yaml").child_or_names("names"); },
                Refuses<ConfigError>("x.yaml:1"))
        << yaml;
}

TEST(Section, LinesOfDashesThatBeginNoSecondDocumentChangeNothing) {
  for (const char* yaml : {"---\na: 1", "a: 1\n---\n", "%YAML 1.2\n---\na: 1\n...\n"})
    EXPECT_EQ(Section::from_text(yaml, "x").text("a"), "1") << yaml;
  EXPECT_TRUE(Section::from_text("", "x").keys().empty());
  EXPECT_TRUE(Section::from_text("---\n", "x").keys().empty());
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
        Slip{"sample: {count: [1]}", "x.yaml:1: sample.count must"},
        Slip{"a: [1\nb: 2", "not valid YAML"},
        Slip{"sample:\n\tcount: 1", "a tab is no indentation"},
        Slip{"sample:\n  count: 1\n---\nnames: [a]", "x.yaml:4: belongs to a second document"},
        Slip{"---\n---\nnames: [a]", "x.yaml:3: belongs to a second document"},
        Slip{"{\"names\": [a]},", "x.yaml:1: not valid YAML: a comma outside of brackets"},
        Slip{"\n, names: [a]", "x.yaml:2: not valid YAML: a comma outside of brackets"},
        Slip{"sample: {\"a\\nb\": 1}", "x.yaml:1: sample.a?b is not a known key"},
        Slip{"sample: {count: \"1\\n2\"}", "sample.count is '1?2'"},
        Slip{"{\"\\a\": 1, \"\\a\": 2}", "the key '?'"},
        Slip{"sample: \"\\\x01\"", "x.yaml:1: not valid YAML: unknown escape character: ?"}})
    EXPECT_THAT(error_of(yaml), HasSubstr(named)) << yaml;
}

TEST(Section, AnErrorKnowsWhatIsWrongWithoutItsPlace) {
  Sample sample;
  EXPECT_THAT(
      [&] { Section::from_text("radios: 1", "x.yaml").read(sample); },
      testing::Throws<SectionError>(testing::Field(&SectionError::what_is_wrong, StartsWith("radios "))));
}

TEST(DidYouMean, LooksPastTheCaseAndNotAtOtherWords) {
  const std::vector<std::string_view> known = {"auc", "nss", "LS", "CS", "VIS"};
  EXPECT_EQ(did_you_mean("AUC", known), "did you mean 'auc'?");
  EXPECT_EQ(did_you_mean("acu", known), "did you mean 'auc'?");
  EXPECT_EQ(did_you_mean("ls", known), "did you mean 'LS'?");
  EXPECT_EQ(did_you_mean("SL", known), "did you mean 'LS'?");
  EXPECT_EQ(did_you_mean("Cs", {"CS", "cs"}), "did you mean 'CS'?");
  for (const char* word : {"XX", "X", "", "mse", "zzzzzzzz"})
    EXPECT_EQ(did_you_mean(word, known, "none"), "none");
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

// Anything that requires more time, memory or stack than a configuration can need ends in a readable line.
TEST(Section, Bombs) {
  const std::string lists = multiplied("[x, x]", "[", "*a{1}, ", "]");
  const std::string mappings = multiplied("{LS: }", "{", "k{0}: *a{1}, ", "}");
  std::string many_keys = "sample:\n";
  for (int i = 0; i < 60'000; ++i) many_keys += fmt::format("  k{}: 1\n", i);
  struct Bomb {
    const char* name;
    std::string yaml, said;
  };
  for (const Bomb& bomb :
       {Bomb{"lists of aliases", lists + "names: *a29\n", "x.yaml:31: names "},
        Bomb{"mappings of aliases", mappings + "sample: *a29\n", "sample.k0 is not a known key"},
        Bomb{"a list in itself", "names: &n [cc, *n]\n", "x.yaml:1: names "},
        Bomb{"all in itself", "&r {sample: *r}\n", "sample.sample is not a known key"},
        Bomb{"brackets", "names: " + std::string(500'000, '['), "x.yaml:1: 500 levels"},
        Bomb{"few brackets", "names: " + std::string(400, '[') + std::string(400, ']'), "x.yaml:1: names "},
        Bomb{"a large scalar", "sample: {method: " + std::string(1U << 20U, 'x') + "}\n",
             "x.yaml:1: more than the 1048576 bytes"},
        Bomb{"a long number", "sample: {count: " + std::string(1'000'000, '9') + "}\n", "...9"},
        Bomb{"a long key", "? " + std::string(1'000'000, 'k') + "\n: 1\n", "is not a known key; known are: "},
        Bomb{"many keys", many_keys, "x.yaml:2: sample.k0 is not a known key"}}) {
    SCOPED_TRACE(bomb.name);
    const std::string said = error_of(bomb.yaml);
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
  std::string remarks;
  for (int i = 0; i < 20; ++i)
    remarks += fmt::format("  - {{item: {}, remark: \"{}\"}}\n", i, std::string(60'000, 'x'));
  for (const char* head : {"", "# SIMULATED\n"}) {
    const auto path =
        folder.write("run.yaml", head + std::string("program: salbench 1.1.0\nremarks:\n") + remarks);
    EXPECT_EQ(Section::from_file(path.string()).list("remarks").size(), 20U);
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
