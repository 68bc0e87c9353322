// SPDX-License-Identifier: GPL-3.0-or-later
// Submissions and the leaderboard that is made of them: twelve, of which five are bad in different ways.
#include <functional>
#include <map>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cache/digest.h"
#include "io/file.h"
#include "io/ground_truth_file.h"
#include "io/table.h"
#include "io/zip_file.h"
#include "tests/e2e/workspace.h"
#include "tests/support/toy_data.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;
using testing::StartsWith;

constexpr ZipLimits kAnything = {.entries = 100, .bytes = 1U << 24U};

std::string card(const std::string& name, const std::string& date = "2026-01-01") {
  return fmt::format(
      "name: {}\ncitation: Somebody, <i>A model</i>, 2026\nlicence: GPL\ntraining_data: none\n"
      "test_overlap: none\ndate: {}\n",
      name, date);
}

class Leaderboard : public testing::Test {
 protected:
  Leaderboard() {
    for (int mesh = 1; mesh <= kMeshCount; ++mesh)
      write_toy_item(toy_.data(), std::to_string(mesh), shapes::bumpy_sphere(2, 0.1 + 0.1 * mesh));
    fs::create_directories(submissions());
  }

  fs::path submissions() const { return toy_ / "submissions"; }
  fs::path site() const { return toy_ / "site"; }

  std::vector<std::string> command(const std::string& verb, const fs::path& given, const fs::path& to) const {
    return {SALBENCH_PROGRAM,
            verb,
            given.string(),
            "--to",
            to.string(),
            "-c",
            toy_.config().string(),
            "--data",
            toy_.data().string(),
            "--cache",
            toy_.cache().string(),
            "--threads",
            "2"};
  }

  // Ground truth with more or less noise: the more, the worse the model.
  fs::path maps(const std::string& name, double noise) const {
    for (int mesh = 1; mesh <= kMeshCount; ++mesh) {
      const std::string file = std::to_string(mesh) + ".val";
      const ScalarField truth = parse_values(read_file(toy_.data() / "Distributions" / file), file);
      std::string lines;
      std::uint64_t random = static_cast<std::uint64_t>(mesh);
      for (const double value : truth) {
        random = random * 6364136223846793005U + 1442695040888963407U;
        lines += fmt::format("{}\n", value + noise * static_cast<double>(random >> 40U) / (1U << 24U));
      }
      toy_.write(fs::path(name) / file, lines);
    }
    toy_.write(fs::path(name) / "card.yaml", card(name));
    return toy_ / name;
  }

  Outcome submit(const std::string& name, double noise) const {
    return run_process(command("submit", maps(name, noise), submissions() / (name + ".zip")));
  }

  // A copy of a good submission with other entries.
  void spoil(const std::string& file, const std::function<void(std::vector<ZipEntry>&)>& change) const {
    auto entries = read_zip(submissions() / "G0.zip", kAnything);
    change(entries);
    write_file(submissions() / file, zip_of(entries));
  }
  void with_card(const std::string& file, const std::string& text) const {
    spoil(file, [&](auto& entries) {
      for (ZipEntry& entry : entries)
        if (entry.name == "card.yaml") entry.bytes = text;
    });
  }

  Outcome rank() const { return run_process(command("leaderboard", submissions(), site())); }

  // status and reason of each file
  std::map<std::string, std::string> verdicts() const {
    const Table table = read_csv(site() / "data/submissions.csv");
    const auto files = text_column(table, "file"), status = text_column(table, "status"),
               reasons = text_column(table, "reason");
    std::map<std::string, std::string> verdicts;
    for (std::size_t i = 0; i < files.size(); ++i)
      verdicts[files[i]] = status[i] + (reasons[i].empty() ? "" : ": ") + reasons[i];
    return verdicts;
  }

  std::map<std::string, std::string> everything() const {
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(site()))
      if (entry.is_regular_file())
        files[fs::relative(entry.path(), site()).string()] = read_file(entry.path());
    return files;
  }

  static constexpr int kMeshCount = 6;
  Workspace toy_{"dataset: {scans: false}\nmodels: {RS: }\n"};
};

