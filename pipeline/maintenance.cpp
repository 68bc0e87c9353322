#include "pipeline/maintenance.h"

#include <algorithm>
#include <optional>
#include <set>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "cache/layout.h"
#include "io/file.h"
#include "io/table.h"
#include "io/value.h"
#include "pipeline/interrupt.h"
#include "stages/core/errors.h"
#include "stages/core/rng.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

bool key_is_unknown(const Job& job) {
  switch (job.verdict) {
    case Verdict::cached:
    case Verdict::done:
    case Verdict::not_applicable:
      return false;
    case Verdict::compute:
      return job.reason == Reason::unreadable;
    default:
      return true;
  }
}

// --- computing a sample again -----------------------------------------------------------------------------

struct StageOfItem {
  ItemRef item;
  std::size_t stage = 0;
};

std::vector<StageOfItem> cached_jobs(const Context& context, const Plan& plan) {
  std::vector<StageOfItem> jobs;
  for (std::size_t f = 0; f < plan.families.size(); ++f)
    for (const ItemRef& item : context.family(f))
      for (std::size_t s = 0; s < context.chain(item).size(); ++s)
        if (plan.jobs(item)[s].verdict == Verdict::cached) jobs.push_back({item, s});
  return jobs;
}

std::optional<Value> stored(FolderStore& store, std::string_view stage, std::string_view kind,
                            const Job& job) {
  const auto arrays = store.load(stage, job.key);
  return arrays ? std::optional(value_from(kind, *arrays)) : std::nullopt;
}

std::optional<Value> stored_input(const Context& context, const Plan& plan, FolderStore& store,
                                  const ItemRef& item, const Input& input) {
  switch (input.from) {
    case Input::From::mesh: {
      const Stage& stage = context.catalog.mesh[input.stage];
      return stored(store, stage.name, stage.kind, plan.families[item.family].mesh[input.stage]);
    }
    case Input::From::reference:
      if (context.given_reference) return *context.given_reference;
      return stored(store, context.catalog.means[kReference].name, "histogram",
                    plan.means[kReference][item.is_mesh() ? 0 : 1]);
    default: {
      const Stage& stage = context.chain(item)[input.stage];
      return stored(store, stage.name, stage.kind, plan.jobs(item)[input.stage]);
    }
  }
}

// Recomputes a cached job and describes the first difference; empty if there is none.
std::string recomputed_fault(const Context& context, const Plan& plan, FolderStore& store,
                             const StageOfItem& job) {
  const Stage& stage = context.chain(job.item)[job.stage];
  try {
    std::vector<Value> values;
    for (const Input& input : stage.inputs) {
      auto value = stored_input(context, plan, store, job.item, input);
      if (!value) return "cannot be computed again: something that it reads is damaged";
      values.push_back(std::move(*value));
    }
    StageInputs inputs{.values = {},
                       .files = {},
                       .source = &context.source(job.item),
                       .seed = context.seed,
                       .item = context.name(job.item),
                       .view = job.item.view};
    for (const Value& value : values) inputs.values.push_back(&value);
    if (stage.source != Source::none)
      inputs.files = read_unchanged(sources_of(context, job.item, stage.source));
    const Digest content = content_digest(arrays_from(stage.run(inputs)));
    if (content == plan.jobs(job.item)[job.stage].content) return {};
    return fmt::format(
        "computed again, its content is {}: the stage is not deterministic, or its version was not raised",
        content.hex());
  } catch (const InputError& error) {
    return fmt::format("cannot be computed again: {}", error.what());
  } catch (const StorageError&) {
    throw;
  } catch (...) {
    return current_defect();
  }
}

// --- accepting --------------------------------------------------------------------------------------------

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

void accept_job(const Context& context, const Decision& decision, std::string_view kind,
                const std::string& item, FolderStore& store, Accepted& count) {
  if (decision.job.verdict == Verdict::not_applicable) return;
  if (decision.job.known()) {
    ++count.valid;
  } else if (key_is_unknown(decision.job)) {
    ++count.waiting;
  } else if (const auto result = earlier_result(store, decision.recipe, kind)) {
    ArtefactNote note{item, result->seconds, context.attributes};
    note.attributes.emplace_back("accepted_from_version", result->version);
    store.save(decision.recipe, kind, result->arrays, note);
    ++count.accepted;
  } else {
    ++count.missing;
  }
}

