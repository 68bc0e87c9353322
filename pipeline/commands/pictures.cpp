// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "pipeline/commands/interrupt.h"
#include "pipeline/commands/session.h"
#include "pipeline/commands/subcommands.h"

namespace salbench {
namespace {

std::vector<std::size_t> picture_rows(const Catalog& catalog) {
  std::vector<std::size_t> pictures;
  for (std::size_t row = 0; row < catalog.rows.size(); ++row)
    if (catalog.rows[row].kind == "picture") pictures.push_back(row);
  return pictures;
}

ExitStatus run_pictures(const Arguments& arguments, const std::atomic<bool>& stop) {
  Session session(arguments, stop, {}, Pictures::computed);
  const Catalog& catalog = session.setup.catalog;
  const std::vector<std::size_t> pictures = picture_rows(catalog);
  {
    const OrderlyEnd orderly;
    session.runner.run_rows("pictures", ancestors(catalog, pictures), thread_count(arguments));
  }
  if (stop) return interrupted_status(arguments);
  std::size_t computed = 0, known = 0;
  for (const std::size_t row : pictures) {
    computed += session.runner.records()[row].seconds.size();
    for (const Job& job : session.plan.jobs[row]) known += job.known() ? 1U : 0U;
  }
  if (!arguments.quiet)
    fmt::print("{} pictures in {}, {} of them computed now; `salbench export` contains them\n", known,
               session.setup.cache.string(), computed);
  return finished_status(session);
}

}  // namespace

Subcommand pictures_subcommand(Arguments& arguments) {
  return {"pictures", "compute pictures of all shapes for reports; export then contains them",
          run_parameters(arguments),
          [&arguments](const std::atomic<bool>& stop) { return run_pictures(arguments, stop); }};
}

}  // namespace salbench
