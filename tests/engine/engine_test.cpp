// SPDX-License-Identifier: GPL-3.0-or-later
// The engine on numbers and strings: running, interruption, verification, garbage collection.
#include <functional>
#include <mutex>

#include <fmt/format.h>

#include "pipeline/engine/maintain.h"
#include "tests/engine/toy.h"
#include "tests/support/cache_files.h"
#include "tests/support/meeting.h"
#include "tests/support/memory_store.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

using testing::Ge;
using testing::Lt;
using testing::Matcher;

enum Stage : std::size_t { kText, kWord, kLength, kLongest, kPadded };  // [rule]

const std::vector<std::string> kTexts2 = {"a bb ccc", "dddd ee f"};

struct EngineTest : testing::Test {
  // Returns "stage@unit" of everything computed, sorted.
  std::vector<std::string> run(const Project& project, int threads = 2) {
    Resolver resolver(project, make_plan(project, store), store);
    run_jobs(resolver, {.threads = threads}, progress, stop);
    failures = resolver.failures();
    values.clear();
    for (const Job& job : project.jobs())
      if (job.rule == kPadded && resolver.plan()[job].known())
        values.push_back(value_as<std::string>(*resolver.value(job)));
    return store.take_saved();
  }

  TemporaryFolder folder;
  MemoryStore store;
  NoProgress progress;
  std::atomic<bool> stop = false;
  std::vector<Failure> failures;
  std::vector<std::string> values;
};

TEST_F(EngineTest, ComputesEverythingOnceAndThenWhatAnOptionConcerns) {
  const Project project = toy_project(folder, kTexts2);
  EXPECT_THAT(run(project), SizeIs(2 + 3 * 6 + 1));
  EXPECT_THAT(values, ElementsAre("a...", "bb..", "ccc.", "dddd", "ee..", "f..."));
  EXPECT_THAT(run(project), IsEmpty());
  const auto again = run(toy_project(folder, kTexts2, {'_'}));
  EXPECT_THAT(again, SizeIs(6));
  EXPECT_THAT(again, Each(StartsWith("padded@")));
  EXPECT_THAT(values, Contains("a___"));
}

TEST_F(EngineTest, StopsWhereAnInputComesOutAsBefore) {
  run(toy_project(folder, kTexts2));
  EXPECT_THAT(run(toy_project(folder, {"a  bb  ccc", kTexts2[1]})),
              ElementsAre("text@text0", "word@text0_0", "word@text0_1", "word@text0_2"));
  EXPECT_THAT(run(toy_project(folder, {"aa bb ccc", kTexts2[1]})), Contains("padded@text0_0"));
}

TEST_F(EngineTest, AFailureStopsWhatReadsItAndNothingElse) {
  EXPECT_THAT(run(toy_project(folder, {"a bb", kTexts2[1]})), Contains("padded@text0_1"));
  ASSERT_THAT(failures, SizeIs(1));
  EXPECT_EQ(failures[0].cause, "too few words");
  EXPECT_THAT(values, SizeIs(5));
}

// The other text has only the jobs from which the longest word is computed.
TEST_F(EngineTest, AFamilyThatIsNotChosenTakesPartInWhatIsGatheredOfAll) {
  Project project = toy_project(folder, kTexts2);
  const Project whole = project;
  std::vector<Family> families = project.units.families();
  families[1].chosen = false;
  project.units = Units(project.units.levels(), families);
  const std::vector<bool> needed = project.ancestors({kLongest});
  for (std::size_t rule = 0; rule < needed.size(); ++rule)
    project.rules[rule].for_all = needed[rule] && rule != kLongest;
  EXPECT_THAT(run(project), SizeIs(2 + 2 * 6 + 1 + 3));
  EXPECT_THAT(values, ElementsAre("a...", "bb..", "ccc.")) << "as wide as the other's word";
  EXPECT_THAT(run(whole), ElementsAre("padded@text1_0", "padded@text1_1", "padded@text1_2"));
  for (std::size_t rule = 0; rule < needed.size(); ++rule) project.rules[rule].for_all = false;
  EXPECT_THAT(run(project), Contains("longest@words")) << "over the words of one text";
  EXPECT_THAT(values, ElementsAre("a..", "bb.", "ccc"));
}

