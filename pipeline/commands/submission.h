// SPDX-License-Identifier: GPL-3.0-or-later
// A submission to a leaderboard: one ZIP archive with a model's maps, its card, and the protocol that its
// scores were made by. docs/leaderboard.md says what is in it.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "cache/digest.h"
#include "io/zip_file.h"
#include "pipeline/commands/session.h"
#include "pipeline/config/option_text.h"

namespace salbench {

inline constexpr std::size_t kLongestText = 64U << 10U;  // of a YAML file
inline constexpr std::string_view kSubmissionFormat = "salbench submission 1";

// card.yaml: what the authors declare of a model.
struct Card {
  std::string name, citation, licence, training_data, test_overlap, date, url;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("name", self.name, {"of the model, in tables: letters, digits, '-' and '_'"});
    visit("citation", self.citation, {"how to cite it"});
    visit("licence", self.licence, {"of model and maps"});
    visit("training_data", self.training_data, {"what it was trained on; none for a model that was not"});
    visit("test_overlap", self.test_overlap, {"items of this data set among the training data; none"});
    visit("date", self.date, {"of the submission, as 2026-11-23; may be left out"});
    visit("url", self.url, {"of the model's page; may be left out"});
  }
};

// submission.yaml: what the archive was made from.
struct Manifest {
  std::string format, program, commit, protocol, configuration, data;  // the last two are digests
  std::int32_t maps = 0;
  Words stages;  // "mesh 2": versions of what was computed

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("format", self.format, {kSubmissionFormat});
    visit("program", self.program, {"version"});
    visit("commit", self.commit, {"that it was built from"});
    visit("protocol", self.protocol, {"published or text"});
    visit("configuration", self.configuration, {"digest of configuration.yaml"});
    visit("data", self.data, {"digest of names, shapes and ground truth of all items that are scored"});
    visit("maps", self.maps, {"number of maps"});
    visit("stages", self.stages, {"versions of the stages"});
  }
};

// What a submission is held against, from a run over the data set that has no maps of it.
struct Expected {
  std::string configuration;  // protocol_text of the configuration
  Digest data;
  std::map<std::string, std::size_t> points;  // of each shape that has ground truth, by its name

  ZipLimits limits() const;
};

struct Submission {
  Manifest manifest;
  Card card;
  std::string results;                      // results.csv as it came
  std::map<std::string, std::string> maps;  // .npy, by the shape's name
};

// The configuration without models and folders: what makes scores of the same maps the same.
std::string protocol_text(Config config);

// Parameters of a run over what has ground truth whose configuration need not be named; `further` come first.
Parameters leaderboard_parameters(Arguments& arguments, Parameters further);
// The configuration and what it is run over, of such a command.
Arguments leaderboard_arguments(Arguments arguments);

// Of a session that has run. The data set's files are read for their digest.
Expected expected_of(Session& session);

// Throws InputError that names every key that is missing, or the first that is wrong.
Card read_card(const std::string& yaml, const std::string& name);

std::vector<ZipEntry> entries_of(const Submission& submission, const std::string& card,
                                 const std::string& configuration);

// Reads an archive from anybody and checks all of it but its scores. Throws InputError: one line, why it is
// refused.
Submission read_submission(const std::filesystem::path& archive, const Expected& expected);

}  // namespace salbench