TEST_F(Leaderboard, TwelveSubmissionsOfWhichFiveAreBad) {
  const std::vector<double> noises = {0, 0.5, 1, 2, 4, 8, 40};
  for (std::size_t i = 0; i < noises.size(); ++i) {
    const Outcome made = submit(fmt::format("G{}", i), noises[i]);
    ASSERT_EQ(made.status, 0) << made.err;
  }
  spoil("bad_map.zip", [](auto& entries) {
    for (std::size_t i = 1; i < 9; ++i)
      entries.back().bytes[entries.back().bytes.size() - i] = '\xff';  // NaN
  });
  spoil("bad_path.zip", [](auto& entries) { entries.push_back({"../evil", "x"}); });
  spoil("bad_missing.zip", [](auto& entries) { entries.pop_back(); });
  with_card("<b>bad_name.zip", card("<script>alert(1)</script>"));
  spoil("bad_truncated.zip", [](auto&) {});
  fs::resize_file(submissions() / "bad_truncated.zip",
                  fs::file_size(submissions() / "bad_truncated.zip") / 2);

  const Outcome first = rank();
  EXPECT_EQ(first.status, 1) << first.err;
  EXPECT_THAT(lines_with(first.err, "meshes of SHREC'07 are here"), SizeIs(1)) << first.err;
  auto verdict = verdicts();
  ASSERT_THAT(verdict, SizeIs(12));
  for (std::size_t i = 0; i < noises.size(); ++i) EXPECT_EQ(verdict[fmt::format("G{}.zip", i)], "ranked");
  EXPECT_THAT(verdict["bad_map.zip"],
              AllOf(StartsWith("refused: maps/6.npy: value "), HasSubstr("expected a finite number")));
  EXPECT_THAT(verdict["bad_path.zip"], HasSubstr("\"../evil\" has a path that leaves the folder"));
  EXPECT_EQ(verdict["bad_missing.zip"], "refused: has no map of 1 of 6 items, such as 6");
  EXPECT_THAT(verdict["<b>bad_name.zip"], StartsWith("refused: card.yaml: name \"<script>"));
  EXPECT_THAT(verdict["bad_truncated.zip"], HasSubstr("cannot be read as a ZIP archive"));

  const Table ranking = read_csv(site() / "data/ranking.csv");
  const auto metrics = text_column(ranking, "metric"), models = text_column(ranking, "model");
  std::vector<std::string> by_auc;
  for (std::size_t i = 0; i < metrics.size(); ++i)
    if (metrics[i] == "auc") by_auc.push_back(models[i]);
  EXPECT_THAT(by_auc, ElementsAre("G0", "G1", "G2", "G3", "G4", "G5", "G6"));

  const auto pages = everything();
  for (const auto& [name, text] : pages) {
    if (!name.ends_with(".html")) continue;
    EXPECT_THAT(text,
                AllOf(Not(HasSubstr("<script>alert")), Not(HasSubstr("<b>bad")), Not(HasSubstr("<i>A"))))
        << name;
  }
  EXPECT_THAT(pages.at("index.html"), HasSubstr("&lt;b&gt;bad_name.zip"));
  EXPECT_THAT(pages.at("models/G0.html"), HasSubstr("Somebody, &lt;i&gt;A model&lt;/i&gt;, 2026"));
  EXPECT_FALSE(pages.contains("models/bad.html"));
  EXPECT_FALSE(fs::exists(toy_ / "evil") || fs::exists(submissions() / "evil"));

  EXPECT_EQ(rank().status, 1);
  EXPECT_EQ(everything(), pages) << "byte for byte";

  // Scores are those that evaluate gives the same maps.
  ASSERT_EQ(toy_.salbench("evaluate", {"--maps", (toy_ / "G3").string(), "--name", "G3"}).status, 0);
  EXPECT_EQ(lines_with(toy_.results(), ",G3,"), lines_with(pages.at("data/results.csv"), ",G3,"));
  EXPECT_THAT(lines_with(toy_.results(), ",G3,"), SizeIs(6));
}

