// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/commands/summary.h"

namespace salbench {

Json summary_of(const Session& session) {
  const Setup& setup = session.setup;
  return {{"meshes", setup.inputs.count(kMeshes)},
          {"clouds", setup.inputs.count(kClouds)},
          {"models", setup.config.models.size()},
          {"cache", setup.cache},
          {"computed", session.resolver.computed()},
          {"interrupted", session.stop.load()},
          {"failed", list_of(session.resolver.failures(), [&](const Failure& failure) {
             return Json{{"item", setup.project.name(failure.job)},
                         {"stage", setup.project.rule(failure.job).stage},
                         {"why", failure.cause}};
           })}};
}

Json rows_json(const Table& table) {
  const Table texts = parse_csv(to_csv(table), "table");
  return list_of(texts.rows, [&](const std::vector<Cell>& row) {
    Json object;
    for (std::size_t column = 0; column < row.size(); ++column)
      object[texts.columns[column]] = std::get<std::string>(row[column]);
    return object;
  });
}

}  // namespace salbench
