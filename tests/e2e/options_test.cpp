// SPDX-License-Identifier: GPL-3.0-or-later
// Options over the program's own table: each that a subcommand takes does something there.
#include <map>
#include <optional>
#include <set>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/file.h"
#include "pipeline/commands/cli.h"
#include "tests/e2e/workspace.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

class Options : public testing::Test {
 protected:
  Options() {
    EXPECT_EQ(toy_.salbench("run").status, 0);
    scores_ = toy_.write("scores.csv", toy_.results());
    EXPECT_EQ(toy_.salbench("export", {"--format", "maps", "--to", (toy_ / "maps").string()}).status, 0);
  }

  // What a subcommand cannot do without, each in its smallest form.
  std::vector<std::string> words(const std::string& name) const {
    const std::string config = toy_.config().string();
    const auto below = [&](const char* path) { return (toy_ / path).string(); };
    const std::map<std::string, std::vector<std::string>> all = {
        {"run", {config}},
        {"export", {config, "--to", below("all.h5")}},
        {"plan", {config}},
        {"config", {config}},
        {"verify", {config, "--deep"}},
        {"gc", {config, "--dry-run"}},
    };
    EXPECT_TRUE(all.contains(name)) << name << " is new: give its smallest form here";
    return all.at(name);
  }

  // The subcommand over the toy's folders.
  std::vector<std::string> command(const std::string& name,
                                   const std::vector<std::string>& further = {}) const {
    std::vector<std::string> command = {program_.string(), name};
    for (const std::string& word : words(name)) command.push_back(word);
    for (const auto& [option, folder] :
         {std::pair("--data", toy_.data()), {"--cache", toy_.cache()}, {"--out", toy_.out()}})
      if (takes(name, option) && std::ranges::find(further, option) == further.end())
        command.insert(command.end(), {option, folder.string()});
    command.insert(command.end(), further.begin(), further.end());
    return command;
  }
  Outcome said(const std::string& name, const std::vector<std::string>& further = {}) const {
    return run_process(command(name, further));
  }

  // Those of the program itself.
  static std::vector<const CLI::App*> subcommands() {
    static CLI::App program;
    if (program.get_subcommands({}).empty()) declare_program(program, kSubcommands);
    return std::as_const(program).get_subcommands(
        [](const CLI::App* app) { return app->get_group() == "Subcommands"; });
  }

  Workspace toy_{kMeshesOnly};
  fs::path program_ = SALBENCH_PROGRAM, scores_;
};

// One that is not looked at would be accepted with any value, and its user believe in it.
TEST_F(Options, ThatASubcommandTakesAreUsedByIt) {
  const std::string file = toy_.write("no_folder", "text").string();
  const std::map<std::string, std::string> unusable = {
      {"--data", "/no/such/data"}, {"--cache", file},      {"--out", file},
      {"--items", "nobody"},       {"--split", "nosuch"},  {"--reference", "/no/such.csv"},
      {"--shard", "9/8"},          {"--models", "NOSUCH"}, {"--format", "nosuch"}};
  for (const CLI::App* subcommand : subcommands())
    for (const CLI::Option* option : subcommand->get_options()) {
      SCOPED_TRACE(subcommand->get_name() + " " + option->get_name());
      if (const auto value = unusable.find(option->get_name()); value != unusable.end()) {
        const Outcome outcome = said(subcommand->get_name(), {option->get_name(), value->second});
        EXPECT_THAT(outcome.out + outcome.err, HasSubstr(value->second));
      }
      if (option->get_name() == "--quiet") {
        const Outcome loud = said(subcommand->get_name()), quiet = said(subcommand->get_name(), {"--quiet"});
        EXPECT_EQ(quiet.status, loud.status) << loud.err;
        EXPECT_LT(quiet.out.size(), loud.out.size());
      }
    }
}

TEST_F(Options, ThatASubcommandDoesNotUseAreRefused) {
  for (const auto& [subcommand, option] :
       {std::pair("plan", "--quiet"), {"plan", "--threads"}, {"export", "--out"}}) {
    const Outcome outcome = said(subcommand, {option, "1"});
    EXPECT_EQ(outcome.status, 2) << subcommand << option;
    EXPECT_THAT(outcome.err, HasSubstr(std::string("there is no option '") + option + "'")) << subcommand;
  }
}

TEST_F(Options, ThreadsAreForWhatComputes) {
  for (const CLI::App* subcommand : subcommands()) {
    toy_.forget_everything();
    EXPECT_NE(said(subcommand->get_name()).status, 70);
    EXPECT_EQ(takes(subcommand->get_name(), "--threads"), !toy_.artefacts().empty())
        << subcommand->get_name();
  }
}

