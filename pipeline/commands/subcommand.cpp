// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/commands/subcommand.h"

#include <algorithm>

#include <fmt/format.h>

#include "stages/core/errors.h"

namespace salbench {
namespace {

Parameters joined(Parameters parameters, const Parameters& further) {
  parameters.insert(parameters.end(), further.begin(), further.end());
  return parameters;
}

}  // namespace

Parameter of_path(Parameter parameter) {
  parameter.is_path = true;
  return parameter;
}

Parameter config_parameter(Arguments& arguments) {
  return of_path({"CONFIG", &arguments.config,
                  "configuration file (YAML), or the name of an installed one, such as shrec07", true});
}

Parameter shard_parameter(Arguments& arguments) {
  return {"--shard", &arguments.shard,
          "only share I of N of the items, as I/N; a run without it then merges the shares"};
}

Parameter data_parameter(Arguments& arguments) {
  return of_path({"--data", &arguments.data, "folder of the data set"});
}

namespace {

Parameter cache_parameter(Arguments& arguments) {
  return of_path(
      {"--cache", &arguments.cache, "folder of the artefacts (default: cache in CONFIG, or salbench-cache)"});
}

}  // namespace

Parameter output_parameter(Arguments& arguments) {
  return of_path({"--out", &arguments.output,
                  "folder of the results (default: output in CONFIG, or salbench-out/NAME)"});
}

Parameter threads_parameter(Arguments& arguments) {
  return {"--threads", &arguments.threads, "threads (default: all cores); results do not depend on it", false,
          kMostThreads};
}

Parameters selecting_parameters(Arguments& arguments) {
  return {
      {"--items", &arguments.items,
       "only these shapes and their scans, such as 1-20,52,125, or scored: all with ground truth"},
      {"--split", &arguments.split,
       "only this split of the data set, such as test; '': all, where CONFIG names one"},
      of_path(
          {"--reference", &arguments.reference,
           "match to this histogram (CSV with a column GS of 100 bins), not to the mean over the data set; "
           "items: to the mean over --items"})};
}

Parameters planning_parameters(Arguments& arguments, const Parameters& further) {
  return joined(joined({config_parameter(arguments), data_parameter(arguments), cache_parameter(arguments)},
                       selecting_parameters(arguments)),
                further);
}

Parameters running_parameters(Arguments& arguments, const Parameters& further) {
  return planning_parameters(
      arguments,
      joined({threads_parameter(arguments),
              {"--quiet", &arguments.quiet, "neither progress nor tables; warnings and errors only"}},
             further));
}

Parameters maintaining_parameters(Arguments& arguments, const Parameters& further) {
  return joined(
      joined({data_parameter(arguments), cache_parameter(arguments)}, selecting_parameters(arguments)),
      joined({{"--quiet", &arguments.quiet, "name what is wrong, and nothing else"}}, further));
}

Parameters needing(Parameters parameters, const std::string& needed, const std::vector<std::string>& names) {
  for (Parameter& parameter : parameters)
    if (std::ranges::find(names, parameter.name) != names.end()) parameter.needs = needed;
  return parameters;
}

Parameters without(Parameters parameters, const std::vector<std::string>& names) {
  std::erase_if(parameters, [&](const Parameter& parameter) {
    return std::ranges::find(names, parameter.name) != names.end();
  });
  return parameters;
}

}  // namespace salbench
