// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/commands/session.h"

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <map>
#include <string_view>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "io/commands/process.h"
#include "io/file.h"
#include "pipeline/config/program_files.h"
#include "pipeline/engine/run.h"
#include "pipeline/inputs/given_reference.h"
#include "pipeline/package/listing.h"
#include "pipeline/rules/gaze.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

// A folder that is not as the layout says may be as others do.
Dataset dataset_of(const Config& config) try {
  return find_dataset(config.data, config.dataset.layout);
} catch (const InputError& error) {
  const std::string others = layouts_that_fit(config.data, error.what());
  if (others.empty()) throw;
  throw InputError(fmt::format("{}{}; choose one with dataset: {{layout: ...}}", error.what(), others));
}

// Ground truth that is made up is there for every item.
Inputs inputs_of(const Config& config, const Selection& selection) {
  // An importer of HDF5 files that others wrote may be needed in the midst of a run.
  if (config.dataset.layout == kOneForm) prepare_commands();
  const bool simulated = config.simulated();
  const Others others = selection.reference || selection.reference_of_items ? Others::left_out
                        : simulated                                         ? Others::simulated
                                                                            : Others::measured;
  Inputs inputs = read_inputs(dataset_of(config),
                              simulated && selection.items.is_scored() ? ItemChoice() : selection.items,
                              selection.shard, config.dataset.split, others);
  if (is_from_gaze(config, inputs))
    inputs.remark += fmt::format("{}computed from recordings of gaze, {}",
                                 inputs.remark.empty() ? "TRUTH: " : "; ", gaze_recipe(config.gaze));
  return inputs;
}

// Jobs for nothing but the mean over all items.
std::size_t open_of_others(const Resolver& resolver) {
  const Project& project = resolver.project();
  std::size_t open = 0;
  for (std::size_t rule = 0; rule < project.rules.size(); ++rule)
    for (const Unit unit : project.units_of(rule))
      open += !project.units.is_chosen(unit) && resolver.plan()[{rule, unit}].open() ? 1U : 0U;
  return open;
}

// Names without ending of the files beside it, and of those of the program.
std::vector<std::string> known_configurations(const fs::path& given) {
  std::vector<std::string> names;
  const fs::path folder = given.parent_path();
  std::error_code none;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder.empty() ? "." : folder, none))
    if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem().string());
  for (const NamedYaml& configuration : configurations())
    if (folder.empty() || fs::path(configuration.name).parent_path() == folder)
      names.emplace_back(configuration.name);
  std::ranges::sort(names);
  return names;
}

// Throws ConfigError for the record of a run of salbench 1.0 that was ended: without a key it would stand for
// the default configuration.
Section written_file(const std::string& given) {
  Section file = Section::from_file(given);
  if (file.keys().empty() && read_head(given, kUnderWay.size()) == kUnderWay)
    throw ConfigError(
        fmt::format("{}: is the record of a run that was ended; name its configuration", given));
  return file;
}

Section file_of(const std::string& given) {
  std::error_code error;
  // A folder of that name, such as that of its results, is not meant.
  if (fs::exists(given, error) && !fs::is_directory(given, error)) return written_file(given);
  for (const auto& [name, yaml] : configurations())
    if (given == name || given == std::string(name) + ".yaml")
      return Section::from_text(std::string(yaml), std::string(name) + ".yaml");
  const std::vector<std::string> known = known_configurations(given);
  const std::string protocols = given.starts_with("protocols/") ? "protocols/" : "";
  const std::string hint =
      did_you_mean(protocols + fs::path(given).stem().string(), {known.begin(), known.end()});
  if (hint.empty() && fs::status(given, error).type() != fs::file_type::not_found)
    return Section::from_file(given);  // which says why it cannot be read
  throw NoConfigurationError(fmt::format("{}: cannot be read: there is no such configuration{}{}", given,
                                         hint.empty() ? "" : "; ", hint));
}

bool is_record(const Section& file) { return file.has("program") && file.has("configuration"); }

// Maps that the run of a record was given are read from where they were then.
void add_recorded_maps(Config& config, const Arguments& arguments) {
  const Section record = file_of(arguments.config);
  if (!is_record(record) || !record.has("evaluated")) return;
  for (const Section& evaluated : record.list("evaluated")) {
    const std::string name = evaluated.text("model").value_or(""), maps = evaluated.text("maps").value_or("");
    bool matched = false;
    evaluated.read_value("matched", matched);
    if (!arguments.maps.empty() && arguments.name == name) continue;
    std::error_code none;
    if (arguments.cached_alone && !fs::exists(maps, none)) {
      spdlog::warn("{}: maps of {} are not there any more: it is left out", maps, name);
      continue;
    }
    try {
      config.models.push_back(given_model(name, find_given_maps(maps, matched)));
    } catch (const ConfigError& error) {
      throw ConfigError(fmt::format("{}: the run had {}; put the maps back, or give others under the name {}",
                                    evaluated.where("maps"), error.what(), name));
    }
  }
}

