// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/plan/plan.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "stages/core/parallel.h"
#include "stages/scan/scan.h"

namespace salbench {
namespace {

constexpr std::size_t kItemGrain = 64;  // items of a row that are planned by one thread at a time

Job verdict_of(Verdict verdict, Reason reason, std::size_t blocking_input = 0) {
  return {verdict, reason, static_cast<std::uint8_t>(blocking_input), {}, {}};
}

// Takes over the verdict of an input that is not known; nothing where it is.
std::optional<Job> stopped_by(const Job& input, std::size_t index) {
  switch (input.verdict) {
    case Verdict::cached:
    case Verdict::done:
      return {};
    case Verdict::not_applicable:
      return verdict_of(Verdict::not_applicable, input.reason, index);
    case Verdict::failed:
    case Verdict::blocked:
      return verdict_of(Verdict::blocked, Reason::input_failed, index);
    default:
      return verdict_of(Verdict::wait, Reason::input_pending, index);
  }
}

// An input that does not apply goes before one to wait for: there is nothing to wait for then.
std::optional<Job> stopped_by_inputs(const Context& context, const Plan& plan, const JobRef& job) {
  std::optional<Job> stopped;
  for (std::size_t i = 0; i < context.row(job).inputs.size(); ++i) {
    const std::optional<Job> by_this = stopped_by(plan[input_jobs(context, job, i)[0]], i);
    if (by_this && (!stopped || by_this->verdict == Verdict::not_applicable)) stopped = by_this;
  }
  return stopped;
}

// Members that fail or do not apply are left out: one bad file must not stop a whole data set.
std::optional<Job> stopped_by_members(const Context& context, const Plan& plan, const JobRef& job) {
  if (context.shard) return verdict_of(Verdict::not_applicable, Reason::needs_all);
  bool any_known = false;
  for (const JobRef& member : input_jobs(context, job, 0)) {
    if (plan[member].open()) return verdict_of(Verdict::wait, Reason::input_pending);
    any_known |= plan[member].known();
  }
  if (any_known) return {};
  return verdict_of(Verdict::not_applicable, Reason::no_ground_truth);
}

std::optional<Job> stopped_by_sources(const Context& context, const JobRef& job) {
  const Source source = context.row(job).source;
  if (source == Source::none) return {};
  const SourceFiles& files = sources_of(context, job);
  if (files.empty())
    return verdict_of(Verdict::not_applicable,
                      source == Source::map_file ? Reason::not_given : Reason::no_ground_truth);
  if (std::any_of(files.begin(), files.end(), [](const SourceFile& file) { return !file.digest; }))
    return verdict_of(Verdict::compute, Reason::unreadable);
  return {};
}

// Why a job cannot be looked up; nothing where its recipe is complete.
std::optional<Job> stopped(const Context& context, const Plan& plan, const JobRef& job) {
  const Row& row = context.row(job);
  if (row.applies && !row.applies(context.source(job.item)))
    return verdict_of(Verdict::not_applicable, Reason::inapplicable);
  if (row.gathers) return stopped_by_members(context, plan, job);
  if (const auto by_input = stopped_by_inputs(context, plan, job)) return by_input;
  return stopped_by_sources(context, job);
}

}  // namespace

std::string Context::name(const Item& item) const {
  const std::string& shape = source(item).name;
  return item.is_scan() ? fmt::format("{}_{}", shape, item.view) : shape;
}

std::string Context::name(const JobRef& job) const {
  return job.item.is_set() ? std::string(name_of(row(job).shapes)) : name(job.item);
}

std::vector<Item> family_items(const Context& context, std::size_t family) {
  const std::vector<Row>& rows = context.catalog.rows;
  std::vector<Item> items = {context.workload.families[family].shape(family)};
  if (items.front().is_mesh() &&
      std::any_of(rows.begin(), rows.end(), [](const Row& row) { return row.shapes == Shapes::scans; }))
    for (int view = 0; view < kViews; ++view) items.push_back({family, view});
  return items;
}

std::vector<Item> all_items(const Context& context) {
  std::vector<Item> all;
  for (std::size_t f = 0; f < context.workload.families.size(); ++f)
    for (const Item& item : family_items(context, f)) all.push_back(item);
  return all;
}

std::vector<Item> items_of(const Context& context, std::size_t row) {
  const Row& of = context.catalog.rows[row];
  if (of.gathers) return {Item::set()};
  std::vector<Item> items;
  for (std::size_t f = 0; f < context.workload.families.size(); ++f) {
    const Family& family = context.workload.families[f];
    if (of.shapes == family.shapes()) items.push_back(family.shape(f));
    for (int view = 0; of.shapes == Shapes::scans && !family.is_cloud && view < kViews; ++view)
      items.push_back({f, view});
  }
  return items;
}

std::vector<JobRef> jobs_of(const Catalog& catalog, const Item& item) {
  std::vector<JobRef> jobs;
  for (std::size_t row = 0; row < catalog.rows.size(); ++row)
    if (catalog.rows[row].scope() == item.scope()) jobs.push_back({row, item});
  return jobs;
}

std::optional<Item> find_item(const Context& context, const std::string& name) {
  for (const bool scans : {false, true})  // a mesh may be called like a scan
    for (const Item& item : all_items(context))
      if (item.is_scan() == scans && context.name(item) == name) return item;
  return {};
}

std::vector<JobRef> input_jobs(const Context& context, const JobRef& job, std::size_t input) {
  const Row& row = context.row(job);
  const std::size_t read = row.inputs[input];
  const Row& of = context.catalog.rows[read];
  if (of.gathers) return {{read, Item::set()}};
  if (!row.gathers) return {{read, of.shapes == Shapes::meshes ? Item::mesh(job.item.family) : job.item}};
  std::vector<JobRef> members;
  for (const Item& item : items_of(context, read)) members.push_back({read, item});
  return members;
}

SourceFiles& sources_of(const Context& context, const JobRef& job) {
  static SourceFiles none;
  Family& family = context.workload.families[job.item.family];
  switch (context.row(job).source) {
    case Source::shape_file:
      return family.shape_file;
    case Source::map_file:
      return family.map_files.at(job.item.in_family());
    case Source::truth_files:
      return family.truth_files;
    default:
      return none;
  }
}

Recipe recipe_of(const Context& context, const Plan& plan, const JobRef& job) {
  const Row& row = context.row(job);
  Recipe recipe{row.name, row.version, {}, {}, {}};
  for (const OptionLines& options : row.options) recipe.options += options.in_key;
  if (row.per_view) recipe.options += fmt::format("view: {}\n", job.item.view);
  if (row.seeded) recipe.seed = fmt::format("{}/{}", context.seed, context.name(job));
  for (std::size_t i = 0; i < row.inputs.size(); ++i)
    for (const JobRef& input : input_jobs(context, job, i))
      if (!row.gathers)
        recipe.inputs.emplace_back(context.row(input).name, plan[input].content);
      else if (plan[input].known())
        recipe.inputs.emplace_back(context.name(input), plan[input].content);
  if (row.gathers) return recipe;
  for (const SourceFile& file : sources_of(context, job))
    if (file.digest) recipe.inputs.emplace_back(file.name, *file.digest);
  return recipe;
}

Job decide(const Context& context, const Plan& plan, const JobRef& job, const Lookup& lookup) {
  if (const ValuePtr& given = context.row(job).given) {
    Job known = verdict_of(Verdict::done, Reason::none);
    known.content = content_digest(arrays_from(*given));
    return known;
  }
  if (const auto without_key = stopped(context, plan, job)) return *without_key;
  Job decided = verdict_of(Verdict::compute, Reason::never_computed);
  decided.key = key_of(recipe_of(context, plan, job));
  if (const auto content = lookup(context.row(job).name, decided.key)) {
    decided.verdict = Verdict::cached;
    decided.reason = Reason::none;
    decided.content = *content;
  } else if (context.row(job).only_if_cached) {
    return verdict_of(Verdict::not_applicable, Reason::only_cached);
  }
  return decided;
}

std::size_t slot_count(const Context& context, std::size_t row) {
  const Row& of = context.catalog.rows[row];
  if (of.gathers) return 1;
  return context.workload.families.size() * (of.shapes == Shapes::scans ? kViews : 1);
}

Plan make_plan(const Context& context, const Index& index) {
  const Lookup lookup = [&](std::string_view stage, const Digest& key) { return index.find(stage, key); };
  Plan plan;
  plan.jobs.resize(context.catalog.rows.size());
  for (std::size_t row = 0; row < plan.jobs.size(); ++row) {
    plan.jobs[row].resize(slot_count(context, row), verdict_of(Verdict::not_applicable, Reason::none));
    const std::vector<Item> items = items_of(context, row);
    parallel_ranges(items.size(), kItemGrain, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) {
        const JobRef job{row, items[i]};
        Job decided = decide(context, plan, job, lookup);
        if (decided.reason == Reason::never_computed &&
            index.has_item(context.row(job).name, context.name(job)))
          decided.reason = Reason::changed;
        plan[job] = decided;
      }
    });
  }
  return plan;
}

