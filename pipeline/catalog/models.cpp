// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/catalog/models.h"

#include <array>

#include "stages/models/cs.h"
#include "stages/models/ls.h"
#include "stages/models/ms.h"
#include "stages/models/ps.h"
#include "stages/models/rs.h"

namespace salbench {
namespace {

ModelRow human_row(std::string_view name, std::int32_t version) {
  return {name, [=](const Section& written, Protocol protocol) {
            auto options = preset<HsOptions>(protocol);
            written.read(options);
            return Model{.name = std::string(name),
                         .version = version,
                         .options = options_text(options),
                         .annotated_options = annotated_options_text(options),
                         .human = options};
          }};
}

}  // namespace

std::span<const ModelRow> model_rows() {
  static const std::array rows = {
      model_row("LS", 4, ls_saliency),
      model_row("CS", 2, cs_saliency),
      model_row("PS", 1, ps_saliency),
      model_row("MS", 1, ms_saliency),
      human_row("HS", 1),
      model_row("RS", 1, rs_saliency),
  };
  return rows;
}

}  // namespace salbench
