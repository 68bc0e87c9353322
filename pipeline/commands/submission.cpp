// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/commands/submission.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>

#include <fmt/format.h>

#include "io/text_scanner.h"
#include "io/values_file.h"
#include "pipeline/config/section.h"
#include "pipeline/results/results.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

constexpr std::string_view kCardFile = "card.yaml", kManifestFile = "submission.yaml",
                           kConfigurationFile = "configuration.yaml", kResultsFile = "results.csv",
                           kMapsFolder = "maps/", kMapEnding = ".npy";
constexpr const char* kConfiguration = "shrec07_meshes";
constexpr std::size_t kLongestValue = 2000;  // of a key of the card
constexpr std::uint64_t kMapHeader = 1024, kRowOfResults = 4096;

using Texts = std::map<std::string, std::string>;  // by the name of a file

const std::string& require_file(const Texts& files, std::string_view name) {
  const auto found = files.find(std::string(name));
  if (found == files.end()) throw InputError(fmt::format("has no {}", name));
  return found->second;
}

template <class Options>
Options read_yaml(const std::string& yaml, const std::string& name) try {
  if (yaml.size() > kLongestText)
    throw InputError(fmt::format("{}: {} bytes, expected at most {}", name, yaml.size(), kLongestText));
  Options options;
  Section::from_text(yaml, name).read(options);
  return options;
} catch (const ConfigError& error) {
  throw InputError(error.what());
}

bool is_date(std::string_view text) {
  constexpr std::string_view kPattern = "dddd-dd-dd";
  return text.size() == kPattern.size() &&
         std::equal(text.begin(), text.end(), kPattern.begin(), [](char c, char pattern) {
           return pattern == 'd' ? c >= '0' && c <= '9' : c == pattern;
         });
}

// Another version of the program may write further options, at their defaults.
std::string normalised(const std::string& configuration) try {
  if (configuration.size() > kLongestText) throw InputError("configuration.yaml is too long");
  const Section root = Section::from_text(configuration, std::string(kConfigurationFile));
  if (root.has("models")) throw InputError("configuration.yaml has models, expected the protocol alone");
  return protocol_text(read_config(root, ""));
} catch (const ConfigError& error) {
  throw InputError(error.what());
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

void check_protocol(const Submission& submission, const std::string& configuration,
                    const Expected& expected) {
  if (file_digest(configuration).hex() != submission.manifest.configuration)
    throw InputError("configuration.yaml is not what submission.yaml has the digest of");
  const std::string theirs = normalised(configuration);
  if (theirs == expected.configuration) return;
  const std::vector<std::string> mine = lines_of(expected.configuration), other = lines_of(theirs);
  for (std::size_t i = 0; i < std::max(mine.size(), other.size()); ++i) {
    const std::string here = i < mine.size() ? mine[i] : "", there = i < other.size() ? other[i] : "";
    if (here != there)
      throw InputError(
          fmt::format("another protocol: it has {}, the leaderboard {}", in_quotes(there), in_quotes(here)));
  }
}

void check_map(const std::string& name, const std::string& bytes, std::size_t points) {
  const ScalarField map = parse_npy(bytes, name);
  if (map.size() != points)
    throw InputError(fmt::format("{}: {} values, but the shape has {} points", name, map.size(), points));
  const auto bad = std::ranges::find_if(map, [](double value) { return !std::isfinite(value); });
  if (bad != map.end())
    throw InputError(
        fmt::format("{}: value {} (0-based) is {}, expected a finite number", name, bad - map.begin(), *bad));
}

void check_maps(const Submission& submission, const Expected& expected) {
  for (const auto& [item, bytes] : submission.maps) {
    const auto found = expected.points.find(item);
    const std::string name = fmt::format("{}{}{}", kMapsFolder, item, kMapEnding);
    if (found == expected.points.end())
      throw InputError(fmt::format("{}: there is no such item with ground truth", in_quotes(name)));
    check_map(name, bytes, found->second);
  }
  std::vector<std::string> missing;
  for (const auto& [item, points] : expected.points)
    if (!submission.maps.contains(item)) missing.push_back(item);
  if (!missing.empty())
    throw InputError(fmt::format("has no map of {} of {} items, such as {}", missing.size(),
                                 expected.points.size(), missing.front()));
}

// Moves the maps out of the files; what is left has a name that is known.
Texts sorted_files(std::vector<ZipEntry> entries, Submission& submission) {
  Texts files;
  for (ZipEntry& entry : entries) {
    if (entry.name.starts_with(kMapsFolder) && entry.name.ends_with(kMapEnding))
      submission.maps[entry.name.substr(kMapsFolder.size(), entry.name.size() - kMapsFolder.size() -
                                                                kMapEnding.size())] = std::move(entry.bytes);
    else if (entry.name == kCardFile || entry.name == kManifestFile || entry.name == kConfigurationFile ||
             entry.name == kResultsFile)
      files[entry.name] = std::move(entry.bytes);
    else
      throw InputError(fmt::format("the file {} is no part of a submission", in_quotes(entry.name)));
  }
  return files;
}

Submission checked(std::vector<ZipEntry> entries, const Expected& expected) {
  Submission submission;
  const Texts files = sorted_files(std::move(entries), submission);
  submission.manifest = read_yaml<Manifest>(require_file(files, kManifestFile), std::string(kManifestFile));
  if (submission.manifest.format != kSubmissionFormat)
    throw InputError(fmt::format("submission.yaml: format is {}, expected {}",
                                 in_quotes(submission.manifest.format), kSubmissionFormat));
  submission.card = read_card(require_file(files, kCardFile), std::string(kCardFile));
  check_protocol(submission, require_file(files, kConfigurationFile), expected);
  if (submission.manifest.data != expected.data.hex())
    throw InputError(fmt::format("other data: their digest is {}, expected {}",
                                 in_quotes(submission.manifest.data), expected.data.hex()));
  submission.results = require_file(files, kResultsFile);
  check_maps(submission, expected);
  return submission;
}

}  // namespace

