// SPDX-License-Identifier: GPL-3.0-or-later
// This folder: a run as one object. A request comes in; a plan, artefacts and the files of a results folder
// go out. It includes everything except the bindings; the front and the native program are thin layers over
// it.
//
// This file: the request of a command line or of salbench.run, and its interpretation.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/inputs/front.h"
#include "pipeline/inputs/inputs.h"
#include "pipeline/rules/config.h"

namespace salbench {

inline constexpr int kMostThreads = 1024;  // upper limit for requests

// Request of a command line or a call. An empty field means the configuration's value or the default.
struct Request {
  std::string config = {};               // a file, a run's record, or a name: "shrec07", "protocols/3dva"
  std::optional<std::string> yaml = {};  // a configuration's text, in place of a file
  std::string models = {};               // as YAML, replacing the configuration's; "{}": none
  std::optional<std::string> kept = {};  // models to keep: "LS,PS"; "": only people and chance
  std::vector<Model> functions = {};     // added by Python
  std::map<std::string, std::string> maps = {};  // given maps by model name: a folder or a file
  bool matched = false;                          // given maps are already histogram-matched
  std::string data = {}, cache = {}, output = {};
  ItemChoice items = {};
  std::optional<std::string> split = {};  // "": all items, regardless of the configuration
  std::string shard = {};                 // "2/4"
  std::optional<Histogram> reference = {};
  bool reference_of_items = false;     // reference: mean over the selected items, no given histogram
  Pictures pictures = Pictures::none;  // lower bound
  bool cached_alone = false;           // compute only shapes and their pictures
  bool keep_going = false;             // try a failing model on all shapes, not only the first
};

// Selected items of a data set, and the histogram that their maps are matched to.
struct Selection {
  ItemChoice items = {};  // default: all
  std::optional<Shard> shard = {};
  std::optional<Histogram> reference = {};  // nullopt: the data set's mean
  bool reference_of_items = false;          // mean over the selected items instead of all
};

struct NoConfigurationError : ConfigError {
  using ConfigError::ConfigError;
};

// Configuration in a file, possibly a run's record (run.yaml); if there is no such file, the installed one of
// this name. Throws NoConfigurationError with the nearest name if neither exists.
Section configuration(const std::string& given);

// Configuration of a request, with its models and folders; the data set's folder may be missing. Throws
// ConfigError.
Config config_of(const Request& request, const Front& front);
// The same with default folders filled in. Throws ConfigError also if there is no data set.
Config placed_config_of(const Request& request, const Front& front);
// Selection of a request. If it has none and the configuration is a run's record, the record's selection.
Selection selection_of(const Request& request);
std::string selection_lines(const Selection& selection);  // for a record; empty for all items

// Stages named in a list: "map" means every "map.MODEL", an empty list all known stages. Throws ConfigError
// for a word that names none.
std::vector<std::string> selected_stages(const std::string& list, const std::vector<std::string>& known);

}  // namespace salbench
