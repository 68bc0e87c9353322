// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/rules/config.h"

#include <fmt/format.h>

#include "stages/metrics/metrics.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

Config config_of(const std::string& yaml) { return read_config(Section::from_text(yaml, "x.yaml"), "x"); }

std::string error_of(const std::string& yaml) {
  try {
    config_of(yaml);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "no error";
}

std::vector<std::string> models_of(const std::string& yaml) {
  std::vector<std::string> names;
  for (const Model& model : config_of(yaml).models) names.push_back(model.name);
  return names;
}

TEST(Config, AnEmptyFileIsThePublishedProtocolWithThePapersModels) {
  const Config config = config_of("");
  EXPECT_EQ(config.protocol, Protocol::published);
  EXPECT_THAT(models_of(""), ElementsAre("LS", "CS", "PS", "MS", "HS", "RS"));
  EXPECT_EQ(config.fpfh.neighbours, 9);
  EXPECT_EQ(config.normals.method, MeshNormalsMethod::faces);
}

TEST(Config, OtherModelsRunWhereTheyAreNamed) {
  EXPECT_THAT(models_of("models: {VIS: , MC: {curvature: taubin}, PS: }"), ElementsAre("PS", "MC", "VIS"));
}

TEST(Config, FloorsStandForAllThatTheTableMarks) {
  std::vector<std::string> floors;
  for (const ModelRow& row : model_rows())
    if (row.about.is_floor) floors.emplace_back(row.name);
  EXPECT_THAT(floors, IsSupersetOf({"RS", "MC", "CB", "NV", "VD", "SD"}));
  EXPECT_EQ(models_of("models: {floors: }"), floors);
  EXPECT_EQ(models_of("models: {floors: {}}"), floors);
  EXPECT_THAT(models_of("models: {floors: , LS: , HS: }"), IsSupersetOf({"LS", "HS", "RS", "SD"}));
}

TEST(Config, AFloorThatIsNamedBesideTheGroupHasItsOwnOptions) {
  EXPECT_EQ(models_of("models: {NV: {radius: 0.1}, floors: }"), models_of("models: {floors: }"));
  EXPECT_THAT(config_yaml(config_of("models: {floors: , NV: {radius: 0.1}}")),
              AllOf(HasSubstr("  NV:\n    radius: 0.1\n"), Not(HasSubstr("floors"))));
}

TEST(Config, FloorsHaveNoOptions) {
  for (const char* options : {"{radius: 0.1}", "NV", "[NV]"})
    EXPECT_EQ(
        error_of(fmt::format("models: {{floors: {}}}", options)),
        "x.yaml:1: models.floors stands for several models and has no options: name one of them beside it to "
        "give it some");
  EXPECT_THAT(error_of("models: {floor: }"), HasSubstr("did you mean 'floors'?"));
  EXPECT_THAT(error_of("models: {Floors: {model: LS}}"), HasSubstr("is the name of something else"));
  EXPECT_THAT(error_of("models: {V: {model: floors}}"),
              HasSubstr("models.V.model is 'floors', not one of LS,"));
}

TEST(Config, TheTextProtocolHasThePapersWords) {
  const Config config = config_of("protocol: text\nmodels: {PS: }");
  EXPECT_EQ(config.fpfh.neighbourhood, FpfhNeighbourhood::radius);
  EXPECT_EQ(config.fpfh.weighting, FpfhWeighting::text);
  EXPECT_EQ(config.normals.method, MeshNormalsMethod::pca);
  EXPECT_EQ(config.models[0].options, "absolute: true\n");
}

TEST(Config, WritesItselfSoThatItReadsBackTheSame) {
  for (const char* yaml :
       {"", "data: 'a \"b\" \\c\u00e9'\ncache: \"two\\nlines\"\noutput: o",
        "protocol: text\nseed: 9\nmodels: {RS: , PS: {absolute: false}}\nfpfh: {radius: 0.03}",
        "metrics: all", "metrics: {splits: 9, names: [kl, nss]}", "metrics: {names: all, matching: none}",
        "metrics: {names: [kl, nss], matching: {kl: histogram}}"}) {
    const std::string written = config_yaml(config_of(yaml));
    EXPECT_EQ(config_yaml(config_of(written)), written);
  }
}

TEST(Config, AnnotatedReadsBackTheSame) {
  for (const char* yaml : {"", "protocol: text", "models: {CS: , HS: {draws: 5}}",
                           "protocol: text\ndata: 'a # b'\nmodels: {RS: , PS: {absolute: false}}\n"
                           "fpfh: {radius: 0.03}"}) {
    const Config config = config_of(yaml);
    const Config back = config_of(annotated_config_yaml(config));
    EXPECT_EQ(config_yaml(back), config_yaml(config)) << yaml;
    EXPECT_EQ(annotated_config_yaml(back), annotated_config_yaml(config)) << yaml;
  }
}

TEST(Config, AnnotatedExplainsEveryOption) {
  std::istringstream yaml(annotated_config_yaml(config_of("")));
  std::string line, above;
  for (; std::getline(yaml, line); above = line) {
    EXPECT_LE(line.size(), 120U) << line;
    const std::string text = line.substr(std::min(line.find_first_not_of(' '), line.size()));
    if (text.empty() || text.starts_with('#') || text.ends_with(':')) continue;
    EXPECT_THAT(above, HasSubstr("# ")) << line;
  }
  EXPECT_THAT(annotated_config_yaml(config_of("")),
              HasSubstr("  # support radius (R; > 0)\n  radius: 0.01\n"));
}

TEST(Config, MetricsAreNamedInAnyOrderAndAlone) {
  const auto names = [](const std::string& yaml) { return config_of(yaml).metrics.names; };
  const std::vector<std::string> papers = {"auc", "auc_exact", "nss", "cc", "lcc"};
  EXPECT_EQ(names(""), papers);
  EXPECT_EQ(names("metrics: {splits: 7}"), papers);
  EXPECT_EQ(names("metrics:"), papers);
  EXPECT_EQ(names("metrics: [kl, nss, kl]"), (std::vector<std::string>{"nss", "kl"}));
  EXPECT_EQ(names("metrics: {names: [kl, nss], splits: 7}"), (std::vector<std::string>{"nss", "kl"}));
  EXPECT_EQ(names("metrics: sim"), std::vector<std::string>{"sim"});
  EXPECT_EQ(names("metrics: all").size(), metric_table().size());
  EXPECT_EQ(names("metrics: [nss, all]").size(), metric_table().size());
  EXPECT_EQ(config_of("metrics: {names: [kl], splits: 7}").metrics.splits, 7);
}

// run.yaml lists only differences from the defaults.
TEST(Config, MatchingIsForAllMetricsOrByName) {
  const auto matching = [](const std::string& yaml) {
    return option_text(config_of("metrics: {names: [nss, kl, sim], " + yaml + "}").metrics.matching);
  };
  EXPECT_EQ(matching(""), "{}");
  EXPECT_EQ(matching("matching:"), "{}");
  EXPECT_EQ(matching("matching: histogram"), "{kl: histogram, sim: histogram}");
  EXPECT_EQ(matching("matching: none"), "{nss: none}");
  EXPECT_EQ(matching("matching: {kl: histogram, nss: histogram}"), "{kl: histogram}");
  EXPECT_EQ(matching("matching: {all: none, kl: histogram}"), "{kl: histogram, nss: none}");
  EXPECT_EQ(matching("matching: {cc: none}"), "{}") << "not chosen";
  EXPECT_EQ(config_of("metrics: {matching: histogram}").metrics.matching.size(), 0U) << "the paper's";
}

TEST(Config, UnknownMatchingsAreErrors) {
  EXPECT_EQ(error_of("metrics: {matching: histogramm}"),
            "x.yaml:1: metrics.matching is 'histogramm', not one of none, histogram, raw, shifted");
  EXPECT_EQ(error_of("metrics:\n  matching:\n    kl: no"),
            "x.yaml:3: metrics.matching.kl is 'no', not one of none, histogram, raw, shifted");
  EXPECT_EQ(error_of("metrics:\n  matching: {klx: none}"),
            "x.yaml:2: metrics.matching has no metric 'klx'; did you mean 'kl'?");
  EXPECT_THAT(error_of("metrics: {matching: [kl]}"), HasSubstr("must be one value"));
  EXPECT_THAT(error_of("metrics: {matchin: none}"), HasSubstr("did you mean 'matching'?"));
}

TEST(Config, UnknownMetricsAreErrorsWithTheNearestName) {
  EXPECT_EQ(error_of("seed: 1\nmetrics: [nss, auc_jud]"),
            "x.yaml:2: metrics has no metric 'auc_jud'; did you mean 'auc_judd'?");
  EXPECT_EQ(error_of("metrics:\n  names: [klx]"),
            "x.yaml:2: metrics.names has no metric 'klx'; did you mean 'kl'?");
  EXPECT_THAT(error_of("metrics: [a_very_long_name_of_nothing]"),
              HasSubstr("docs/metrics.md has a table of them"));
  EXPECT_THAT(error_of("metrics: []"), HasSubstr("names no metric"));
  EXPECT_THAT(error_of("metrics: [cc, kl]\nstatistics: {leading: auc}"),
              HasSubstr("statistics.leading is none of the metrics: cc, kl"));
  EXPECT_EQ(config_of("metrics: [cc, kl]\nstatistics: {leading: kl}").statistics.leading, "kl");
  EXPECT_THAT(error_of("metrics: [[nss]]"), HasSubstr("must be a list of names"));
  EXPECT_THAT(error_of("metrics: {names: {nss: 1}}"), HasSubstr("must be a list of names"));
  EXPECT_THAT(error_of("metrics: {name: nss}"), HasSubstr("did you mean 'names'?"));
}

TEST(Config, UnknownKeysAndModelsAreErrorsWithTheNearestName) {
  EXPECT_EQ(error_of("protocol: published\nsed: 1"),
            "x.yaml:2: sed is not a known key; did you mean 'seed'?");
  EXPECT_THAT(error_of("models: {XS: }"),
              AllOf(HasSubstr("models.XS is not a known model"), HasSubstr("did you mean")));
  EXPECT_THAT(error_of("models:\n  PS: {absolut: true}"),
              HasSubstr("x.yaml:2: models.PS.absolut is not a known key"));
  EXPECT_THAT(error_of("protocol: txt"), HasSubstr("not one of published, text"));
  EXPECT_THAT(error_of("models: {}"), HasSubstr("names no model"));
  EXPECT_THAT(error_of("fpfh: {radius: -1}"), HasSubstr("fpfh.radius must be"));
  EXPECT_THAT(error_of("dataset: {meshes: false, scans: false}"), HasSubstr("dataset.scans"));
}

TEST(Config, AllErrorsAreSaidAtOnceInTheOrderOfTheFile) {
  EXPECT_EQ(
      error_of("sed: 1\n"
               "protocol: txt\n"
               "fpfh: {radius: -1, neighbours: x, radios: 2}\n"
               "metrics: {names: [nss, klx, cx], splits: 0}\n"
               "models:\n"
               "  XS: {}\n"
               "  PS: {absolut: true}\n"
               "  LS: {foci_sigma: x}\n"
               "  LS-2: {model: LS, foci_share: -1}\n"
               "  MINE: {command: 'x', timeout: 0}\n"
               "  YOURS: {command: 'x {mesh} {out}', reads: [colour]}\n"
               "scan: 3\n"
               "dataset: {scans: maybe, layuot: x}\n"),
      "x.yaml:1: sed is not a known key; did you mean 'seed'?\n"
      "x.yaml:2: protocol is 'txt', not one of published, text\n"
      "x.yaml:3: fpfh.neighbours is 'x', not a whole number\n"
      "x.yaml:3: fpfh.radios is not a known key; did you mean 'radius'?\n"
      "x.yaml:3: fpfh.radius must be a number above 0, not -1\n"
      "x.yaml:4: metrics.names has no metric 'cx'; did you mean 'cc'?\n"
      "x.yaml:4: metrics.names has no metric 'klx'; did you mean 'kl'?\n"
      "x.yaml:4: metrics.splits must be at least 1, not 0\n"
      "x.yaml:6: models.XS is not a known model, nor has it a command ({command: ...}) or a model that it is "
      "a variant of ({model: LS, ...}), nor is it a function of Python (salbench.run(models={\"XS\": "
      "function})); did you mean 'LS'?\n"
      "x.yaml:7: models.PS.absolut is not a known key; did you mean 'absolute'?\n"
      "x.yaml:8: models.LS.foci_sigma is 'x', not a finite number\n"
      "x.yaml:10: models.MINE.timeout must be a number above 0, not 0\n"
      "x.yaml:11: models.YOURS.reads names 'colour', expected some of mesh, points, normals, faces, fpfh\n"
      "x.yaml:12: scan must be a mapping of keys to values\n"
      "x.yaml:13: dataset.layuot is not a known key; did you mean 'layout'?\n"
      "x.yaml:13: dataset.scans is 'maybe', not true or false");
}

}  // namespace
}  // namespace salbench
