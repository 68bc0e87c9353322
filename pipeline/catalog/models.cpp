// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/catalog/models.h"

#include <algorithm>
#include <array>

#include "stages/models/cb.h"
#include "stages/models/cs.h"
#include "stages/models/lce.h"
#include "stages/models/ls.h"
#include "stages/models/lvj.h"
#include "stages/models/mc.h"
#include "stages/models/ms.h"
#include "stages/models/ps.h"
#include "stages/models/rs.h"
#include "stages/models/vis.h"

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

ModelRow only_if_named(ModelRow row) {
  row.by_default = false;
  return row;
}

ModelRow reference(ModelRow row) {
  row.is_reference = true;
  return row;
}

}  // namespace

std::span<const ModelRow> model_rows() {
  static const std::array rows = {
      model_row("LS", 5, ls_saliency),
      model_row("CS", 3, cs_saliency),
      model_row("PS", 1, ps_saliency),
      model_row("MS", 1, ms_saliency),
      reference(human_row("HS", 1)),
      reference(model_row("RS", 1, rs_saliency)),
      // Beside the paper's: configs/extended.yaml has them.
      only_if_named(model_row("MC", 1, mc_saliency)),
      only_if_named(model_row("LVJ", 1, lvj_saliency)),
      only_if_named(model_row("LCE", 1, lce_saliency)),
      only_if_named(model_row("CB", 1, cb_saliency)),
      only_if_named(model_row("VIS", 1, vis_saliency)),
  };
  return rows;
}

bool is_reference_model(std::string_view name) {
  return name == kConstantMap || std::ranges::any_of(model_rows(), [&](const ModelRow& row) {
           return row.is_reference && row.name == name;
         });
}

}  // namespace salbench
