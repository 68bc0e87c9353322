// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/rules/config.h"

#include <algorithm>

#include <fmt/format.h>

#include "io/shapes/text_scanner.h"
#include "pipeline/rules/command_model.h"
#include "pipeline/rules/function_model.h"
#include "pipeline/rules/variants.h"
#include "stages/metrics/metrics.h"

namespace salbench {
namespace {

// The only list of the sections that are one options struct each.
template <class Self, class Visit>
void for_each_section(Self& config, Visit&& visit) {
  visit("dataset", config.dataset);
  visit("simulation", config.simulation);
  visit("gaze", config.gaze);
  visit("scan", config.scan);
  visit("normals", config.normals);
  visit("scan_normals", config.scan_normals);
  visit("surface", config.surface);
  visit("fpfh", config.fpfh);
  visit("scan_fpfh", config.scan_fpfh);
  visit("metrics", config.metrics);
  visit("statistics", config.statistics);
}

// Names of the sections that have `key` but not `other`, in the file's order, without built-in models.
std::vector<std::string> sections_with(std::string_view key, const Section& models,
                                       std::string_view other = {}) {
  std::vector<std::string> names;
  for (const std::string& name : models.keys())
    if (!is_built_in_model(name) && models.has_mapping(name) && models.child(name).has(key) &&
        !models.child(name).has(other))
      names.push_back(name);
  return names;
}

// Rejects unknown names: mistyped, or sections without a key that defines a model.
void reject_unknown_models(const Section& models, const std::vector<std::string_view>& known) {
  SectionErrors errors;
  for (const std::string& name : models.keys()) {
    if (std::ranges::find(known, name) != known.end()) continue;
    errors.gather([&] {
      reject_misspelt_command(name, models);
      models.fail(
          name,
          fmt::format(
              "is not a known model; a model of your own has a command ({{command: ...}}), is a variant "
              "of another one ({{model: LS, ...}}), or is a function of Python "
              "(salbench.run(models={{{}: function}})); {}",
              in_quotes(name),
              did_you_mean(name, known, fmt::format("known are: {}", fmt::join(known, ", ")))));
    });
  }
  errors.throw_any();
}

void reject_variants_under_the_name_of(const ModelRow& row, const Section& models) {
  if (!models.has_mapping(row.name)) return;
  for (const std::string_view key : {kModelOfVariant, kGridOfVariants})
    if (models.child(row.name).has(key))
      models.child(row.name).fail(
          key, fmt::format(
                   "is a key of variants, which have names of their own, such as {0}-2: {{model: {0}, ...}}",
                   row.name));
}

void reject_options_of_floors(const Section& models) {
  if (!models.has(kFloors) || (models.has_mapping(kFloors) && models.child(kFloors).keys().empty())) return;
  models.fail(kFloors,
              "stands for several models and has no options: name one of them beside it to give it some");
}

// A trivial baseline with its own section takes the options from there.
bool is_named(const ModelRow& row, const Section& models) {
  return models.has(row.name) || (row.about.is_floor && models.has(kFloors));
}

// A grid generates names, which may equal others.
void reject_equal_names(const Section& section, const std::vector<Model>& models) {
  for (auto model = models.begin(); model != models.end(); ++model)
    if (std::find_if(models.begin(), model, [&](const Model& other) { return other.name == model->name; }) !=
        model)
      section.fail(model->name, "is the name of two models: a grid makes one of them");
}

std::vector<Model> read_models(const Section& root, Protocol protocol) {
  const Section section = root.child_or_names("models");
  std::vector<std::string_view> known;
  for (const ModelRow& row : model_rows()) known.push_back(row.name);
  known.push_back(kFloors);
  const std::vector<std::string> variants = variant_sections(section);
  const std::vector<std::string> commands = sections_with("command", section);
  const std::vector<std::string> functions = sections_with("function", section, "command");
  for (const auto* names : {&variants, &commands, &functions})
    known.insert(known.end(), names->begin(), names->end());
  SectionErrors errors;
  errors.gather([&] { reject_unknown_models(section, known); });
  errors.gather([&] { reject_options_of_floors(section); });
  std::vector<Model> models;
  for (const ModelRow& row : model_rows())
    if (root.has("models") ? is_named(row, section) : row.about.by_default)
      errors.gather([&] {
        reject_variants_under_the_name_of(row, section);
        models.push_back(row.bind(section.child(row.name), protocol));
      });
  for (const std::string& name : variants)
    errors.gather([&] {
      for (Model& model : variants_of(name, section, protocol)) models.push_back(std::move(model));
    });
  for (const std::string& name : commands)
    errors.gather([&] { models.push_back(command_model(name, section)); });
  for (const std::string& name : functions)
    errors.gather([&] { models.push_back(recorded_function_model(name, section)); });
  errors.throw_any();
  reject_equal_names(section, models);
  if (models.empty()) root.fail("models", "names no model; leave the key out to run the paper's");
  return models;
}

std::vector<std::string_view> known_metrics() {
  std::vector<std::string_view> known;
  for (const Metric& metric : metric_table()) known.push_back(metric.name);
  return known;
}

void require_metric(const std::string& name, const Section& section, std::string_view key) {
  const std::vector<std::string_view> known = known_metrics();
  if (name == kEveryName || std::ranges::find(known, name) != known.end()) return;
  section.fail(key, fmt::format("has no metric '{}'; {}", name,
                                did_you_mean(name, known, "docs/metrics.md has a table of them")));
}

// The named metrics in the order of the table: their order in a file must not change the key.
Words metrics_named(const Words& written, const Section& section, std::string_view key) {
  const std::vector<std::string_view> known = known_metrics();
  SectionErrors errors;
  for (const std::string& name : written) errors.gather([&] { require_metric(name, section, key); });
  errors.throw_any();
  if (std::ranges::find(written, kEveryName) != written.end()) return {known.begin(), known.end()};
  if (written.empty()) section.fail(key, "names no metric; leave the key out for the paper's");
  Words named;
  for (const std::string_view name : known)
    if (std::ranges::find(written, name) != written.end()) named.emplace_back(name);
  return named;
}

// Matching of the chosen metrics that differs from the default.
ByName<Matching> matching_of(const MetricsOptions& written, const Section& section) {
  for (const auto& [name, matching] : written.matching) require_metric(name, section, "matching");
  MetricsOptions usual = written;
  usual.matching.clear();
  ByName<Matching> chosen;
  for (const Metric& metric : chosen_metrics(usual)) {
    auto found = written.matching.find(metric.name);
    if (found == written.matching.end()) found = written.matching.find(kEveryName);
    const Matching matching = found == written.matching.end() ? metric.matching : found->second;
    if (matching != metric.matching) chosen[metric.name] = matching;
  }
  return chosen;
}

// `metrics: [auc, nss]` is short for `metrics: {names: [auc, nss]}`.
void read_metrics(const Section& root, MetricsOptions& metrics) {
  if (!root.has("metrics")) return;
  const bool brief = !root.has_mapping("metrics");
  const Section section = brief ? root : root.child("metrics");
  const std::string_view key = brief ? "metrics" : "names";
  SectionErrors errors;
  if (!brief) errors.gather([&] { section.read(metrics); });
  if (section.has(key))
    errors.gather([&] { metrics.names = metrics_named(section.words(key), section, key); });
  errors.throw_any();
  metrics.matching = matching_of(metrics, section);
}

void require_chosen(const std::string& leading, const MetricsOptions& metrics, const Section& root) {
  if (leading.empty() || std::ranges::find(metrics.names, leading) != metrics.names.end()) return;
  const std::string hint = did_you_mean(leading, {metrics.names.begin(), metrics.names.end()});
  root.child("statistics")
      .fail("leading", fmt::format("is none of the metrics: {}{}{}", fmt::join(metrics.names, ", "),
                                   hint.empty() ? "" : "; ", hint));
}

// An annotated configuration without pictures shows their options as a comment.
std::string picture_section(const Config& config, bool annotated) {
  const std::string options = "picture:\n" + indented(options_text(config.picture, annotated), "  ");
  if (config.pictures == Pictures::computed) return (annotated ? "\n" : "") + options;
  return annotated ? "\n# Runs compute pictures of all shapes where this section is there:\n" +
                         indented(options, "# ")
                   : "";
}

std::string written(const Config& config, bool annotated) {
  std::string yaml;
  const auto add = [&](std::string_view key, std::string_view value, std::string_view note) {
    if (annotated) yaml += fmt::format("# {}\n", note);
    yaml += fmt::format("{}: {}\n", key, value);
  };
  const auto begin_section = [&](std::string_view key) {
    yaml += fmt::format("{}{}:\n", annotated ? "\n" : "", key);
  };
  add("protocol", name_of(config.protocol),
      option_note<Protocol>({"defaults of the options: what the authors ran, or the words of their paper"}));
  add("seed", option_text(config.seed), "of all random numbers");
  if (!config.data.empty()) add("data", yaml_quoted(config.data), "folder of the data set");
  if (!config.cache.empty()) add("cache", yaml_quoted(config.cache), "folder of the artefacts");
  if (!config.output.empty()) add("output", yaml_quoted(config.output), "folder of the tables");
  for_each_section(config, [&](std::string_view key, const auto& options) {
    begin_section(key);
    yaml += indented(options_text(options, annotated), "  ");
  });
  yaml += picture_section(config, annotated);
  begin_section("models");
  for (const Model& model : config.models)
    if (!model.given)  // maps from files have no options
      yaml += fmt::format("  {}:\n{}", model.name,
                          indented(annotated ? model.annotated_options : model.options, "    "));
  return yaml;
}

}  // namespace

void check(const DatasetOptions& options) {
  if (!options.meshes && !options.scans) throw OptionError("scans", "must be true where meshes is false");
  if (options.score_on == ScoreOn::vertices) return;
  if (options.scans)
    throw OptionError("score_on", "must be vertices where scans is true: write scans: false");
  if (options.participants == Participants::simulated)
    throw OptionError("score_on", "must be vertices where participants are simulated: they pick vertices");
}

Config read_config(const Section& root, const std::string& name) {
  Config config;
  config.name = name;
  config.folder = root.folder();
  std::vector<std::string_view> known = {"protocol", "seed", "data", "cache", "output", "models", "picture"};
  for_each_section(config, [&](std::string_view key, auto&) { known.push_back(key); });
  SectionErrors errors;
  const auto read_key = [&](std::string_view key, auto& value) {
    errors.gather([&] { root.read_value(key, value); });
  };
  errors.gather([&] { root.reject_unknown(known); });
  read_key("protocol", config.protocol);
  read_key("seed", config.seed);
  read_key("data", config.data);
  read_key("cache", config.cache);
  read_key("output", config.output);
  if (errors.any()) config.protocol = Protocol::published;  // undefined if its text was invalid
  for_each_section(config, [&]<class Options>(std::string_view key, Options& options) {
    options = preset<Options>(config.protocol);
    errors.gather([&] {
      if constexpr (std::is_same_v<Options, MetricsOptions>)
        read_metrics(root, options);
      else
        root.child(key).read(options);
    });
  });
  errors.gather([&] { require_chosen(config.statistics.leading, config.metrics, root); });
  if (root.has("picture")) {
    config.pictures = Pictures::computed;
    errors.gather([&] { root.child("picture").read(config.picture); });
  }
  errors.gather([&] { config.models = read_models(root, config.protocol); });
  errors.throw_any();
  return config;
}

std::string config_yaml(const Config& config) { return written(config, false); }

std::string annotated_config_yaml(const Config& config) { return written(config, true); }

}  // namespace salbench
