// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/plan/causes.h"

#include <algorithm>

#include <fmt/format.h>

#include "pipeline/catalog/depended_files.h"

namespace salbench {
namespace {

using Part = RecipeDifference::Part;

constexpr std::size_t kMaxNamed = 4;  // differences in one line; the others are counted

std::string joined(const std::vector<std::string>& parts) {
  const std::size_t named = std::min(parts.size(), kMaxNamed);
  std::string text =
      fmt::format("{}", fmt::join(parts.begin(), parts.begin() + static_cast<long>(named), ", "));
  return named == parts.size() ? text : fmt::format("{} and {} more", text, parts.size() - named);
}

std::string or_none(const std::string& value) { return value.empty() ? "none" : value; }

// Fate of an input that a key names.
std::string fate(const RecipeDifference& difference) {
  if (difference.before.empty()) return "added";
  return difference.after.empty() ? "removed" : "changed";
}

// The job that a key calls by this name among the inputs of another; nothing for a file.
std::optional<JobRef> input_named(const Context& context, const JobRef& job, const std::string& name) {
  for (std::size_t i = 0; i < context.row(job).inputs.size(); ++i) {
    const JobRef input = input_jobs(context, job, i)[0];
    if (context.row(input).name == name) return input;
  }
  return {};
}

// "mesh file .off" -> "mesh file 52.off": keys hold no names of files.
std::string source_text(const DatasetItem& source, const std::string& name) {
  for (const char* kind : {"mesh file ", "point cloud file "})
    if (name.starts_with(kind)) return kind + source.mesh.filename().string();
  if (name.starts_with("saliency file") && source.saliency.size() == 1)
    return "saliency file " + source.saliency[0].filename().string();
  return name;
}

// Words for a difference that are the same for every item.
std::string group_text(const Context& context, const JobRef& job, const RecipeDifference& difference) {
  const auto without_item = [&](const std::string& seed) {
    return or_none(seed.substr(0, std::min(seed.size(), seed.find('/'))));
  };
  switch (difference.part) {
    case Part::version:
      return fmt::format("stage version {} -> {}", difference.before, difference.after);
    case Part::option:
      if (difference.name.starts_with(kDependsOption))
        return fmt::format("{} {}", difference.name.substr(kDependsOption.size()), fate(difference));
      return fmt::format("{} {} -> {}", option_path(context.row(job), difference.name),
                         or_none(difference.before), or_none(difference.after));
    case Part::seed:
      return fmt::format("seed {} -> {}", without_item(difference.before), without_item(difference.after));
    case Part::input:
      return fmt::format("{}{} {}", input_named(context, job, difference.name) ? "input " : "",
                         difference.name, fate(difference));
    default:
      return "options or inputs in another order";
  }
}

// Members of a set are counted by their fate: "3 map.LS changed, 1 map.LS added".
std::vector<std::string> group_texts(const Context& context, const JobRef& job,
                                     const std::vector<RecipeDifference>& differences) {
  const Row& row = context.row(job);
  std::vector<std::string> parts;
  std::map<std::string, std::size_t> members;
  for (const RecipeDifference& difference : differences)
    if (row.gathers && difference.part == Part::input)
      ++members[fate(difference)];
    else
      parts.push_back(group_text(context, job, difference));
  for (const auto& [what, n] : members)
    parts.push_back(fmt::format("{} {} {}", n, context.catalog.rows[row.inputs[0]].name, what));
  return parts;
}

}  // namespace

Causes::Causes(const Context& context, const Plan& plan, std::filesystem::path cache, std::size_t limit)
    : context_(context), plan_(plan), book_(std::move(cache)), limit_(limit) {}

const Recipe* Causes::read(const ArtefactFile& file) {
  const auto known = recipes_.find(file.path);
  if (known != recipes_.end()) return known->second ? &*known->second : nullptr;
  ++opened_[file.stage];
  const auto& recipe = recipes_.emplace(file.path, read_recipe(file).recipe).first->second;
  return recipe ? &*recipe : nullptr;
}

Cause Causes::of(const JobRef& ref, bool verify) {
  const Job& job = plan_[ref];
  const bool hit = job.verdict == Verdict::cached;
  if (context_.row(ref).given) return {};
  if (job.verdict == Verdict::wait || (!hit && !job.known() && job.verdict != Verdict::compute) ||
      job.reason == Reason::unreadable)
    return {job.reason};
  const Recipe now = recipe_of(context_, plan_, ref);
  const Digest key = key_of(now);

  const std::filesystem::path* aside = book_.quarantined(key);
  if (aside != nullptr && (!hit || job.reason == Reason::damaged))
    return {Reason::damaged, {}, *aside, "a run moved it aside"};
  const auto& files = book_.artefacts(now.stage, context_.name(ref));
  if (hit || job.verdict == Verdict::compute) {
    for (const ArtefactFile& file : files) {
      if (file.name.key != key) continue;
      if (hit && !verify) return {job.reason, {}, file.path};
      if (std::string fault = read_recipe(file).fault; !fault.empty())
        return {Reason::damaged, {}, file.path, std::move(fault)};
      if (hit) return {Reason::none, {}, file.path};
    }
    if (hit) return {job.reason};
  }
  return nearest(files, now, key);
}

Cause Causes::nearest(const std::vector<ArtefactFile>& files, const Recipe& now, const Digest& key) {
  Cause nearest{Reason::never_computed};
  for (const ArtefactFile& file : files) {
    if (file.name.key == key) continue;
    if (opened_[file.stage] >= limit_) return {Reason::changed};
    const Recipe* recipe = read(file);
    if (recipe == nullptr) continue;
    auto found = differences(*recipe, now);
    if (nearest.reason == Reason::never_computed || found.size() < nearest.differences.size())
      nearest = {Reason::changed, std::move(found), file.path};
  }
  return nearest;
}

std::string Causes::line(const JobRef& job, const Cause& cause) {
  switch (cause.reason) {
    case Reason::none:
      return {};
    case Reason::input_pending:
      return waits(job);
    case Reason::input_failed:
      return group(job);
    case Reason::never_computed:
      return "no artefact of this stage and item";
    case Reason::damaged:
      return fmt::format("{}: {}", cause.file.string(), cause.fault);
    case Reason::changed: {
      std::vector<std::string> lines;
      for (const RecipeDifference& difference : cause.differences)
        lines.push_back(difference_line(job, difference));
      return joined(lines);
    }
    default:
      return std::string(name_of(cause.reason));
  }
}

std::string Causes::group(const JobRef& ref) {
  const Job& job = plan_[ref];
  if (job.verdict == Verdict::cached && job.reason == Reason::none)
    return {};  // without looking for its file
  const Cause cause = of(ref);
  if (cause.reason == Reason::input_pending || cause.reason == Reason::input_failed)
    return fmt::format("{} {}", name_of(cause.reason),
                       context_.catalog.rows[context_.row(ref).inputs[job.blocking_input]].name);
  if (cause.differences.empty()) return std::string(name_of(cause.reason));
  return joined(group_texts(context_, ref, cause.differences));
}

Why Causes::words() {
  return [this](const JobRef& job) { return group(job); };
}

Why Causes::words_of_computed() {
  return [this](const JobRef& job) { return plan_[job].computed() ? group(job) : ""; };
}

std::string Causes::difference_line(const JobRef& job, const RecipeDifference& difference) {
  if (difference.part == Part::seed)
    return fmt::format("seed {} -> {}", or_none(difference.before), or_none(difference.after));
  if (difference.part != Part::input) return group_text(context_, job, difference);
  if (context_.row(job).gathers) return fmt::format("that of {} {}", difference.name, fate(difference));
  const std::optional<JobRef> input = input_named(context_, job, difference.name);
  if (!input)
    return fmt::format("{} {}", source_text(context_.source(job.item), difference.name), fate(difference));
  const std::string changed_by = origin(*input, difference.before);
  return group_text(context_, job, difference) + (changed_by.empty() ? "" : fmt::format(" ({})", changed_by));
}

// From job to job, to the first that waits for nothing.
std::string Causes::waits(const JobRef& job) {
  if (context_.row(job).gathers) return waits_for_members(job);
  const JobRef awaited = input_jobs(context_, job, plan_[job].blocking_input)[0];
  std::string text = "waits for " + context_.row(awaited).name;
  if (awaited.item.is_set()) return text + ", " + line(awaited, of(awaited));
  if (awaited.item != job.item) text += " of " + context_.name(awaited);
  const Cause cause = of(awaited);
  return text + (cause.reason == Reason::input_pending ? ", " : ": ") + line(awaited, cause);
}

std::string Causes::waits_for_members(const JobRef& job) {
  std::vector<JobRef> open;
  for (const JobRef& member : input_jobs(context_, job, 0))
    if (plan_[member].open()) open.push_back(member);
  if (open.empty()) return std::string(name_of(Reason::changed));
  return fmt::format("waits for {} of {}{}: {}", context_.row(open[0]).name, context_.name(open[0]),
                     open.size() > 1 ? fmt::format(" and {} more", open.size() - 1) : "",
                     line(open[0], of(open[0])));
}

// How the earlier artefact of an input, known by its content, was made otherwise than the present one.
std::string Causes::origin(const JobRef& input, const std::string& content_before) {
  if (context_.row(input).given) return "given by --reference";
  const auto content = digest_from_hex(content_before);
  for (const ArtefactFile& file : book_.artefacts(context_.row(input).name, context_.name(input))) {
    if (!content || file.name.content != *content) continue;
    const Recipe* earlier = read(file);
    if (earlier == nullptr) continue;
    std::vector<std::string> lines;
    for (const RecipeDifference& difference : differences(*earlier, recipe_of(context_, plan_, input)))
      lines.push_back(difference_line(input, difference));
    return joined(lines);
  }
  return {};
}

}  // namespace salbench