TEST_F(Leaderboard, WhatElseIsRefused) {
  ASSERT_EQ(submit("G0", 0).status, 0);
  with_card("no_licence.zip", "name: A\ncitation: x\n");
  with_card("twin.zip", card("G0"));
  with_card("of_the_program.zip", card("LS"));
  with_card("no_date.zip", card("B", "soon"));
  with_card("lines.zip", card("D") + "url: \"a\\n# b\"\n");
  with_card("unknown_key.zip", card("C") + "licens: x\n");
  spoil("other_data.zip", [](auto& entries) {
    std::string& manifest = entries[0].bytes;
    manifest.replace(manifest.find("data: \"") + 7, 4, "0000");
  });
  spoil("other_protocol.zip", [](auto& entries) {
    std::string& text = entries[2].bytes;
    text.replace(text.find("seed: 2016"), 10, "seed: 2017");
    std::string& manifest = entries[0].bytes;
    const std::size_t at = manifest.find("configuration: \"") + 16;
    manifest.replace(at, 32, file_digest(text).hex());
  });
  spoil("changed_protocol.zip", [](auto& entries) { entries[2].bytes += " "; });
  spoil("short.zip", [](auto& entries) { entries.back().bytes.resize(entries.back().bytes.size() - 8); });
  spoil("no_npy.zip", [](auto& entries) { entries.back().bytes = "1\n2\n"; });
  spoil("other_item.zip", [](auto& entries) { entries.push_back({"maps/77.npy", entries.back().bytes}); });
  spoil("further.zip", [](auto& entries) { entries.push_back({"run.sh", "rm"}); });
  spoil("bomb.zip", [](auto& entries) { entries.push_back({"maps/x.npy", std::string(1U << 20U, '\0')}); });
  spoil("no_card.zip", [](auto& entries) { entries.erase(entries.begin() + 1); });
  spoil("scores.zip", [](auto& entries) {
    entries[1].bytes = card("LIAR");
    entries[3].bytes = "made up";
  });
  write_file(submissions() / "text.zip", "hello");

  EXPECT_EQ(rank().status, 1);
  auto verdict = verdicts();
  EXPECT_EQ(verdict["G0.zip"], "ranked");
  EXPECT_EQ(verdict["no_licence.zip"], "refused: card.yaml: lacks licence, training_data, test_overlap");
  EXPECT_EQ(verdict["twin.zip"], "refused: the name G0 is taken by G0.zip");
  EXPECT_THAT(lines_with(read_file(site() / "data/results.csv"), ",G0,"), SizeIs(kMeshCount))
      << "and stays its own";
  EXPECT_THAT(verdict["of_the_program.zip"], HasSubstr("is the name of something else"));
  EXPECT_THAT(verdict["no_date.zip"], HasSubstr("card.yaml: date is \"soon\""));
  EXPECT_THAT(verdict["lines.zip"], HasSubstr("card.yaml: url has a control character"));
  EXPECT_THAT(verdict["unknown_key.zip"], HasSubstr("licens is not a known key; did you mean 'licence'?"));
  EXPECT_THAT(verdict["other_data.zip"], StartsWith("refused: other data: their digest is \"0000"));
  EXPECT_EQ(verdict["other_protocol.zip"],
            "refused: another protocol: it has \"seed: 2017\", the leaderboard \"seed: 2016\"");
  EXPECT_THAT(verdict["changed_protocol.zip"], HasSubstr("is not what submission.yaml has the digest of"));
  EXPECT_THAT(verdict["short.zip"], HasSubstr("maps/6.npy: "));
  EXPECT_THAT(verdict["no_npy.zip"], HasSubstr("maps/6.npy: not a .npy file"));
  EXPECT_THAT(verdict["other_item.zip"], HasSubstr("\"maps/77.npy\": there is no such item"));
  EXPECT_THAT(verdict["further.zip"], HasSubstr("the file \"run.sh\" is no part of a submission"));
  EXPECT_THAT(verdict["bomb.zip"], HasSubstr("unpacks to more than "));
  EXPECT_EQ(verdict["no_card.zip"], "refused: has no card.yaml");
  EXPECT_THAT(verdict["text.zip"], HasSubstr("cannot be read as a ZIP archive"));
  EXPECT_EQ(verdict["scores.zip"], "ranked") << "its own scores decide nothing";
  const Table table = read_csv(site() / "data/submissions.csv");
  EXPECT_THAT(lines_with(to_csv(table), "LIAR"),
              ElementsAre(HasSubstr("the scores that it came with are others")));
}

TEST_F(Leaderboard, SubmitSaysWhatIsMissingAndWritesNothing) {
  const fs::path mine = maps("M", 1);
  const auto submitted = [&] { return run_process(command("submit", mine, submissions() / "M.zip")); };
  fs::remove(mine / "3.val");
  const Outcome missing = submitted();
  EXPECT_EQ(missing.status, 1);
  EXPECT_THAT(missing.err, HasSubstr("3.val: missing"));
  maps("M", 1);
  toy_.write("M/card.yaml", "name: M\n");
  const Outcome no_card = submitted();
  EXPECT_EQ(no_card.status, 2);
  EXPECT_THAT(no_card.err, HasSubstr("card.yaml: lacks citation, licence, training_data, test_overlap"));
  EXPECT_FALSE(fs::exists(submissions() / "M.zip"));
  maps("M", 1);
  ASSERT_EQ(submitted().status, 0);
  const std::string bytes = read_file(submissions() / "M.zip");
  ASSERT_EQ(submitted().status, 0);
  EXPECT_EQ(read_file(submissions() / "M.zip"), bytes);
}

TEST_F(Leaderboard, FoldersThatWillNotDo) {
  EXPECT_THAT(rank().err, HasSubstr("has no submission"));
  ASSERT_EQ(submit("G0", 0).status, 0);
  toy_.write("site/thesis.txt", "years of work");
  const Outcome full = rank();
  EXPECT_EQ(full.status, 2);
  EXPECT_THAT(full.err, HasSubstr("holds something else than a leaderboard"));
  EXPECT_TRUE(fs::exists(toy_ / "site/thesis.txt"));
}

}  // namespace
}  // namespace salbench