ZipLimits Expected::limits() const {
  constexpr std::size_t kFiles = 4, kFolders = 1;
  std::uint64_t bytes = kFiles * kLongestText;
  for (const auto& [item, n] : points) bytes += n * sizeof(double) + kMapHeader + kRowOfResults;
  return {.entries = points.size() + kFiles + kFolders, .bytes = bytes};
}

std::string protocol_text(Config config) {
  config.models.clear();
  config.data = config.cache = config.output = "";
  config.pictures = Pictures::none;
  const std::string yaml = config_yaml(config);
  return yaml.substr(0, yaml.rfind("models:\n"));
}

Parameters leaderboard_parameters(Arguments& arguments, Parameters further) {
  further.push_back(
      {"-c,--config", &arguments.config,
       fmt::format("configuration, or the name of an installed one (default: {})", kConfiguration)});
  Parameters common = without(running_parameters(arguments), {"CONFIG", "--items"});
  further.insert(further.end(), common.begin(), common.end());
  return further;
}

Arguments leaderboard_arguments(Arguments arguments) {
  if (arguments.config.empty()) arguments.config = kConfiguration;
  arguments.items = kScoredItems;
  return arguments;
}

Expected expected_of(Session& session) {
  Expected expected{protocol_text(session.setup.config), identity_of(session.setup.inputs).digest, {}};
  const Project& project = session.setup.project;
  for (std::size_t truth = 0; truth < project.rules.size(); ++truth) {
    if (!has_role(project.rules[truth], Role::ground_truth)) continue;
    for (const Unit unit : project.units.of(project.rules[truth].over)) {
      if (!session.resolver.plan()[{truth, unit}].known()) continue;
      const ValuePtr value = session.resolver.value({truth, unit});
      expected.points[project.units.name(unit)] = value_as<GroundTruth>(*value).saliency.size();
    }
  }
  return expected;
}

Card read_card(const std::string& yaml, const std::string& name) {
  const auto card = read_yaml<Card>(yaml, name);
  std::vector<std::string_view> missing;
  Card::fields(card, [&](std::string_view key, const std::string& value, const OptionHelp&) {
    if (value.empty() && key != "date" && key != "url") missing.push_back(key);
    if (std::ranges::any_of(value, [](unsigned char c) { return c < ' ' || c == 0x7f; }))
      throw InputError(fmt::format("{}: {} has a control character, expected one line of text", name, key));
    if (value.size() > kLongestValue)
      throw InputError(
          fmt::format("{}: {} has {} bytes, expected at most {}", name, key, value.size(), kLongestValue));
  });
  if (!missing.empty()) throw InputError(fmt::format("{}: lacks {}", name, fmt::join(missing, ", ")));
  if (const std::string wrong = wrong_with_model_name(card.name); !wrong.empty())
    throw InputError(fmt::format("{}: name {} {}", name, in_quotes(card.name), wrong));
  if (!card.date.empty() && !is_date(card.date))
    throw InputError(
        fmt::format("{}: date is {}, expected one such as 2026-11-23", name, in_quotes(card.date)));
  return card;
}

std::vector<ZipEntry> entries_of(const Submission& submission, const std::string& card,
                                 const std::string& configuration) {
  std::vector<ZipEntry> entries = {
      {std::string(kManifestFile), options_text(submission.manifest, false, true)},
      {std::string(kCardFile), card},
      {std::string(kConfigurationFile), configuration},
      {std::string(kResultsFile), submission.results}};
  for (const auto& [item, map] : submission.maps)
    entries.push_back({fmt::format("{}{}{}", kMapsFolder, item, kMapEnding), map});
  return entries;
}

Submission read_submission(const std::filesystem::path& archive, const Expected& expected) {
  return checked(read_zip(archive, expected.limits()), expected);
}

}  // namespace salbench
