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
                                       Rng rng) { return human_curve(mesh, truth, options, scorer, rng); }};
          }};
}

ScalarField ls(const MapInputs& in, const LsOptions& options) {
  return ls_saliency(in.points, *in.normals, *in.fpfh, options);
}
ScalarField cs(const MapInputs& in, const CsOptions& options) {
  return cs_saliency(in.points, *in.normals, options);
}
ScalarField ps(const MapInputs& in, const PsOptions& options) {
  return ps_saliency(in.points, *in.fpfh, options);
}
ScalarField ms(const MapInputs& in, const MsOptions& options) {
  return ms_saliency(in.points, in.surface, options);
}
ScalarField rs(const MapInputs& in, const RsOptions& options) {
  return rs_saliency(in.points, in.random, options);
}

}  // namespace

std::span<const ModelRow> model_rows() {
  static const std::array rows = {
      model_row("LS", 1, kReadsNormals | kReadsFpfh, ls),
      model_row("CS", 1, kReadsNormals, cs),
      model_row("PS", 1, kReadsFpfh, ps),
      model_row("MS", 1, kReadsFaces, ms),
      row_of_people("HS", 1),
      model_row("RS", 1, kReadsSeed, rs),
  };
  return rows;
}

}  // namespace salbench