TEST_F(EngineTest, ResumesAfterAStop) {
  Project project = toy_project(folder, kTexts2);
  project.rules[kLength].compute = [this, was = project.rules[kLength].compute](const JobInputs& in) {
    stop = true;
    return was(in);
  };
  const std::size_t before = run(project).size();
  stop = false;
  EXPECT_THAT(run(toy_project(folder, kTexts2)), SizeIs(21 - before));
  EXPECT_THAT(values, SizeIs(6));
}

// The rule that shouts is limited to one job at a time, also where a reader restores a damaged artefact.
TEST_F(EngineTest, ALimitHoldsForWhatIsRestoredToo) {
  struct Watched final : MemoryStore {
    std::optional<Arrays> load(const Digest& key) override {
      if (watching && stage_of(key) == "word") begun.join();
      return MemoryStore::load(key);
    }
    std::atomic<bool> watching = false;
    Meeting begun{2};  // for a word to shout, and one whose shout is restored
  };
  const auto watched = std::make_shared<Watched>();
  const auto together = std::make_shared<Meeting>(2, std::chrono::milliseconds(200));
  RuleTable table(toy_project(folder, {"a bb ccc", "dddd eeeee ffffff"}).rules);
  const auto shout = table.add(
      kWords, {.stage = "shout", .limit = 1},
      [watched, together](const std::string& s) {
        if (watched->watching) together->join();
        return s + "!";
      },
      Output<std::string>(kWord));
  table.add(
      kWords, {.stage = "echo"}, [](const std::string& s) { return s + s; }, shout);
  const Project project{.rules = std::move(table).take(), .units = toy_units(2)};
  const auto run_all = [&] {
    Resolver resolver(project, make_plan(project, *watched), *watched);
    run_jobs(resolver, {.threads = 2}, progress, stop);
    return watched->take_saved();
  };
  run_all();
  watched->damage("shout", "text0_0");
  watched->remove("echo", "text0_0");
  watched->remove("shout", "text1_0");
  watched->watching = true;
  EXPECT_THAT(run_all(), ElementsAre("echo@text0_0", "shout@text0_0", "shout@text1_0"));
  EXPECT_FALSE(together->met());
}

// The job reports an hour of waiting, so that its duration becomes negative; concurrent jobs report none.
TEST_F(EngineTest, WhatAFunctionWaitsUntilItIsItsTurnIsNoPartOfWhatItTakes) {
  RuleTable table(toy_project(folder, kTexts2).rules);
  table.add(
      kWords, {.stage = "late"},
      [](const std::string& s) {
        note_waiting(std::chrono::hours(1));
        return s;
      },
      Output<std::string>(kWord));
  const Project project{.rules = std::move(table).take(), .units = toy_units(2)};
  Resolver resolver(project, make_plan(project, store), store);
  run_jobs(resolver, {.threads = 1}, progress, stop);
  for (std::size_t rule = 0; rule < project.rules.size(); ++rule) {
    const bool is_late = project.rules[rule].stage == "late";
    EXPECT_THAT(resolver.records()[rule].seconds, Each(is_late ? Matcher<float>(Lt(0.0F)) : Ge(0.0F)))
        << rule;
  }
}

// Both compute the value, and all continue with the one that was kept.
TEST_F(EngineTest, JobsThatMakeWhatTheyShareAtOnceGetTheSame) {
  static Meeting both(2);
  struct Shared {
    explicit Shared(const std::string&) { both.join(); }
  };
  std::mutex mutex;
  std::set<const Shared*> seen;
  RuleTable table(toy_project(folder, {kTexts2[0]}).rules);
  table.add(
      kWords, {.stage = "of_shared"},
      [&](const Shared& shared, const UnitPlace& place) {
        const std::lock_guard lock(mutex);
        seen.insert(&shared);
        return static_cast<double>(place.index);
      },
      prepared<Shared>(Output<std::string>(kText)), kPlace);
  run({.rules = std::move(table).take(), .units = toy_units(1)});
  EXPECT_TRUE(both.met());
  EXPECT_THAT(seen, SizeIs(1));
}