std::set<std::string> stage_names(const Catalog& catalog) {
  std::set<std::string> names;
  for (const Chain* chain : {&catalog.mesh, &catalog.scan})
    for (const Stage& stage : *chain) names.insert(stage.name);
  for (const MeanHistogram& mean : catalog.means) names.insert(mean.name);
  return names;
}

// --- the command line -------------------------------------------------------------------------------------

Arguments with_config(Arguments arguments, const std::string& config) {
  arguments.config = config;
  return arguments;
}

Cell as_cell(std::size_t count) { return static_cast<std::int64_t>(count); }
double megabytes(std::uint64_t bytes) { return static_cast<double>(bytes) / 1e6; }

void print_faults(const std::vector<Fault>& faults) {
  for (const Fault& fault : faults) fmt::print("{}: {}\n", fault.file.string(), fault.what);
}

std::size_t verify_folder(const fs::path& folder, bool quiet, const std::atomic<bool>& stop) {
  const OrderlyEnd orderly;
  const Verification result = verify_cache(folder, stop, *progress_of(quiet));
  print_faults(result.faults);
  if (!quiet)
    fmt::print("{}: {} artefacts, {:.1f} MB: {} bad{}\n", folder.string(), result.artefacts,
               megabytes(result.bytes), result.faults.size(),
               result.others > 0 ? fmt::format("; {} other files, left alone", result.others) : "");
  return result.faults.size();
}

std::size_t verify_sample(const Setup& setup, std::size_t sample, bool quiet, const std::atomic<bool>& stop) {
  FolderStore store(setup.cache, Access::read_only);
  const Plan plan = make_plan(setup.context, store);
  const OrderlyEnd orderly;
  const Recomputation result = recompute_sample(setup.context, plan, store, sample, stop);
  print_faults(result.faults);
  if (!quiet)
    fmt::print("{}: {} of its jobs computed again: {} came out otherwise\n", setup.config.name, result.jobs,
               result.faults.size());
  return result.faults.size();
}

void print_collected(const Collected& collected, std::size_t waiting, bool dry_run) {
  Table table{.columns = {"stage", "kept", "MB", dry_run ? "to remove" : "removed", "MB"}, .rows = {}};
  Amount removed;
  for (const Collected::OfStage& stage : collected.stages) {
    table.rows.push_back({stage.stage, as_cell(stage.kept.files), megabytes(stage.kept.bytes),
                          as_cell(stage.removed.files), megabytes(stage.removed.bytes)});
    removed.files += stage.removed.files;
    removed.bytes += stage.removed.bytes;
  }
  fmt::print("{}\n", aligned(table, 1));
  fmt::print("{}: {} artefacts ({:.1f} MB), {} damaged ones, {} unfinished files\n",
             dry_run ? "would be removed" : "removed", removed.files, megabytes(removed.bytes),
             collected.damaged.files, collected.unfinished.files);
  if (waiting > 0)
    fmt::print("{} jobs wait for what they read: everything of their stages and items was kept\n", waiting);
}

}  // namespace

std::size_t add_needed(const Context& context, const Plan& plan, KeepSet& needed) {
  std::size_t unknown = 0;
  const auto add = [&](const std::string& stage, const std::string& item, const Job& job) {
    if (key_is_unknown(job)) {
      needed.add_every_key(stage, item);
      ++unknown;
    } else if (job.verdict != Verdict::not_applicable) {
      needed.add(stage, job.key);  // also of a job to compute: another process may be storing it now
    }
  };
  for (std::size_t f = 0; f < plan.families.size(); ++f)
    for (const ItemRef& item : context.family(f))
      for (std::size_t s = 0; s < context.chain(item).size(); ++s)
        add(context.chain(item)[s].name, context.name(item), plan.jobs(item)[s]);
  for (std::size_t mean = 0; mean < plan.means.size(); ++mean)
    for (const bool meshes : {true, false})
      add(context.catalog.means[mean].name, meshes ? "meshes" : "scans", plan.means[mean][meshes ? 0 : 1]);
  return unknown;
}