std::size_t count_open(const std::vector<Job>& jobs) {
  return static_cast<std::size_t>(
      std::count_if(jobs.begin(), jobs.end(), [](const Job& job) { return job.open(); }));
}

namespace {

std::size_t& tally(RowCount& count, Verdict verdict) {
  switch (verdict) {
    case Verdict::cached:
    case Verdict::done:
      return count.cached;
    case Verdict::compute:
      return count.compute;
    case Verdict::wait:
      return count.wait;
    case Verdict::not_applicable:
      return count.not_applicable;
    default:
      return count.failed;
  }
}

void add_counts(const Context& context, const Plan& plan, std::size_t row, const Why& why, RowCount& count) {
  std::map<std::string, std::size_t> reasons(count.reasons.begin(), count.reasons.end());
  for (const Item& item : items_of(context, row)) {
    const JobRef job{row, item};
    ++tally(count, plan[job].verdict);
    if (const std::string reason = why ? why(job) : ""; !reason.empty()) ++reasons[reason];
  }
  count.reasons.assign(reasons.begin(), reasons.end());
  std::stable_sort(count.reasons.begin(), count.reasons.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
}

}  // namespace

std::vector<RowCount> count_by_name(const Context& context, const Plan& plan, const Why& why) {
  std::vector<RowCount> counts;
  for (std::size_t r = 0; r < context.catalog.rows.size(); ++r) {
    const Row& row = context.catalog.rows[r];
    auto count =
        std::find_if(counts.begin(), counts.end(), [&](const RowCount& of) { return of.stage == row.name; });
    if (count == counts.end())
      count = counts.insert(count, {.stage = row.name, .version = row.version, .reasons = {}});
    add_counts(context, plan, r, why, *count);
  }
  return counts;
}

}  // namespace salbench
