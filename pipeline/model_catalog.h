// The table of models. A new saliency model is its file pair in stages/models and one row here; its section
// in a configuration follows from the row. HS has a row like the others, and is scored in its own way.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "pipeline/option_text.h"
#include "pipeline/section.h"
#include "stages/models/hs.h"
#include "stages/models/model.h"

namespace salbench {

struct GivenMaps;  // pipeline/given_maps.h

// What a model reads beside the points: the parts of ModelInput that are filled, and the stages it waits for.
enum Reads : unsigned {
  kReadsPoints = 0,
  kReadsNormals = 1U << 0U,
  kReadsFaces = 1U << 1U,  // of a scan: its partial mesh
  kReadsFpfh = 1U << 2U,   // the shared descriptors
  kReadsSeed = 1U << 3U,   // random numbers: the key then carries seed and item
};

// A model with its options bound: a map of every shape, computed or given, or, as HS alone, people against
// people on meshes.
struct Model {
  std::string name;
  std::int32_t version = 0;  // raised when the model's output changes: old artefacts are then not used
  unsigned reads = 0;
  std::string options = {};  // canonical text
  std::function<ScalarField(const ModelInput&)> saliency = {};
  std::function<HumanCurve(const Mesh&, const GroundTruth&, const GroupScorer&, Rng)> people = {};

  std::shared_ptr<const GivenMaps> given = {};

  std::string annotated_options = {};  // the options with a comment above each, for annotated_config_yaml()

  bool is_map() const { return saliency != nullptr || given != nullptr; }
};

struct ModelRow {
  std::string_view name;
  // Reads the model's section over the defaults of the protocol.
  std::function<Model(const Section& section, Protocol protocol)> bind;
};

// A row of the table, from the model's one signature.
template <class Options>
ModelRow model_row(std::string_view name, std::int32_t version, unsigned reads,
                   ScalarField (*saliency)(const ModelInput&, const Options&)) {
  return {name, [=](const Section& section, Protocol protocol) {
            auto options = preset<Options>(protocol);
            section.read(options);
            return Model{.name = std::string(name),
                         .version = version,
                         .reads = reads,
                         .options = options_text(options),
                         .saliency = [=](const ModelInput& input) { return saliency(input, options); },
                         .annotated_options = annotated_options_text(options)};
          }};
}

std::span<const ModelRow> model_rows();

}  // namespace salbench