Recomputation recompute_sample(const Context& context, const Plan& plan, FolderStore& store,
                               std::size_t sample, const std::atomic<bool>& stop) {
  std::vector<StageOfItem> jobs = cached_jobs(context, plan);
  Rng rng(context.seed, "verify", "");
  Recomputation result;
  for (std::size_t i = 0; i < std::min(sample, jobs.size()) && !stop; ++i) {
    std::swap(jobs[i], jobs[i + rng.below(jobs.size() - i)]);
    const std::string& stage = context.chain(jobs[i].item)[jobs[i].stage].name;
    const auto file = store.path(stage, plan.jobs(jobs[i].item)[jobs[i].stage].key);
    std::string fault = recomputed_fault(context, plan, store, jobs[i]);
    if (!fault.empty()) result.faults.push_back({file.value_or(stage), std::move(fault)});
    ++result.jobs;
  }
  return result;
}

Accepted accept_stage(const Context& context, const std::string& stage, FolderStore& store,
                      const std::atomic<bool>& stop) {
  const std::set<std::string> names = stage_names(context.catalog);
  if (!names.contains(stage))
    throw ConfigError(fmt::format("there is no stage '{}'; there are {}", stage, fmt::join(names, ", ")));
  const Lookup lookup = [&](std::string_view of, const Digest& key) { return store.find(of, key); };
  const Plan plan = make_plan(context, store);
  Accepted count;
  for (std::size_t f = 0; f < plan.families.size(); ++f)
    for (const ItemRef& item : context.family(f)) {
      const Chain& chain = context.chain(item);
      if (stop || !has_stage(chain, stage)) continue;
      const std::size_t index = stage_index(chain, stage);
      accept_job(context, decide(context, plan, item, index, lookup), chain[index].kind, context.name(item),
                 store, count);
    }
  for (std::size_t mean = 0; mean < plan.means.size(); ++mean)
    for (const bool meshes : {true, false})
      if (!stop && context.catalog.means[mean].name == stage)
        accept_job(context, decide_mean(context, plan, mean, meshes, lookup), "histogram",
                   meshes ? "meshes" : "scans", store, count);
  return count;
}

ExitStatus verify_command(const Arguments& arguments, const VerifyOptions& options,
                          const std::atomic<bool>& stop) {
  if (options.configs.empty() && (arguments.cache.empty() || options.deep))
    throw ConfigError(options.deep ? "--deep needs a configuration: it says what to compute again"
                                   : "name a configuration, or a cache with --cache DIR");
  std::size_t faults = 0;
  std::set<fs::path> seen;
  if (options.configs.empty()) faults += verify_folder(arguments.cache, arguments.quiet, stop);
  for (const std::string& config : options.configs) {
    const Setup setup(with_config(arguments, config));
    if (seen.insert(fs::weakly_canonical(setup.cache)).second)
      faults += verify_folder(setup.cache, arguments.quiet, stop);
    if (options.deep) faults += verify_sample(setup, options.sample, arguments.quiet, stop);
  }
  if (stop) return interrupted_status(arguments);
  return faults == 0 ? kAllDone : kSomeFailed;
}

ExitStatus gc_command(const Arguments& arguments, const GcOptions& options) {
  KeepSet needed;
  std::size_t waiting = 0;
  fs::path folder;
  for (const std::string& config : options.configs) {
    const Setup setup(with_config(arguments, config));
    if (!folder.empty() && fs::weakly_canonical(folder) != fs::weakly_canonical(setup.cache))
      throw ConfigError(fmt::format("{}: its cache is {}, not {}: clean one cache at a time", config,
                                    setup.cache.string(), folder.string()));
    folder = setup.cache;
    const FolderStore store(folder, Access::read_only);
    waiting += add_needed(setup.context, make_plan(setup.context, store), needed);
  }
  const Collected collected = collect_garbage(folder, needed, options.dry_run, *progress_of(arguments.quiet));
  if (!arguments.quiet) print_collected(collected, waiting, options.dry_run);
  return kAllDone;
}

ExitStatus accept_command(const Arguments& arguments, const std::string& stage,
                          const std::atomic<bool>& stop) {
  const Setup setup(arguments);
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

}  // namespace salbench
