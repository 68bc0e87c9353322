#include "pipeline/causes.h"

#include <algorithm>

#include <fmt/format.h>

namespace salbench {
namespace {

using Part = RecipeDifference::Part;

constexpr std::size_t kMostNamed = 4;  // differences in one line; the others are counted

std::string joined(const std::vector<std::string>& parts) {
  const std::size_t named = std::min(parts.size(), kMostNamed);
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

std::string version_text(const RecipeDifference& difference) {
  return fmt::format("stage version {} -> {}", difference.before, difference.after);
}

const Input* input_named(const Context& context, const ItemRef& item, const Stage& stage,
                         const std::string& name) {
  for (const Input& input : stage.inputs)
    if (input_name(context, item, input) == name) return &input;
  return nullptr;
}

// "mesh file .off" -> "mesh file 52.off": keys hold no names of files.
std::string source_text(const DatasetItem& source, const std::string& name) {
  if (name.starts_with("mesh file ")) return "mesh file " + source.mesh.filename().string();
  if (name == "saliency file" && !source.saliency.empty())
    return "saliency file " + source.saliency.filename().string();
  return name;
}

// Words for a difference that are the same for every item.
std::string group_text(const Context& context, const ItemRef& item, const Stage& stage,
                       const RecipeDifference& difference) {
  const auto without_item = [&](const std::string& seed) {
    return or_none(seed.substr(0, std::min(seed.size(), seed.find('/'))));
  };
  switch (difference.part) {
    case Part::version:
      return version_text(difference);
    case Part::option:
      return fmt::format("{} {} -> {}", option_path(stage, difference.name), or_none(difference.before),
                         or_none(difference.after));
    case Part::seed:
      return fmt::format("seed {} -> {}", without_item(difference.before), without_item(difference.after));
    case Part::input:
      return fmt::format("{}{} {}",
                         input_named(context, item, stage, difference.name) == nullptr ? "" : "input ",
                         difference.name, fate(difference));
    default:
      return "options or inputs in another order";
  }
}

const Lookup kNowhere = [](std::string_view, const Digest&) { return std::nullopt; };

}  // namespace

struct Causes::Product {
  ItemRef item;           // of a stage; else of a mean
  std::string stage;      // folder in the cache
  std::string label;      // of the item
  std::size_t index = 0;  // in the item's chain
  bool is_mean = false;
};

Causes::Causes(const Context& context, const Plan& plan, std::filesystem::path cache, std::size_t limit)
    : context_(context), plan_(plan), book_(std::move(cache)), limit_(limit) {}

const Recipe* Causes::read(const ArtefactFile& file) {
  const auto known = recipes_.find(file.path);
  if (known != recipes_.end()) return known->second ? &*known->second : nullptr;
  ++opened_[file.stage];
  const auto& recipe = recipes_.emplace(file.path, read_recipe(file).recipe).first->second;
  return recipe ? &*recipe : nullptr;
}

Cause Causes::of(const ItemRef& item, std::size_t index, bool verify) {
  const Job& job = plan_.jobs(item)[index];
  const Stage& stage = context_.chain(item)[index];
  const bool hit = job.verdict == Verdict::cached;
  if (job.verdict == Verdict::wait || (!hit && !job.known() && job.verdict != Verdict::compute))
    return {job.reason};
  const Decision decision = decide(context_, plan_, item, index, kNowhere);
  if (decision.job.reason == Reason::unreadable) return {Reason::unreadable};
  const Digest key = key_of(decision.recipe);

  const std::filesystem::path* aside = book_.quarantined(key);
  if (aside != nullptr && (!hit || job.reason == Reason::damaged))
    return {Reason::damaged, {}, *aside, "a run moved it aside"};
  const auto& files = book_.artefacts(stage.name, context_.name(item));
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

  return nearest(files, decision.recipe, key);
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

std::string Causes::line(const ItemRef& item, std::size_t index, const Cause& cause) {
  switch (cause.reason) {
    case Reason::none:
      return {};
    case Reason::input_pending:
      return waits(item, index);
    case Reason::input_failed:
      return group(item, index);
    case Reason::never_computed:
      return "no artefact of this stage and item";
    case Reason::damaged:
      return fmt::format("{}: {}", cause.file.string(), cause.fault);
    case Reason::changed: {
      std::vector<std::string> lines;
      for (const RecipeDifference& difference : cause.differences)
        lines.push_back(difference_line(item, context_.chain(item)[index], difference));
      return joined(lines);
    }
    default:
      return std::string(text_of(cause.reason));
  }
}

std::string Causes::group(const ItemRef& item, std::size_t index) {
  const Job& job = plan_.jobs(item)[index];
  if (job.verdict == Verdict::cached && job.reason == Reason::none)
    return {};  // without looking for its file
  const Stage& stage = context_.chain(item)[index];
  const Cause cause = of(item, index);
  if (cause.reason == Reason::input_pending || cause.reason == Reason::input_failed)
    return fmt::format("{} {}", text_of(cause.reason),
                       input_name(context_, item, stage.inputs[job.blocking_input]));
  if (cause.differences.empty()) return std::string(text_of(cause.reason));
  std::vector<std::string> parts;
  for (const RecipeDifference& difference : cause.differences)
    parts.push_back(group_text(context_, item, stage, difference));
  return joined(parts);
}

// Counts the inputs of a mean by their fate: "3 map.LS changed, 1 map.LS added".
std::string Causes::group_of_mean(std::size_t index, bool meshes) {
  const Job& job = plan_.means[index][meshes ? 0 : 1];
  const MeanHistogram& mean = context_.catalog.means[index];
  const std::string& averaged = meshes ? mean.of_mesh : mean.of_scan;
  if (job.verdict == Verdict::wait) return fmt::format("{} {}", text_of(job.reason), averaged);
  const Recipe now = decide_mean(context_, plan_, index, meshes, kNowhere).recipe;
  if (job.verdict == Verdict::cached || now.stage.empty()) return std::string(text_of(job.reason));

  const Digest key = key_of(now);
  if (book_.quarantined(key) != nullptr) return std::string(text_of(Reason::damaged));
  const Cause cause = nearest(book_.artefacts(mean.name, meshes ? "meshes" : "scans"), now, key);
  if (cause.differences.empty()) return std::string(text_of(cause.reason));
  std::map<std::string, std::size_t> fates;
  std::vector<std::string> parts;
  for (const RecipeDifference& difference : cause.differences) {
    if (difference.part == Part::input)
      ++fates[fate(difference)];
    else
      parts.push_back(version_text(difference));
  }
  for (const auto& [what, items] : fates) parts.push_back(fmt::format("{} {} {}", items, averaged, what));
  return joined(parts);
}

Why Causes::words() {
  return {[this](const ItemRef& item, std::size_t stage) { return group(item, stage); },
          [this](std::size_t mean, bool meshes) { return group_of_mean(mean, meshes); }};
}

Why Causes::words_of_computed() {
  return {[this](const ItemRef& item, std::size_t stage) {
            return plan_.jobs(item)[stage].computed() ? group(item, stage) : "";
          },
          [this](std::size_t mean, bool meshes) {
            return plan_.means[mean][meshes ? 0 : 1].computed() ? group_of_mean(mean, meshes) : "";
          }};
}

std::string Causes::difference_line(const ItemRef& item, const Stage& stage,
                                    const RecipeDifference& difference) {
  if (difference.part == Part::seed)
    return fmt::format("seed {} -> {}", or_none(difference.before), or_none(difference.after));
  if (difference.part != Part::input) return group_text(context_, item, stage, difference);
  const Input* input = input_named(context_, item, stage, difference.name);
  if (input == nullptr)
    return fmt::format("{} {}", source_text(context_.source(item), difference.name), fate(difference));
  const std::string because = origin(item, *input, difference.before);
  return group_text(context_, item, stage, difference) +
         (because.empty() ? "" : fmt::format(" ({})", because));
}

Causes::Product Causes::product(const ItemRef& item, const Input& input) const {
  if (input.from == Input::From::reference)
    return {item, context_.catalog.means[kReference].name, item.is_mesh() ? "meshes" : "scans", 0, true};
  const ItemRef of = input.from == Input::From::mesh ? ItemRef{item.family, -1} : item;
  return {of, context_.chain(of)[input.stage].name, context_.name(of), input.stage, false};
}

// From job to job, to the first that waits for nothing.
std::string Causes::waits(const ItemRef& item, std::size_t index) {
  const Input& input = context_.chain(item)[index].inputs[plan_.jobs(item)[index].blocking_input];
  const Product awaited = product(item, input);
  std::string text = "waits for " + awaited.stage;
  if (awaited.is_mean) return text + ", " + waits_for_mean(item.is_mesh());
  if (input.from == Input::From::mesh) text += " of " + awaited.label;
  const Cause cause = of(awaited.item, awaited.index);
  const char* between = cause.reason == Reason::input_pending ? ", " : ": ";
  return text + between + line(awaited.item, awaited.index, cause);
}

std::string Causes::waits_for_mean(bool meshes) {
  const MeanHistogram& mean = context_.catalog.means[kReference];
  const Chain& chain = meshes ? context_.catalog.mesh : context_.catalog.scan;
  const std::size_t index = stage_index(chain, meshes ? mean.of_mesh : mean.of_scan);
  std::vector<ItemRef> open;
  for (const ItemRef& item : context_.items(meshes))
    if (plan_.jobs(item)[index].open()) open.push_back(item);
  if (open.empty()) return std::string(text_of(Reason::changed));
  const Cause cause = of(open.front(), index);
  return fmt::format("waits for {} of {}{}: {}", chain[index].name, context_.name(open.front()),
                     open.size() > 1 ? fmt::format(" and {} more", open.size() - 1) : "",
                     line(open.front(), index, cause));
}

// How the earlier artefact of an input, known by its content, was made otherwise than the present one.
std::string Causes::origin(const ItemRef& item, const Input& input, const std::string& before) {
  const Product made = product(item, input);
  const auto content = digest_from_hex(before);
  for (const ArtefactFile& file : book_.artefacts(made.stage, made.label)) {
    if (!content || file.name.content != *content) continue;
    const Recipe* earlier = read(file);
    if (earlier == nullptr) continue;
    if (made.is_mean)
      return origin_of_mean(*earlier,
                            decide_mean(context_, plan_, kReference, item.is_mesh(), kNowhere).recipe);
    const Recipe now = decide(context_, plan_, made.item, made.index, kNowhere).recipe;
    std::vector<std::string> lines;
    for (const RecipeDifference& difference : differences(*earlier, now))
      lines.push_back(difference_line(made.item, context_.chain(made.item)[made.index], difference));
    return joined(lines);
  }
  return {};
}

std::string Causes::origin_of_mean(const Recipe& before, const Recipe& now) const {
  if (now.stage.empty()) return "given by --reference";
  std::vector<std::string> lines;
  for (const RecipeDifference& difference : differences(before, now))
    lines.push_back(difference.part == Part::input
                        ? fmt::format("that of {} {}", difference.name, fate(difference))
                        : version_text(difference));
  return joined(lines);
}

}  // namespace salbench
