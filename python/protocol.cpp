// SPDX-License-Identifier: GPL-3.0-or-later
// What makes scores of two programs comparable: the protocol, and digests and names as the program has them.
#include "python/protocol.h"

#include "cache/digest.h"
#include "pipeline/commands/commit.h"
#include "pipeline/config/section.h"
#include "pipeline/rules/models.h"
#include "python/module.h"

namespace salbench::python {

std::string protocol_text(Config config) {
  config.models.clear();
  config.data = config.cache = config.output = "";
  config.pictures = Pictures::none;
  const std::string yaml = config_yaml(config);
  return yaml.substr(0, yaml.rfind("models:\n"));
}

void bind_protocol(pybind11::module_& module) {
  module.attr("commit") = std::string(commit());
  module.def("protocol", [](const std::string& yaml, const std::string& name) {
    return protocol_text(read_config(Section::from_text(yaml, name), ""));
  });
  module.def("digest",
             [](const pybind11::bytes& bytes) { return file_digest(std::string_view(bytes)).hex(); });
  module.def("wrong_with_model_name", &wrong_with_model_name);
}

}  // namespace salbench::python