TEST_F(Options, ThatDoNothingWithoutAnotherAreRefusedWithoutIt) {
  const auto text_of = [&](const std::string& name) {
    return name == "CONFIG" ? toy_.config().string() : name;
  };
  std::vector<std::string> found;
  for (const CLI::App* subcommand : subcommands())
    for (const CLI::Option* option : subcommand->get_options()) {
      if (option->get_needs().empty()) continue;
      const std::string needed = (*option->get_needs().begin())->get_name();
      found.push_back(subcommand->get_name() + " " + option->get_name());
      std::vector<std::string> words = {program_.string(), subcommand->get_name()};
      for (const std::string& word : this->words(subcommand->get_name()))
        if (word != text_of(needed) && !word.starts_with("--")) words.push_back(word);
      words.push_back(option->get_name());
      if (option->get_expected_min() > 0) words.emplace_back("1");
      const Outcome outcome = run_process(words);
      EXPECT_EQ(outcome.status, 2) << found.back();
      EXPECT_THAT(outcome.err, HasSubstr(option->get_name() + " requires " + needed)) << found.back();
    }
  EXPECT_THAT(found, testing::IsSupersetOf({"verify --sample", "run --matched", "run --maps"}));
}

// It would be the present folder, or as good as no option at all.
TEST_F(Options, AnEmptyPathIsRefused) {
  const std::set<std::string> paths = {"CONFIG", "--data", "--cache",    "--out",
                                       "--to",   "--maps", "--reference"};
  std::set<std::string> found;
  for (const CLI::App* subcommand : subcommands())
    for (const CLI::Option* option : subcommand->get_options()) {
      if (!paths.contains(option->get_name())) continue;
      found.insert(option->get_name());
      const bool is_config = option->get_name() == "CONFIG";
      const std::vector<std::string> further =
          is_config ? std::vector<std::string>{""} : std::vector<std::string>{option->get_name(), ""};
      std::vector<std::string> words = {program_.string(), subcommand->get_name()};
      if (!is_config) words.push_back(toy_.config().string());
      words.insert(words.end(), further.begin(), further.end());
      const Outcome outcome = run_process(words);
      EXPECT_EQ(outcome.status, 2) << subcommand->get_name() << ' ' << option->get_name();
      EXPECT_THAT(outcome.err, HasSubstr("is empty: name a file or a folder"))
          << subcommand->get_name() << option->get_name();
    }
  EXPECT_EQ(found, paths);
}

TEST_F(Options, AnEmptySplitTakesAllItemsWhateverTheConfigurationTakes) {
  toy_.write("sets.yaml",
             "places:\n  - meshes: Meshes/*.off\n    truth: {saliency: 'Distributions/{item}.val'}\n"
             "splits: {items: {train: ['1'], test: ['2']}}\n");
  toy_.configure("dataset: {scans: false, layout: '" + (toy_ / "sets.yaml").string() +
                 "', split: test}\nmodels: {PS: , RS: }\n");
  const auto meshes = [&](const std::vector<std::string>& further) {
    const Outcome status = toy_.salbench("plan", further);
    return lines_with(status.out, "data set: ").at(0) + status.err;
  };
  EXPECT_THAT(meshes({}), HasSubstr(": 1 mesh"));
  EXPECT_THAT(meshes({"--split", "train"}), HasSubstr(": 1 mesh"));
  EXPECT_THAT(meshes({"--split", ""}), HasSubstr(": 2 meshes"));
}

// In a folder of its own, neither installed nor in a checkout.
TEST_F(Options, NamesOfConfigurationsAreFoundByAProgramThatLiesAnywhere) {
  fs::create_directories(toy_ / "bin");
  program_ = toy_ / "bin/salbench";
  fs::copy_file(SALBENCH_PROGRAM, program_);
  int found = 0;
  for (const CLI::App* subcommand : subcommands()) {
    std::vector<std::string> words = command(subcommand->get_name());
    if (std::ranges::find(words, toy_.config().string()) == words.end()) continue;
    std::ranges::replace(words, toy_.config().string(), std::string("shrec07_meshes"));
    const Outcome outcome = run_process(words);
    EXPECT_THAT(outcome.err, Not(HasSubstr("shrec07_meshes"))) << subcommand->get_name();
    EXPECT_EQ(outcome.status, 0) << subcommand->get_name() << outcome.err;
    ++found;
  }
  EXPECT_GE(found, 6);
  EXPECT_THAT(run_process({program_.string(), "config", "protocols/3dva"}).out, HasSubstr("layout: 3dva"));
  EXPECT_THAT(run_process({program_.string(), "config", "shrec07_mesh"}).err,
              HasSubstr("did you mean 'shrec07_meshes'?"));
}

}  // namespace
}  // namespace salbench