Config read_configuration(const Arguments& arguments, Pictures pictures) {
  Config config = read_config(configuration(arguments.config), fs::path(arguments.config).stem().string());
  add_recorded_maps(config, arguments);
  select_models(config, arguments.models);
  if (!arguments.maps.empty()) {
    if (std::ranges::find(config.models, arguments.name, &Model::name) != config.models.end())
      throw ConfigError(
          fmt::format("--name {}: is a model of the configuration; choose another", arguments.name));
    config.models.push_back(given_model(arguments.name, find_given_maps(arguments.maps, arguments.matched)));
  }
  config.pictures = std::max(config.pictures, pictures);
  config.cached_alone = arguments.cached_alone;
  place_folders(config, arguments);
  return config;
}

// Exactly the histogram that maps were matched to: the keys of matched maps have its bits.
Histogram recorded_histogram(const Section& chosen) {
  const Words words = chosen.words("reference");
  Histogram histogram{};
  if (words.size() != histogram.size())
    chosen.fail("reference", fmt::format("must have {} bins", kHistogramBins));
  for (std::size_t bin = 0; bin < words.size(); ++bin)
    if (!parse_option(words[bin], histogram[bin]) || histogram[bin] < 0)
      chosen.fail("reference", fmt::format("holds '{}', not a density", words[bin]));
  return histogram;
}

Selection recorded_selection(const std::string& config) {
  if (config.empty()) return {};
  const Section file = file_of(config);
  if (!is_record(file)) return {};
  const Section chosen = file.child("selection");
  Selection selection;
  if (chosen.has("names")) selection.items = ItemChoice(chosen.words("names"));
  if (const auto items = chosen.text("items")) selection.items = *items;
  selection.reference_of_items = chosen.has("reference") && chosen.words("reference") == Words{"items"};
  if (chosen.has("reference") && !selection.reference_of_items)
    selection.reference = recorded_histogram(chosen);
  return selection;
}

}  // namespace

Section configuration(const std::string& given) {
  Section file = file_of(given);
  if (!is_record(file)) return file;
  return file.child("configuration").as_if_in(file.text("configuration_folder").value_or(""));
}

void select_models(Config& config, const std::string& list) {
  std::vector<std::string> known;
  for (const Model& model : config.models) known.push_back(model.name);
  const std::vector<std::string> wanted = split_list(list);
  for (const std::string& name : wanted)
    if (std::ranges::find(known, name) == known.end())
      throw ConfigError(fmt::format("--models {}: the configuration has no model '{}'; it has {}", list, name,
                                    fmt::join(known, ", ")));
  if (!wanted.empty())
    std::erase_if(config.models,
                  [&](const Model& model) { return std::ranges::find(wanted, model.name) == wanted.end(); });
}

StageNames selected_stages(const std::string& list, const std::vector<std::string>& known) {
  const std::vector<std::string> wanted = split_list(list);
  if (wanted.empty()) return {known.begin(), known.end()};
  StageNames selected;
  for (const std::string& part : wanted) {
    const auto is_meant = [&](const std::string& stage) {
      return stage == part || stage.starts_with(part + ".");
    };
    if (std::ranges::none_of(known, is_meant))
      throw ConfigError(fmt::format("--stage {}: there is no stage '{}'; there are {}", list, part,
                                    fmt::join(known, ", ")));
    std::ranges::copy_if(known, std::inserter(selected, selected.end()), is_meant);
  }
  return selected;
}

Selection selection_of(const Arguments& arguments) {
  Selection selection = recorded_selection(arguments.config);
  if (!arguments.items.empty())
    selection.items = arguments.items;
  else if (!arguments.maps.empty() && selection.items.all())
    selection.items = std::string(kScoredItems);
  if (!arguments.shard.empty()) selection.shard = parse_shard(arguments.shard);
  if (arguments.reference.empty()) return selection;
  selection.reference_of_items = arguments.reference == kReferenceOfItems;
  selection.reference =
      selection.reference_of_items ? std::nullopt : std::optional(read_reference(arguments.reference));
  return selection;
}

