// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/run/request.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <system_error>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "io/file.h"
#include "io/shapes/text_scanner.h"
#include "pipeline/config/program_files.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

// Names, without extension, of the files beside it and of the installed configurations.
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

// Throws ConfigError for the record of an unfinished run of salbench 1.0: without any key it would mean the
// default configuration.
Section written_file(const std::string& given) {
  Section file = Section::from_file(given);
  if (file.keys().empty() && read_head(given, kUnderWay.size()) == kUnderWay)
    throw ConfigError(
        fmt::format("{}: is the record of a run that was ended; name its configuration", given));
  return file;
}

Section file_of(const std::string& given) {
  std::error_code error;
  // A folder of that name, such as its results, does not count.
  if (fs::exists(given, error) && !fs::is_directory(given, error)) return written_file(given);
  for (const auto& [name, yaml] : configurations())
    if (given == name || given == std::string(name) + ".yaml")
      return Section::from_text(std::string(yaml), std::string(name) + ".yaml");
  const std::vector<std::string> known = known_configurations(given);
  const std::string protocols = given.starts_with("protocols/") ? "protocols/" : "";
  const fs::path record = fs::path(given) / kRecord;
  const std::string hint =
      fs::exists(record, error)
          ? fmt::format("did you mean '{}'?", record.string())
          : did_you_mean(protocols + fs::path(given).stem().string(), {known.begin(), known.end()});
  if (hint.empty() && fs::status(given, error).type() != fs::file_type::not_found)
    return Section::from_file(given);  // throws with the reason
  throw NoConfigurationError(fmt::format("{}: cannot be read: there is no such configuration{}{}", given,
                                         hint.empty() ? "" : "; ", hint));
}

bool is_record(const Section& file) { return file.has("program") && file.has("configuration"); }

// Record of a run, if the request names one as its configuration.
std::optional<Section> record_of(const Request& request) {
  if (request.config.empty()) return {};
  const Section file = file_of(request.config);
  return is_record(file) ? std::optional(file) : std::nullopt;
}

// Maps passed to the recorded run are read from their original locations.
void add_recorded_maps(Config& config, const Request& request, const Front& front) {
  const std::optional<Section> record = record_of(request);
  if (!record) return;
  for (const Section& evaluated : record->list("evaluated")) {
    const std::string name = evaluated.text("model").value_or(""), maps = evaluated.text("maps").value_or("");
    bool matched = false;
    evaluated.read_value("matched", matched);
    if (request.maps.contains(name)) continue;
    std::error_code none;
    if (request.cached_alone && !fs::exists(maps, none)) {
      spdlog::warn("{}: maps of {} are not there any more: it is left out", maps, name);
      continue;
    }
    try {
      config.models.push_back(given_model(name, find_given_maps(maps, matched, front)));
    } catch (const ConfigError& error) {
      throw ConfigError(fmt::format("{}: the run had {}; put the maps back, or give others under the name {}",
                                    evaluated.where("maps"), error.what(), name));
    }
  }
}

// Keeps the models of a list such as "LS,floors". Throws ConfigError for a name that the configuration lacks.
void select_models(Config& config, const std::string& list) {
  const std::vector<std::string> wanted = split_list(list);
  const auto stands_for = [](std::string_view name, const Model& model) {
    return name == model.name || (name == kFloors && is_floor_model(model.name));
  };
  for (const std::string& name : wanted)
    if (std::ranges::none_of(config.models, [&](const Model& model) { return stands_for(name, model); })) {
      std::vector<std::string_view> known;
      for (const Model& model : config.models) known.push_back(model.name);
      throw ConfigError(fmt::format("{}: the configuration has no model '{}'; it has {}",
                                    as_option("models", list), name, fmt::join(known, ", ")));
    }
  std::erase_if(config.models, [&](const Model& model) {
    return std::ranges::none_of(wanted, [&](const std::string& name) { return stands_for(name, model); });
  });
}

// Keeps people and chance, which always take part.
void keep_references(Config& config) {
  std::erase_if(config.models, [](const Model& model) { return !is_reference_model(model.name); });
  if (config.models.empty())
    config.models = read_config(Section::from_text("models: {RS: }", "models"), "python").models;
}

void choose_models(Config& config, const Request& request) {
  if (request.models == "{}") {
    config.models.clear();
  } else if (!request.models.empty()) {
    const std::string yaml =
        fmt::format("{{protocol: {}, models: {}}}", name_of(config.protocol), request.models);
    config.models = read_config(Section::from_text(yaml, "models"), "python").models;
  }
  if (!request.kept) return;
  request.kept->empty() ? keep_references(config) : select_models(config, *request.kept);
}

bool has_model(const Config& config, const std::string& name) {
  return std::ranges::find(config.models, name, &Model::name) != config.models.end();
}

// A variant's grid generates names as well.
void add_functions(Config& config, const Request& request) {
  for (const Model& model : request.functions) {
    if (has_model(config, model.name))
      throw ConfigError(fmt::format("models: {} is the name of two models", in_quotes(model.name)));
    config.models.push_back(model);
  }
}

