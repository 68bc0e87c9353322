#include "pipeline/model_catalog.h"

#include <array>

#include "stages/models/cs.h"
#include "stages/models/hs.h"
#include "stages/models/ls.h"
#include "stages/models/ms.h"
#include "stages/models/ps.h"
#include "stages/models/rs.h"

namespace salbench {
namespace {

ModelRow row_of_people(std::string_view name, std::int32_t version) {
  return {name, [=](const Section& section, Protocol protocol) {
            auto options = preset<HsOptions>(protocol);
            section.read(options);
            return Model{.name = std::string(name),
                         .version = version,
                         .options = options_text(options),
                         .people = [=](const Mesh& mesh, const GroundTruth& truth, const GroupScorer& scorer,
                                       Rng rng) { return human_curve(mesh, truth, options, scorer, rng); },
                         .annotated_options = annotated_options_text(options)};
          }};
}

}  // namespace

std::span<const ModelRow> model_rows() {
  static const std::array rows = {
      model_row("LS", 1, kReadsNormals | kReadsFpfh, ls_saliency),
      model_row("CS", 1, kReadsNormals, cs_saliency),
      model_row("PS", 1, kReadsFpfh, ps_saliency),
      model_row("MS", 1, kReadsFaces, ms_saliency),
      row_of_people("HS", 1),
      model_row("RS", 1, kReadsSeed, rs_saliency),
  };
  return rows;
}

}  // namespace salbench
