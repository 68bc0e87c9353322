#include "pipeline/plan.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "stages/scan/scan.h"

namespace salbench {
namespace {

Job verdict_of(Verdict verdict, Reason reason, std::size_t blocking_input = 0) {
  return {verdict, reason, static_cast<std::uint8_t>(blocking_input), {}, {}};
}

const Job& input_job(const Plan& plan, const ItemRef& item, const Input& input) {
  switch (input.from) {
    case Input::From::mesh:
      return plan.families[item.family].mesh[input.stage];
    case Input::From::reference:
      return plan.means[kReference][item.is_mesh() ? 0 : 1];
    default:
      return plan.jobs(item)[input.stage];
  }
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

// The files that a stage reads join its inputs; nothing where they allow it to go on.
std::optional<Job> add_sources(const Context& context, const ItemRef& item, const Stage& stage,
                               Recipe& recipe) {
  if (stage.source == Source::none) return {};
  const SourceFiles& files = sources_of(context, item, stage.source);
  if (files.empty())
    return verdict_of(Verdict::not_applicable,
                      stage.source == Source::map_file ? Reason::not_given : Reason::no_ground_truth);
  for (const SourceFile& file : files) {
    if (!file.digest) return verdict_of(Verdict::compute, Reason::unreadable);
    recipe.inputs.emplace_back(file.name, *file.digest);
  }
  return {};
}

Job looked_up(const Recipe& recipe, const Lookup& lookup) {
  Job job = verdict_of(Verdict::compute, Reason::never_computed);
  job.key = key_of(recipe);
  if (const auto content = lookup(recipe.stage, job.key)) {
    job.verdict = Verdict::cached;
    job.reason = Reason::none;
    job.content = *content;
  }
  return job;
}

}  // namespace

const std::string& input_name(const Context& context, const ItemRef& item, const Input& input) {
  switch (input.from) {
    case Input::From::mesh:
      return context.catalog.mesh[input.stage].name;
    case Input::From::reference:
      return context.catalog.means[kReference].name;
    default:
      return context.chain(item)[input.stage].name;
  }
}

std::string_view text_of(Reason reason) {
  switch (reason) {
    case Reason::never_computed:
      return "not in the cache";
    case Reason::changed:
      return "options, inputs, seed or version changed";
    case Reason::input_pending:
      return "waits for";
    case Reason::input_failed:
      return "failed input:";
    case Reason::no_ground_truth:
      return "no ground truth";
    case Reason::unreadable:
      return "a source file cannot be read";
    case Reason::damaged:
      return "damaged";
    case Reason::inapplicable:
      return "does not apply";
    case Reason::not_given:
      return "not given";
    case Reason::needs_all:
      return "needs the mean over all shards";
    default:
      return "";
  }
}

std::vector<Job>& Plan::jobs(const ItemRef& item) {
  FamilyJobs& family = families[item.family];
  return item.is_mesh() ? family.mesh : family.scans[static_cast<std::size_t>(item.view)];
}

const std::vector<Job>& Plan::jobs(const ItemRef& item) const { return const_cast<Plan*>(this)->jobs(item); }

std::string Context::name(const ItemRef& item) const {
  const std::string& mesh = source(item).name;
  return item.is_mesh() ? mesh : fmt::format("{}_{}", mesh, item.view);
}

std::vector<ItemRef> Context::family(std::size_t f) const {
  std::vector<ItemRef> items = {{f, -1}};
  if (!catalog.scan.empty())
    for (int view = 0; view < kViews; ++view) items.push_back({f, view});
  return items;
}

std::vector<ItemRef> Context::items() const {
  std::vector<ItemRef> all;
  for (std::size_t f = 0; f < workload.families.size(); ++f)
    for (const ItemRef& item : family(f)) all.push_back(item);
  return all;
}

std::vector<ItemRef> Context::items(bool meshes) const {
  std::vector<ItemRef> result;
  for (std::size_t f = 0; f < workload.families.size(); ++f)
    for (const ItemRef& item : family(f))
      if (item.is_mesh() == meshes) result.push_back(item);
  return result;
}

SourceFiles& sources_of(const Context& context, const ItemRef& item, Source source) {
  Family& family = context.workload.families[item.family];
  switch (source) {
    case Source::mesh_file:
      return family.mesh_file;
    case Source::map_file:
      return family.map_files.at(static_cast<std::size_t>(item.view + 1));
    default:
      return family.truth_files;
  }
}

Decision decide(const Context& context, const Plan& plan, const ItemRef& item, std::size_t index,
                const Lookup& lookup) {
  const Stage& stage = context.chain(item)[index];
  if (stage.applies && !stage.applies(context.source(item)))
    return {verdict_of(Verdict::not_applicable, Reason::inapplicable), {}};
  Recipe recipe{stage.name, stage.version, {}, {}, {}};
  for (const OptionLines& options : stage.options) recipe.options += options.text;
  if (stage.per_view) recipe.options += fmt::format("view: {}\n", item.view);
  if (stage.seeded) recipe.seed = fmt::format("{}/{}", context.seed, context.name(item));
  std::optional<Job> stopped;  // by what is absent, where anything is: there is nothing to wait for then
  for (std::size_t i = 0; i < stage.inputs.size(); ++i) {
    const Job& input = input_job(plan, item, stage.inputs[i]);
    const std::optional<Job> by_this = stopped_by(input, i);
    if (by_this && (!stopped || by_this->verdict == Verdict::not_applicable)) stopped = by_this;
    recipe.inputs.emplace_back(input_name(context, item, stage.inputs[i]), input.content);
  }
  if (stopped) return {*stopped, {}};
  if (const auto no_source = add_sources(context, item, stage, recipe)) return {*no_source, {}};
  Job job = looked_up(recipe, lookup);
  return {job, std::move(recipe)};
}

// Items whose share of it fails are left out of a mean: one bad file must not stop a whole data set.
Decision decide_mean(const Context& context, const Plan& plan, std::size_t index, bool meshes,
                     const Lookup& lookup) {
  const MeanHistogram& mean = context.catalog.means[index];
  if (index == kReference && context.given_reference) {
    Job job = verdict_of(Verdict::done, Reason::none);
    job.content = content_digest(arrays_from(*context.given_reference));
    return {job, {}};
  }
  if (context.shard) return {verdict_of(Verdict::not_applicable, Reason::needs_all), {}};
  const Chain& chain = meshes ? context.catalog.mesh : context.catalog.scan;
  const std::string& averaged = meshes ? mean.of_mesh : mean.of_scan;
  if (!has_stage(chain, averaged)) return {verdict_of(Verdict::not_applicable, Reason::none), {}};
  const std::size_t stage = stage_index(chain, averaged);
  Recipe recipe{mean.name, mean.version, {}, {}, {}};
  for (const ItemRef& item : context.items(meshes)) {
    const Job& job = plan.jobs(item)[stage];
    if (job.open()) return {verdict_of(Verdict::wait, Reason::input_pending), {}};
    if (job.known()) recipe.inputs.emplace_back(context.name(item), job.content);
  }
  if (recipe.inputs.empty()) return {verdict_of(Verdict::not_applicable, Reason::no_ground_truth), {}};
  Job job = looked_up(recipe, lookup);
  return {job, std::move(recipe)};
}

Plan make_plan(const Context& context, const Index& index) {
  const Lookup lookup = [&](std::string_view stage, const Digest& key) { return index.find(stage, key); };
  Plan plan;
  plan.families.resize(context.workload.families.size());
  const auto decide_stages = [&](bool after_reference) {
    for (std::size_t f = 0; f < plan.families.size(); ++f) {
      for (const ItemRef& item : context.family(f)) {
        const Chain& chain = context.chain(item);
        for (std::size_t stage = 0; stage < chain.size(); ++stage) {
          if (chain[stage].after_reference != after_reference) continue;
          Job job = decide(context, plan, item, stage, lookup).job;
          if (job.reason == Reason::never_computed && index.has_item(chain[stage].name, context.name(item)))
            job.reason = Reason::changed;
          plan.jobs(item)[stage] = job;
        }
      }
    }
  };
  for (Plan::FamilyJobs& family : plan.families) {
    family.mesh.resize(context.catalog.mesh.size());
    if (!context.catalog.scan.empty())
      family.scans.assign(kViews, std::vector<Job>(context.catalog.scan.size()));
  }
  decide_stages(false);
  plan.means.resize(context.catalog.means.size());
  for (std::size_t mean = 0; mean < plan.means.size(); ++mean)
    for (const bool meshes : {true, false})
      plan.means[mean][meshes ? 0 : 1] = decide_mean(context, plan, mean, meshes, lookup).job;
  decide_stages(true);
  return plan;
}

namespace {

// The rows of a count, in the order in which their names first come up.
class Counter {
 public:
  void add(const std::string& stage, std::int32_t version, const Job& job, const std::string& reason) {
    const auto [row, fresh] = row_of_.try_emplace(stage, counts_.size());
    if (fresh) {
      counts_.push_back({.stage = stage, .version = version, .reasons = {}});
      reasons_.emplace_back();
    }
    ++tally(counts_[row->second], job.verdict);
    if (!reason.empty()) ++reasons_[row->second][reason];
  }