void add_maps(Config& config, const Request& request, const Front& front) {
  for (const auto& [name, source] : request.maps) {
    GivenMaps maps = find_given_maps(source, request.matched, front);
    if (has_model(config, name))
      throw ConfigError(
          fmt::format("{}: is a model of the configuration; choose another", as_option("name", name)));
    config.models.push_back(given_model(name, std::move(maps)));
  }
}

// The exact histogram that maps were matched to: keys of matched maps contain its bits.
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

Selection recorded_selection(const Request& request) {
  const std::optional<Section> record = record_of(request);
  if (!record) return {};
  const Section chosen = record->child("selection");
  Selection selection;
  if (chosen.has("names")) selection.items = ItemChoice(chosen.words("names"));
  if (const auto items = chosen.text("items")) selection.items = *items;
  selection.reference_of_items = chosen.has("reference") && chosen.words("reference") == Words{"items"};
  if (chosen.has("reference") && !selection.reference_of_items)
    selection.reference = recorded_histogram(chosen);
  return selection;
}

// Replaces a leading ~, which a shell leaves in --data=~/x and in files. Throws ConfigError.
std::string from_home(const std::string& folder) {
  if (folder.starts_with('$'))
    throw ConfigError(fmt::format("{}: variables are not replaced: write the whole path", folder));
  if (folder != "~" && !folder.starts_with("~/")) return folder;
  const char* home = std::getenv("HOME");  // NOLINT(concurrency-mt-unsafe): nothing sets it
  if (home == nullptr || *home == '\0')
    throw ConfigError(fmt::format("{}: HOME is not set: write the whole path", folder));
  return home + folder.substr(1);
}

}  // namespace

Section configuration(const std::string& given) {
  Section file = file_of(given);
  if (!is_record(file)) return file;
  return file.child("configuration").as_if_in(file.text("configuration_folder").value_or(""));
}

Config config_of(const Request& request, const Front& front) {
  Config config = request.yaml
                      ? read_config(Section::from_text(*request.yaml, "config"), "python")
                      : read_config(configuration(request.config), fs::path(request.config).stem().string());
  add_recorded_maps(config, request, front);
  choose_models(config, request);
  add_functions(config, request);
  add_maps(config, request, front);
  config.pictures = std::max(config.pictures, request.pictures);
  config.cached_alone = request.cached_alone;
  if (!request.data.empty()) config.data = request.data;
  if (request.split) config.dataset.split = *request.split;
  if (!request.cache.empty()) config.cache = request.cache;
  if (!request.output.empty()) config.output = request.output;
  return config;
}

Config placed_config_of(const Request& request, const Front& front) {
  Config config = config_of(request, front);
  if (config.data.empty())
    throw ConfigError(fmt::format("{}: names no data set: give {}, or a key 'data'",
                                  request.config.empty() ? "config" : request.config,
                                  as_option("data", "DIR")));
  // From Python; those of a configuration are checked when it is read.
  for (std::string* folder : {&config.data, &config.cache, &config.output}) {
    if (folder->find('\0') != std::string::npos)
      throw ConfigError(fmt::format("{}...: the name of a folder holds a zero byte", folder->c_str()));
    *folder = from_home(*folder);
  }
  if (config.cache.empty()) config.cache = "salbench-cache";
  if (config.output.empty()) config.output = (fs::path("salbench-out") / config.name).string();
  return config;
}

Selection selection_of(const Request& request) {
  Selection selection = recorded_selection(request);
  if (!request.items.all())
    selection.items = request.items;
  else if (!request.maps.empty() && selection.items.all())
    selection.items = std::string(kScoredItems);
  if (!request.shard.empty()) selection.shard = parse_shard(request.shard);
  if (request.reference || request.reference_of_items) {
    selection.reference = request.reference;
    selection.reference_of_items = request.reference_of_items;
  }
  return selection;
}

std::string selection_lines(const Selection& selection) {
  const ItemChoice& items = selection.items;
  std::string lines;
  if (items.are_names)
    lines += fmt::format("names: {}\n", option_text(items.parts, true));
  else if (!items.all())
    lines += fmt::format("items: {}\n", yaml_quoted(items.text));
  if (selection.reference_of_items) lines += "reference: items\n";
  if (selection.reference) lines += fmt::format("reference: [{}]\n", fmt::join(*selection.reference, ", "));
  return lines;
}

std::vector<std::string> selected_stages(const std::string& list, const std::vector<std::string>& known) {
  const std::vector<std::string> wanted = split_list(list);
  if (wanted.empty()) return known;
  std::vector<std::string> selected;
  for (const std::string& part : wanted) {
    const auto is_meant = [&](const std::string& stage) {
      return stage == part || stage.starts_with(part + ".");
    };
    if (std::ranges::none_of(known, is_meant))
      throw ConfigError(fmt::format("--stage {}: there is no stage '{}'; there are {}", list, part,
                                    fmt::join(known, ", ")));
    std::ranges::copy_if(known, std::back_inserter(selected), is_meant);
  }
  return selected;
}

}  // namespace salbench
