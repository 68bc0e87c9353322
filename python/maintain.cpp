// SPDX-License-Identifier: GPL-3.0-or-later
// Cache maintenance (gc, verify), texts of configurations, and versions of libraries.
#include "pipeline/engine/maintain.h"

#include <string>
#include <vector>

#include <pybind11/stl.h>

#include "cache/verify.h"
#include "pipeline/results/record.h"
#include "pipeline/run/maintain.h"
#include "pipeline/run/session.h"
#include "python/counts.h"
#include "python/front.h"
#include "python/module.h"
#include "python/request.h"
#include "python/texts.h"
#include "stages/models/chi2_kernel.h"

namespace salbench::python {
namespace {

py::list faults_of(const std::vector<Fault>& faults) {
  py::list list;
  for (const Fault& fault : faults)
    list.append(
        py::dict(py::arg("file") = file_text(fault.file.string()), py::arg("what") = file_text(fault.what)));
  return list;
}

py::dict verify(const std::string& cache, py::handle progress) {
  Verification found;
  interruptible(progress, [&](Progress& counts, const std::atomic<bool>& stop) {
    found = verify_cache(cache, stop, counts);
  });
  return py::dict(py::arg("cache") = file_text(cache), py::arg("artefacts") = found.artefacts,
                  py::arg("bytes") = found.bytes, py::arg("other_files") = found.others,
                  py::arg("faults") = faults_of(found.faults));
}

// Recomputes a sample of the cached jobs of a configuration.
py::dict verify_sample(const py::object& settings, std::size_t sample) {
  std::string name;
  Recomputation found;
  interruptible(py::none(), [&, request = request_from(settings), front = python_front(settings)](
                                Progress&, const std::atomic<bool>& stop) {
    const Setup setup(request, front);
    FolderStore store(setup.cache, Access::read_only);
    found = recompute_sample(setup.project, make_plan(setup.project, store), store, sample, stop);
    name = setup.config.name;
  });
  return py::dict(py::arg("configuration") = file_text(name), py::arg("jobs") = found.jobs,
                  py::arg("faults") = faults_of(found.faults));
}

py::str cache_of(const py::object& settings) {
  return file_text(placed_config_of(request_from(settings), python_front()).cache);
}

py::dict amount(const Amount& amount) {
  return py::dict(py::arg("files") = amount.files, py::arg("bytes") = amount.bytes);
}

py::dict collect_garbage(const py::list& kept, const std::string& cache, const std::string& stages,
                         bool dry_run, py::handle progress) {
  CollectOptions options{.kept = {}, .cache = cache, .stages = stages, .dry_run = dry_run};
  for (const py::handle settings : kept) options.kept.push_back(request_from(settings));
  CollectedCache found;
  interruptible(progress, [&](Progress& counts, const std::atomic<bool>&) {
    found = collect(options, python_front(), counts);
  });
  py::list rows;
  for (const auto& [stage, remaining, removed] : found.collected.stages)
    rows.append(py::dict(py::arg("stage") = stage, py::arg("kept") = amount(remaining),
                         py::arg("removed") = amount(removed)));
  return py::dict(py::arg("cache") = file_text(found.cache.string()), py::arg("dry_run") = dry_run,
                  py::arg("stages") = rows, py::arg("damaged") = amount(found.collected.damaged),
                  py::arg("unfinished") = amount(found.collected.unfinished),
                  py::arg("waiting") = found.waiting);
}

py::str config_text(const std::string& given) {
  const Section written = given.empty() ? Section::from_text("", "defaults") : configuration(given);
  return file_text(annotated_config_yaml(read_config(written, "")));
}

}  // namespace

void bind_maintain(py::module_& module) {
  module.def("verify_cache", &verify);
  module.def("verify_sample", &verify_sample);
  module.def("cache_of", &cache_of);
  module.def("collect_garbage", &collect_garbage);
  module.def("config_text", &config_text);
  module.def("libraries", &libraries);
  module.attr("instructions") = chi2_kernel::kernel().instructions;
  module.def("write_options_for_the_command_line", [] { options_are_arguments = false; });
}

}  // namespace salbench::python