  std::vector<StageCount> counts() && {
    for (std::size_t row = 0; row < counts_.size(); ++row) {
      auto& reasons = counts_[row].reasons;
      reasons.assign(reasons_[row].begin(), reasons_[row].end());
      std::stable_sort(reasons.begin(), reasons.end(),
                       [](const auto& a, const auto& b) { return a.second > b.second; });
    }
    return std::move(counts_);
  }

 private:
  static std::size_t& tally(StageCount& count, Verdict verdict) {
    switch (verdict) {
      case Verdict::cached:
      case Verdict::done:
        return count.cached;
      case Verdict::compute:
        return count.compute;
      case Verdict::wait:
        return count.wait;
      case Verdict::not_applicable:
        return count.absent;
      default:
        return count.failed;
    }
  }

  std::vector<StageCount> counts_;
  std::vector<std::map<std::string, std::size_t>> reasons_;
  std::map<std::string, std::size_t> row_of_;
};

}  // namespace

std::vector<StageCount> count_by_stage(const Context& context, const Plan& plan, const Why& why) {
  Counter counter;
  for (std::size_t f = 0; f < plan.families.size(); ++f) {
    for (const ItemRef& item : context.family(f)) {
      const Chain& chain = context.chain(item);
      for (std::size_t s = 0; s < chain.size(); ++s)
        counter.add(chain[s].name, chain[s].version, plan.jobs(item)[s],
                    why.of_stage ? why.of_stage(item, s) : "");
    }
  }
  for (std::size_t m = 0; m < plan.means.size(); ++m) {
    const MeanHistogram& mean = context.catalog.means[m];
    for (const bool meshes : {true, false})
      counter.add(mean.name, mean.version, plan.means[m][meshes ? 0 : 1],
                  why.of_mean ? why.of_mean(m, meshes) : "");
  }
  return std::move(counter).counts();
}

}  // namespace salbench