// A user's program on six words of two texts. Numbers count first words, then second words.
TEST_F(EngineTest, AForeignStageThatFailsAlikeOnItsFirstUnitsIsNotTriedOnOthers) {
  using Says = std::function<std::string(int word, const std::string& name)>;  // empty: success
  const auto always = [](int, const std::string&) { return "no module"; };
  const struct {
    const char* what;
    Says says;
    std::size_t tries, asked, failed;
  } rows[] = {
      {"one message", always, 5, 5, 5},
      {"its name in it", [](int, const std::string& name) { return "no " + name + ": bad"; }, 5, 5, 5},
      {"the last would go well", [](int word, const std::string&) { return word == 5 ? "" : "bad"; }, 5, 5,
       5},
      {"another in the middle", [](int word, const std::string&) { return word == 2 ? "good" : "bad"; }, 5, 6,
       6},
      {"numbers that are no names", [](int word, const std::string&) { return std::to_string(word); }, 5, 6,
       6},
      {"a longer name", [](int, const std::string& name) { return name + "x"; }, 5, 6, 6},
      {"one goes well", [](int word, const std::string&) { return word == 4 ? "" : "bad"; }, 5, 6, 5},
      {"no more than may fail", always, 6, 6, 6},
      {"all are asked for", always, 0, 6, 6},
  };
  for (const int threads : {1, 4})
    for (const auto& row : rows) {
      SCOPED_TRACE(row.what);
      std::atomic<std::size_t> asked = 0;
      RuleTable table(toy_project(folder, kTexts2).rules);
      const auto shout = table.add(
          kWords, {.stage = "shout", .is_foreign = true},
          [&](const std::string& s, const UnitName& name) {
            ++asked;
            const int word = (name.text[4] - '0') + 2 * (name.text[6] - '0');
            if (const std::string wrong = row.says(word, name.text); !wrong.empty()) throw InputError(wrong);
            return s;
          },
          Output<std::string>(kWord), kName);
      table.add(
          kWords, {.stage = "echo"}, [](const std::string& s) { return s; }, shout);
      const Project project{.rules = std::move(table).take(), .units = toy_units(2)};
      MemoryStore own;
      Resolver resolver(project, make_plan(project, own), own);
      run_jobs(resolver, {.threads = threads, .tries = row.tries}, progress, stop);
      EXPECT_EQ(asked, row.asked);
      ASSERT_THAT(resolver.failures(), SizeIs(row.failed));
      for (std::size_t i = 0; i < 5 && row.asked == 5; ++i)
        EXPECT_EQ(project.name(resolver.failures()[i].job), fmt::format("text{}_{}", i / 3, i % 3));
      EXPECT_FALSE(has_work(resolver));
    }
}

TEST_F(EngineTest, AForeignStageThatHasAResultIsTriedOnAllOthers) {
  std::size_t asked = 0;
  bool fails = false;
  RuleTable table(toy_project(folder, kTexts2).rules);
  table.add(
      kWords, {.stage = "shout", .limit = 1, .is_foreign = true},
      [&](const std::string& s, const UnitName& name) {
        ++asked;
        if (fails || name.text != "text1_2") throw InputError("bad");
        return s;
      },
      Output<std::string>(kWord), kName);
  const Project project{.rules = std::move(table).take(), .units = toy_units(2)};
  for (const std::size_t tries : {std::size_t{0}, std::size_t{3}}) {
    asked = 0;
    Resolver resolver(project, make_plan(project, store), store);
    run_jobs(resolver, {.tries = tries}, progress, stop);
    EXPECT_EQ(asked, tries == 0 ? 6U : 5U);
    fails = true;
  }
}