std::string selection_yaml(const Selection& selection) {
  const ItemChoice& items = selection.items;
  std::string yaml;
  if (items.are_names)
    yaml += fmt::format("  names: {}\n", option_text(Words(items.parts.begin(), items.parts.end()), true));
  else if (!items.all())
    yaml += fmt::format("  items: {}\n", yaml_quoted(items.text));
  if (selection.reference_of_items) yaml += fmt::format("  reference: {}\n", kReferenceOfItems);
  if (selection.reference) yaml += fmt::format("  reference: [{}]\n", fmt::join(*selection.reference, ", "));
  return yaml.empty() ? "" : "selection:  # of the items, and what maps are matched to\n" + yaml;
}

void place_folders(Config& config, const Arguments& arguments) {
  if (!arguments.data.empty()) config.data = arguments.data;
  if (arguments.split) config.dataset.split = *arguments.split;
  if (!arguments.cache.empty()) config.cache = arguments.cache;
  if (!arguments.output.empty()) config.output = arguments.output;
  if (config.data.empty())
    throw ConfigError(fmt::format("{}: names no data set: give {}, or a key 'data'",
                                  arguments.config.empty() ? "config" : arguments.config,
                                  as_option("data", "DIR")));
  // From Python; a configuration's are refused where it is read.
  for (const std::string* folder : {&config.data, &config.cache, &config.output})
    if (folder->find('\0') != std::string::npos)
      throw ConfigError(fmt::format("{}...: the name of a folder holds a zero byte", folder->c_str()));
  if (config.cache.empty()) config.cache = "salbench-cache";
  if (config.output.empty()) config.output = (fs::path("salbench-out") / config.name).string();
}

Setup::Setup(Config the_config, Selection the_selection)
    : selection(std::move(the_selection)),
      config(std::move(the_config)),
      inputs(inputs_of(config, selection)),
      project(make_project(config, inputs, selection.reference)),
      cache(config.cache),
      output(config.output) {
  for (const std::string& error : inputs.errors) spdlog::error("data set: {}", error);
}

Setup::Setup(const Arguments& arguments, Pictures pictures)
    : Setup(read_configuration(arguments, pictures), selection_of(arguments)) {}

namespace {

constexpr std::size_t kTries = 5;  // shapes

// Those of a share; nothing: all that there are.
std::optional<std::vector<std::string>> families_of_share(const Inputs& inputs) {
  if (!inputs.shard) return {};
  std::vector<std::string> names;
  for (const Family& family : inputs.units.families()) names.push_back(family.name);
  return names;
}

}  // namespace

Session::Session(Setup the_setup, std::unique_ptr<Progress> the_progress, const std::atomic<bool>& the_stop,
                 bool goes_on)
    : setup(std::move(the_setup)),
      store(setup.cache, Access::read_write, families_of_share(setup.inputs)),
      resolver(setup.project, make_plan(setup.project, store), store),
      progress(std::move(the_progress)),
      stop(the_stop),
      keep_going(goes_on) {}

Session::Session(const Arguments& arguments, Pictures pictures)
    : Session(Setup(arguments, pictures), progress_of(arguments.quiet), interrupted(), arguments.keep_going) {
}

void Session::compute(int threads, const std::string& what, const std::vector<bool>& rules) {
  if (const std::size_t open = rules.empty() ? open_of_others(resolver) : 0; open > 0)
    spdlog::warn(
        "{} jobs of items that are left out come first, once: maps are matched to the mean over all items, "
        "as in a run over all; {} matches to the mean over these alone",
        open, as_option("reference", "items"));
  const OrderlyEnd orderly;
  run_jobs(resolver, {threads, what, rules, keep_going ? 0 : kTries}, *progress, stop);
}

double Session::seconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
}

// std::fputs in place of fmt::print, which throws if standard error takes no text.
ExitStatus finished_status(const Session& session) {
  const std::vector<Failure> failures = session.resolver.failures();
  const std::size_t n_errors = session.setup.inputs.errors.size();
  if (failures.empty() && n_errors == 0) return kAllDone;
  std::map<std::string_view, std::size_t> stages;
  if (n_errors > 0) stages["data set"] = n_errors;
  for (const Failure& failure : failures) ++stages[session.setup.project.rule(failure.job).stage];
  std::string text;
  for (const auto& [stage, n] : stages) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", n, stage);
  std::fputs(fmt::format("\n{} failed, each named above: {}\n", failures.size() + n_errors, text).c_str(),
             stderr);
  return std::ranges::any_of(failures, &Failure::defect) ? kDefect : kSomeFailed;
}

}  // namespace salbench
