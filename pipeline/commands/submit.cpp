// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <filesystem>
#include <memory>

#include <fmt/format.h>

#include "io/file.h"
#include "io/values_file.h"
#include "pipeline/commands/commit.h"
#include "pipeline/commands/run.h"
#include "pipeline/commands/subcommands.h"
#include "pipeline/commands/submission.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

Words stage_versions(const Project& project) {
  Words stages;
  for (const Rule& rule : project.rules) {
    std::string stage = fmt::format("{} {}", rule.stage, rule.version);
    if (std::ranges::find(stages, stage) == stages.end()) stages.push_back(std::move(stage));
  }
  return stages;
}

// Maps as they were read and checked, of every kind of shape.
std::map<std::string, std::string> maps_of(Session& session) {
  std::map<std::string, std::string> maps;
  const Project& project = session.setup.project;
  for (std::size_t rule = 0; rule < project.rules.size(); ++rule) {
    if (!has_role(project.rules[rule], Role::map)) continue;
    for (const Unit unit : project.units.of(project.rules[rule].over)) {
      if (!session.resolver.plan()[{rule, unit}].known()) continue;
      const ValuePtr map = session.resolver.value({rule, unit});
      maps[project.units.name(unit)] = npy_of(value_as<ScalarField>(*map));
    }
  }
  return maps;
}

Submission submission_of(Session& session, const Card& card, const Expected& expected) {
  Submission made;
  made.card = card;
  made.maps = maps_of(session);
  made.results =
      to_csv(results_table(collect_results(session.state()), chosen_metrics(session.setup.config.metrics)));
  made.manifest = {.format = std::string(kSubmissionFormat),
                   .program = SALBENCH_VERSION,
                   .commit = std::string(commit()),
                   .protocol = std::string(name_of(session.setup.config.protocol)),
                   .configuration = file_digest(expected.configuration).hex(),
                   .data = expected.data.hex(),
                   .maps = static_cast<std::int32_t>(made.maps.size()),
                   .stages = stage_versions(session.setup.project)};
  return made;
}

// What is written is read as a maintainer reads it: a file that would be refused does not stay.
void write_checked(const fs::path& to, const std::vector<ZipEntry>& entries, const Expected& expected) {
  write_file(to, zip_of(entries));
  try {
    read_submission(to, expected);
  } catch (const InputError&) {
    remove_file(to);
    throw;
  }
}

ExitStatus run_submit(const Arguments& arguments, const std::string& mine, ReportFormat format,
                      const std::atomic<bool>& stop) {
  const fs::path card_file = fs::path(mine) / "card.yaml";
  const std::string card_text = read_file(card_file, kLongestText);
  const Card card = read_card(card_text, card_file.string());
  Config config = read_configuration(arguments);
  config.models = {given_model(card.name, find_given_maps(mine, false))};
  Session session(Setup(std::move(config), selection_of(arguments)), progress_of(arguments.quiet), stop);
  session.run(thread_count(arguments));
  if (stop) return interrupted_status(arguments);
  const ExitStatus status = finished_status(session);
  if (status == kAllDone) {
    const Expected expected = expected_of(session);
    write_checked(arguments.to,
                  entries_of(submission_of(session, card, expected), card_text, expected.configuration),
                  expected);
  }
  Json document = {{"to", status == kAllDone ? Json(arguments.to) : Json()}, {"model", card.name}};
  document.update(summary_of(session));
  print_report(format, "submit", document,
               status == kAllDone && !arguments.quiet
                   ? fmt::format("{} can be handed in: it was checked as salbench leaderboard checks it\n",
                                 arguments.to)
                   : "");
  return status;
}

}  // namespace

Subcommand submit_subcommand(Arguments& arguments) {
  const auto mine = std::make_shared<std::string>();
  const FormatWord word = default_format();
  return {"submit", "check maps of your own and write the file that a leaderboard takes",
          leaderboard_parameters(
              arguments, {{"MINE", mine.get(),
                           "folder with ITEM.val of every item with ground truth, and card.yaml", true},
                          {"--to", &arguments.to, "the file to write, such as mine.zip", true},
                          format_parameter(word)}),
          [&arguments, mine, word](const std::atomic<bool>& stop) {
            return run_submit(leaderboard_arguments(arguments), *mine, format_of(word), stop);
          }};
}

}  // namespace salbench
