// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <memory>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "pipeline/commands/interrupt.h"
#include "pipeline/commands/progress.h"
#include "pipeline/commands/report.h"
#include "pipeline/commands/session.h"
#include "pipeline/commands/subcommands.h"
#include "pipeline/config/data_layout.h"
#include "pipeline/inputs/conversion.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

std::size_t count_of(const Conversion& conversion, Outcome outcome) {
  return static_cast<std::size_t>(std::ranges::count(conversion.shapes, outcome, &ConvertedShape::outcome));
}

std::size_t n_problems(const Conversion& conversion) {
  return static_cast<std::size_t>(std::ranges::count_if(
      conversion.shapes, [](const ConvertedShape& shape) { return !shape.problem.empty(); }));
}

Json json_of(const Conversion& conversion) {
  return {{"layout", conversion.layout},
          {"shapes", list_of(conversion.shapes,
                             [](const ConvertedShape& shape) {
                               return Json{{"name", shape.name},
                                           {"outcome", name_of(shape.outcome)},
                                           {"problem", shape.problem}};
                             })},
          {"written", count_of(conversion, Outcome::written)},
          {"unchanged", count_of(conversion, Outcome::unchanged)},
          {"removed", conversion.removed},
          {"n_problems", n_problems(conversion)}};
}

std::string text_of(const Conversion& conversion, const Arguments& arguments) {
  if (arguments.quiet) return {};
  return fmt::format("{} of {} shapes written to {}, {} unchanged, {} removed, {} with problems\n",
                     count_of(conversion, Outcome::written), conversion.shapes.size(), arguments.to,
                     count_of(conversion, Outcome::unchanged), conversion.removed, n_problems(conversion));
}

ExitStatus run_convert(const Arguments& arguments, const std::string& layout, ReportFormat format,
                       const std::atomic<bool>& stop) {
  require_layout("convert", layout);
  const std::vector<Layout> layouts = layouts_of(layout);
  if (!layouts[0].index.empty())
    throw ConfigError(fmt::format("convert: {} is the one form already", layout));
  if (arguments.data.empty()) throw ConfigError("convert: names no data set: give --data DIR");
  const OrderlyEnd orderly;
  const auto progress = progress_of(arguments.quiet);
  const Conversion conversion = convert_data(arguments.data, layouts, arguments.items,
                                             arguments.split.value_or(""), arguments.to, *progress, stop);
  for (const std::string& note : conversion.notes) spdlog::warn("{}", note);
  for (const ConvertedShape& shape : conversion.shapes)
    if (!shape.problem.empty()) spdlog::error("{}: {}", shape.name, shape.problem);
  if (stop) return interrupted_status(arguments);
  print_report(format, "convert", json_of(conversion), text_of(conversion, arguments));
  return n_problems(conversion) > 0 ? kSomeFailed : kAllDone;
}

}  // namespace

Subcommand convert_subcommand(Arguments& arguments) {
  const auto layout = std::make_shared<std::string>();
  const FormatWord format = default_format();
  return {"convert",
          "write a data set in one form, an HDF5 file per shape and an index, which is the layout hdf5",
          {layout_parameter(layout.get()),
           data_parameter(arguments),
           {"--to", &arguments.to, "folder that the set is written to", true},
           {"--items", &arguments.items, "only these shapes, such as 1-20,52,125"},
           {"--split", &arguments.split, "only this split of the data set, such as test"},
           {"--quiet", &arguments.quiet, "neither progress nor a summary; warnings and errors only"},
           format_parameter(format)},
          [&arguments, layout, format](const std::atomic<bool>& stop) {
            return run_convert(arguments, *layout, format_of(format), stop);
          }};
}

}  // namespace salbench
