// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/commands/accept.h"

#include <memory>
#include <optional>
#include <set>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "cache/layout.h"
#include "cache/verify.h"
#include "io/file.h"
#include "pipeline/commands/gc.h"
#include "pipeline/commands/interrupt.h"
#include "pipeline/commands/session.h"
#include "pipeline/commands/subcommands.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

struct Result {
  Arrays arrays;
  std::int64_t version = 0;
  double seconds = 0;
};

// The newest sound result of an earlier version of the recipe's stage that reads as the kind it has now.
std::optional<Result> earlier_result(const FolderStore& store, Recipe recipe, std::string_view kind) {
  while (--recipe.stage_version > 0) {
    const auto path = store.path(recipe.stage, key_of(recipe));
    const auto bytes = path ? read_bytes(*path) : std::nullopt;
    if (!bytes) continue;
    Inspection found =
        inspect_artefact(*bytes, recipe.stage, *parse_artefact_name(path->filename().string()));
    if (!found.content) {
      spdlog::warn("{}: {}; not accepted", path->string(), found.fault);
      continue;
    }
    try {
      value_from(kind, found.content->arrays);
    } catch (const InputError& error) {
      spdlog::warn("{}: {}; not accepted", path->string(), error.what());
      continue;
    }
    const AttributeValue* seconds = find_attribute(found.content->attributes, "seconds");
    const double* number = seconds == nullptr ? nullptr : std::get_if<double>(seconds);
    return Result{std::move(found.content->arrays), recipe.stage_version, number == nullptr ? 0 : *number};
  }
  return {};
}

void accept_job(const Context& context, const Plan& plan, const JobRef& ref, FolderStore& store,
                Accepted& count) {
  const Job& job = plan[ref];
  if (job.verdict == Verdict::not_applicable) return;
  if (job.known()) {
    ++count.valid;
  } else if (key_is_unknown(job)) {
    ++count.waiting;
  } else if (const Recipe recipe = recipe_of(context, plan, ref);
             const auto result = earlier_result(store, recipe, context.row(ref).kind)) {
    ArtefactNote note{context.name(ref), result->seconds, context.attributes};
    note.attributes.emplace_back("accepted_from_version", result->version);
    store.save(recipe, context.row(ref).kind, result->arrays, note);
    ++count.accepted;
  } else {
    ++count.missing;
  }
}

ExitStatus run_accept(const Arguments& arguments, const std::string& stage, const std::atomic<bool>& stop) {
  const Setup setup(arguments, {}, Pictures::computed);
  require_cache(setup.cache);
  FolderStore store(setup.cache, Access::read_write);
  const OrderlyEnd orderly;
  const Accepted count = accept_stage(setup.context, stage, store, stop);
  if (!arguments.quiet) {
    fmt::print("{}: {} results of earlier versions accepted; {} were valid already, {} have none\n", stage,
               count.accepted, count.valid, count.missing);
    if (count.waiting > 0)
      fmt::print("{} could not be told: what they read is not there; accept or compute that first\n",
                 count.waiting);
  }
  return stop ? interrupted_status(arguments) : kAllDone;
}

}  // namespace

Accepted accept_stage(const Context& context, const std::string& stage, FolderStore& store,
                      const std::atomic<bool>& stop) {
  std::set<std::string> names;
  for (const Row& row : context.catalog.rows) names.insert(row.name);
  if (!names.contains(stage))
    throw ConfigError(fmt::format("there is no stage '{}'; there are {}", stage, fmt::join(names, ", ")));
  const Plan plan = make_plan(context, store);
  Accepted count;
  for (std::size_t row = 0; row < plan.jobs.size(); ++row)
    if (context.catalog.rows[row].name == stage)
      for (const Item& item : items_of(context, row))
        if (!stop) accept_job(context, plan, {row, item}, store, count);
  return count;
}

Subcommand accept_subcommand(Arguments& arguments) {
  const auto stage = std::make_shared<std::string>();
  return {"accept", "take results of a stage's earlier versions for those of its present one",
          cache_parameters(arguments, {config_parameter(arguments),
                                       {"STAGE", stage.get(), "such as fpfh or map.LS", true}}),
          [&arguments, stage](const std::atomic<bool>& stop) { return run_accept(arguments, *stage, stop); }};
}

}  // namespace salbench
