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

TEST(Config, TheTextProtocolHasThePapersWords) {
  const Config config = config_of("protocol: text\nmodels: {PS: }");
  EXPECT_EQ(config.fpfh.neighbourhood, FpfhNeighbourhood::radius);
  EXPECT_EQ(config.fpfh.weighting, FpfhWeighting::text);
  EXPECT_EQ(config.normals.method, MeshNormalsMethod::pca);
  EXPECT_EQ(config.models[0].options, "absolute: true\n");
}

TEST(Config, WritesItselfSoThatItReadsBackTheSame) {
  for (const char* yaml :
       {"", "data: 'a \"b\" # \\c\u00e9'\ncache: \"two\\nlines\"\noutput: o",
        "protocol: text\nseed: 9\nmodels: {RS: , PS: {absolute: false}}\nfpfh: {radius: 0.03}",
        "metrics: all", "metrics: {splits: 9, names: [kl, nss]}", "metrics: {names: all, matching: none}",
        "metrics: {names: [kl, nss], matching: {kl: histogram}}", "picture: {size: 77}",
        "models: {PS: , B: {model: PS, absolute: true}, G: {model: LS, grid: {foci_sigma: [1, 2]}}}"}) {
    const std::string written = config_yaml(config_of(yaml)),
                      annotated = annotated_config_yaml(config_of(yaml));
    for (const std::string& text : {written, annotated}) {
      EXPECT_EQ(config_yaml(config_of(text)), written);
      EXPECT_EQ(annotated_config_yaml(config_of(text)), annotated);
    }
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
  EXPECT_THAT(config_of("metrics: {smoothing: 5}").metrics.smoothing, ElementsAre("5"));
  EXPECT_EQ(config_of("metrics: [cc, kl]\nstatistics: {leading: kl}").statistics.leading, "kl");
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

TEST(Config, ASlipIsNamedByFileLineAndKeyWithTheNearestName) {
  struct Slip {
    const char *yaml, *named;
  };
  for (const auto& [yaml, named] :
       {Slip{"protocol: published\nsed: 1", "x.yaml:2: sed is not a known key; did you mean 'seed'?"},
        Slip{"protocol: txt", "x.yaml:1: protocol is 'txt'"},
        Slip{"fpfh: {radius: -1}", "fpfh.radius"},
        Slip{"dataset: {meshes: false, scans: false}", "dataset.scans"},
        Slip{"models: {}", "x.yaml:1: models"},
        Slip{"models: {XS: }", "models.XS"},
        Slip{"models:\n  PS: {absolut: true}", "x.yaml:2: models.PS.absolut"},
        Slip{"models: {floors: {radius: 0.1}}", "x.yaml:1: models.floors "},
        Slip{"models: {floors: NV}", "x.yaml:1: models.floors "},
        Slip{"models: {floors: [NV]}", "x.yaml:1: models.floors "},
        Slip{"models: {floor: }", "did you mean 'floors'?"},
        Slip{"models: {Floors: {model: LS}}", "models.Floors"},
        Slip{"models: {V: {model: floors}}", "models.V.model is 'floors'"},
        Slip{"seed: 1\nmetrics: [nss, auc_jud]",
             "x.yaml:2: metrics has no metric 'auc_jud'; did you mean 'auc_judd'?"},
        Slip{"metrics:\n  names: [klx]", "x.yaml:2: metrics.names has no metric 'klx'"},
        Slip{"metrics: [a_very_long_name_of_nothing]", "docs/metrics.md"},
        Slip{"metrics: []", "x.yaml:1: metrics"},
        Slip{"metrics: [[nss]]", "x.yaml:1: metrics"},
        Slip{"metrics: {names: {nss: 1}}", "x.yaml:1: metrics.names"},
        Slip{"metrics: {name: nss}", "did you mean 'names'?"},
        Slip{"metrics: {matching: histogramm}", "x.yaml:1: metrics.matching is 'histogramm'"},
        Slip{"metrics:\n  matching:\n    kl: no", "x.yaml:3: metrics.matching.kl is 'no'"},
        Slip{"metrics:\n  matching: {klx: none}", "x.yaml:2: metrics.matching has no metric 'klx'"},
        Slip{"metrics: {matching: [kl]}", "x.yaml:1: metrics.matching"},
        Slip{"metrics: {matchin: none}", "did you mean 'matching'?"},
        Slip{"metrics: {smoothing: [10, 0]}", "x.yaml:1: metrics.smoothing"},
        Slip{"dataset: {score_on: faces}", "dataset.score_on"},
        Slip{"dataset: {score_on: faces, scans: false, participants: simulated}", "dataset.score_on"},
        Slip{"gaze: {degree: 1}", "did you mean 'degrees'?"},
        Slip{"gaze: {degrees: 0}", "x.yaml:1: gaze.degrees"},
        Slip{"metrics: [cc, kl]\nstatistics: {leading: auc}", "statistics.leading"}})
    EXPECT_THAT(error_of(yaml), HasSubstr(named)) << yaml;
}

TEST(Config, AllErrorsAreSaidAtOnceInTheOrderOfTheFile) {
  std::istringstream said(
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
               "dataset: {scans: maybe, layuot: x}\n"));
  std::string named;  // line and key of each
  for (std::string line, place, key; std::getline(said, line);) {
    std::istringstream(line) >> place >> key;
    named += place.substr(place.find(':') + 1) + key + " ";
  }
  EXPECT_EQ(named,
            "1:sed 2:protocol 3:fpfh.neighbours 3:fpfh.radios 3:fpfh.radius 4:metrics.names 4:metrics.names "
            "4:metrics.splits 6:models.XS 7:models.PS.absolut 8:models.LS.foci_sigma 10:models.MINE.timeout "
            "11:models.YOURS.reads 12:scan 13:dataset.layuot 13:dataset.scans ");
}

}  // namespace
}  // namespace salbench
