// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/run/session.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "pipeline/engine/run.h"
#include "pipeline/inputs/listing.h"
#include "pipeline/rules/gaze.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

constexpr std::size_t kTries = 5;  // shapes

// Simulated ground truth exists for every item.
Inputs inputs_of(const Config& config, const Selection& selection, const Front& front) {
  const bool simulated = config.simulated();
  const Others others = selection.reference || selection.reference_of_items ? Others::left_out
                        : simulated                                         ? Others::simulated
                                                                            : Others::measured;
  Inputs inputs =
      read_inputs(front.dataset ? front.dataset() : find_dataset(config.data, config.dataset.layout, front),
                  simulated && selection.items.is_scored() ? ItemChoice() : selection.items, selection.shard,
                  config.dataset.split, others);
  if (is_from_gaze(config, inputs))
    inputs.remark += fmt::format("{}computed from recordings of gaze, as ground_truth in run.yaml says",
                                 inputs.remark.empty() ? "TRUTH: " : "; ");
  return inputs;
}

// Open jobs that serve only the mean over all items.
std::size_t open_of_others(const Resolver& resolver) {
  const Project& project = resolver.project();
  std::size_t open = 0;
  for (std::size_t rule = 0; rule < project.rules.size(); ++rule)
    for (const Unit unit : project.units_of(rule))
      open += !project.units.is_chosen(unit) && resolver.plan()[{rule, unit}].open() ? 1U : 0U;
  return open;
}

// Families in a share; nullopt means all.
std::optional<std::vector<std::string>> families_of_share(const Inputs& inputs) {
  if (!inputs.shard) return {};
  std::vector<std::string> names;
  for (const Family& family : inputs.units.families()) names.push_back(family.name);
  return names;
}

}  // namespace

Setup::Setup(const Request& request, const Front& front)
    : selection(selection_of(request)),
      config(placed_config_of(request, front)),
      inputs(inputs_of(config, selection, front)),
      project(make_project(config, inputs, selection.reference, front)),
      cache(config.cache),
      output(config.output) {
  for (const std::string& error : inputs.errors) spdlog::error("data set: {}", error);
}

Session::Session(const Request& request, const Front& front, std::unique_ptr<Progress> the_progress,
                 const std::atomic<bool>& the_stop)
    : setup(request, front),
      store(setup.cache, Access::read_write, families_of_share(setup.inputs)),
      resolver(setup.project, make_plan(setup.project, store), store),
      progress(std::move(the_progress)),
      stop(the_stop),
      keep_going(request.keep_going) {}

void Session::compute(int threads) {
  if (const std::size_t open = open_of_others(resolver); open > 0)
    spdlog::warn(
        "{} jobs of items that are left out come first, once: maps are matched to the mean over all items, "
        "as in a run over all; {} matches to the mean over these alone",
        open, as_option("reference", "items"));
  run_jobs(resolver, {threads, keep_going ? 0 : kTries}, *progress, stop);
}

double Session::seconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
}

}  // namespace salbench