// A gathering rule ends a stratum; everything that it does not need comes later.
TEST_F(EngineTest, StrataFollowFromTheRules) {
  EXPECT_THAT(strata(toy_project(folder, kTexts2).rules), ElementsAre(0, 0, 0, 0, 1));
  RuleTable table(toy_project(folder, kTexts2).rules);
  table.add(
      kWords, {.stage = "widest"}, [](const Members<std::string>&) { return 0.0; },
      Output<std::string>(kPadded));
  table.add(
      kWords, {.stage = "again"}, [](const std::string& s, double) { return s; },
      Output<std::string>(kPadded), Output<double>(5));
  EXPECT_THAT(strata(table.rules()), ElementsAre(0, 0, 0, 0, 1, 1, 2));
}

// Another process holds the value gathered over all padded words, until asked whether it still does.
class HeldStore : public MemoryStore {
 public:
  std::unique_ptr<Claim> claim(std::string_view work) override {
    return is_held_ && work.starts_with("widest") ? nullptr : MemoryStore::claim(work);
  }
  bool is_claimed(std::string_view) const override {
    if (std::exchange(is_held_, false)) done_before = stages();
    return false;
  }
  mutable std::vector<std::string> done_before;

 private:
  mutable bool is_held_ = true;
};

TEST_F(EngineTest, WhatNeedsNoGatheredValueThatAnotherHoldsRunsAheadOfIt) {
  RuleTable table(toy_project(folder, kTexts2).rules);
  const Output<std::string> padded(kPadded);
  const auto widest = table.add(
      kWords, {.stage = "widest"}, [](const Members<std::string>&) { return 0.0; }, padded);
  table.add(
      kWords, {.stage = "shouted"}, [](const std::string& s) { return s + "!"; }, padded);
  table.add(
      kWords, {.stage = "again"}, [](const std::string& s, double) { return s; }, padded, widest);
  const Project project{.rules = std::move(table).take(), .units = toy_units(kTexts2.size())};
  HeldStore held;
  Resolver resolver(project, make_plan(project, held), held);
  run_jobs(resolver, {.threads = 2}, progress, stop);
  EXPECT_THAT(held.done_before, AllOf(Contains("shouted"), Not(Contains("widest"))));
  EXPECT_THAT(held.stages(), Contains("again"));
}

TEST_F(EngineTest, PlansAFewJobsWithoutTheOthers) {
  const Project project = toy_project(folder, kTexts2);
  const Job word{kWord, {kWords, 4}};
  const Plan plan = make_plan_of(project, store, {word});
  EXPECT_EQ(plan[word].reason, Reason::input_pending);
  EXPECT_TRUE((plan[{kText, {kTexts, 1}}].open()));
  EXPECT_FALSE((plan[{kText, {kTexts, 0}}].open()));
  EXPECT_TRUE(project.files({kText, {kTexts, 1}})[0].is_read);
  EXPECT_FALSE(project.files({kText, {kTexts, 0}})[0].is_read);
}

TEST(EngineCache, FindsWhatChangedVerifiesAndCollects) {
  const TemporaryFolder folder, cache;
  const std::atomic<bool> go_on = false;
  NoProgress progress;
  const auto run_with = [&](const Project& project) {
    FolderStore store(cache.path(), Access::read_write);
    Resolver resolver(project, make_plan(project, store), store);
    run_jobs(resolver, {.threads = 2}, progress, go_on);
  };
  run_with(toy_project(folder, kTexts2));
  const Project other = toy_project(folder, kTexts2, {'_'});
  {
    FolderStore store(cache.path(), Access::read_only);
    const Plan plan = make_plan(other, store);
    const Job padded{kPadded, {kWords, 0}};
    EXPECT_EQ(plan[padded].reason, Reason::changed);
    EXPECT_EQ((plan[{kWord, {kWords, 0}}].reason), Reason::none);
    const Recomputation sample = recompute_sample(other, plan, store, 100, go_on);
    EXPECT_EQ(sample.jobs, 2U + 2 * 6 + 1);
    EXPECT_THAT(sample.faults, IsEmpty());
  }
  run_with(other);
  FolderStore store(cache.path(), Access::read_only);
  KeepSet needed;
  EXPECT_EQ(add_needed(other, make_plan(other, store), needed), 0U);
  collect_garbage(cache.path(), needed, false, progress);
  EXPECT_THAT(artefacts_of(cache.path()), SizeIs(21));
}

}  // namespace
}  // namespace salbench
