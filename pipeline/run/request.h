// SPDX-License-Identifier: GPL-3.0-or-later
// This folder: a run as one object. What was asked for comes in; a plan, artefacts and the files of a results
// folder go out. It includes everything but the bindings; the front and the native program are thin over it.
//
// This file: what was asked for, by a command line or a call of salbench.run, and what it means.
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

inline constexpr int kMostThreads = 1024;  // that anybody may ask for

// Request of a command line or a call. An empty field stands for the configuration's, or for the default.
struct Request {
  std::string config = {};  // a file, the record of a run, or a name: "shrec07", "protocols/3dva"
  std::optional<std::string> yaml = {};  // of a configuration, in place of a file
  std::string models = {};               // as YAML, in place of the configuration's; "{}": none of them
  std::optional<std::string> kept =
      {};                             // models of the configuration that stay: "LS,PS"; "": people and chance
  std::vector<Model> functions = {};  // that Python adds
  std::map<std::string, std::string> maps =
      {};                // made outside, by the name of their model: a folder or a file
  bool matched = false;  // their values are histogram-matched already
  std::string data = {}, cache = {}, output = {};
  ItemChoice items = {};
  std::optional<std::string> split = {};  // "": all items, whatever the configuration takes
  std::string shard = {};                 // "2/4"
  std::optional<Histogram> reference = {};
  bool reference_of_items = false;     // the mean over the items selected, in place of a histogram
  Pictures pictures = Pictures::none;  // at least these
  bool cached_alone = false;           // computes nothing but shapes and how they look
  bool keep_going = false;             // a model that fails alike on its first shapes is tried on all
};

// The items of a data set that are run, and the histogram that their maps are matched to.
struct Selection {
  ItemChoice items = {};  // all
  std::optional<Shard> shard = {};
  std::optional<Histogram> reference = {};  // nothing: the data set's own mean
  bool reference_of_items = false;          // the mean over the items selected, not over all
};

struct NoConfigurationError : ConfigError {
  using ConfigError::ConfigError;
};

// The configuration in a file, which may be the record of a run (run.yaml), or if no such file exists that of
// ours of this name. Throws NoConfigurationError if there is neither, with the nearest name.
Section configuration(const std::string& given);

// Configuration of a request, with its models and folders; that of the data set may be missing. Throws
// ConfigError.
Config config_of(const Request& request, const Front& front);
// The same with the usual folders filled in. Throws ConfigError also where there is no data set.
Config placed_config_of(const Request& request, const Front& front);
// Selection of a request. Where it chooses nothing and the configuration is the record of a run, that of the
// record.
Selection selection_of(const Request& request);
std::string selection_lines(const Selection& selection);  // of a record; empty for all items

// The stages that a list names: "map" stands for "map.LS" and all its like, and an empty list for all that
// are known. Throws ConfigError for a word that names none.
std::vector<std::string> selected_stages(const std::string& list, const std::vector<std::string>& known);

}  // namespace salbench
