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
#include "stages/core/rng.h"
#include "stages/core/types.h"
#include "stages/models/hs.h"

namespace salbench {

struct GivenMaps;  // pipeline/given_maps.h

// What a model reads beside the points: the parts of MapInputs that are filled, and the stages it waits for.
enum Reads : unsigned {
  kReadsPoints = 0,
  kReadsNormals = 1U << 0U,
  kReadsFaces = 1U << 1U,  // of a scan: its partial mesh
  kReadsFpfh = 1U << 2U,   // the shared descriptors
  kReadsSeed = 1U << 3U,   // random numbers: the key then carries seed and item
};

// Only the parts that the model's row names are filled; the others are empty.
struct MapInputs {
  Points points = {};
  const Normals* normals = nullptr;
  Surface surface = {};
  const Descriptors* fpfh = nullptr;
  RandomSource random = {};
};

// A model with its options bound: a map of every shape, computed or given, or, as HS alone, people against
// people on meshes.
struct Model {
  std::string name;
  std::int32_t version = 0;  // raised when the model's output changes: old artefacts are then not used
  unsigned reads = 0;
  std::string options = {};  // canonical text
  std::function<ScalarField(const MapInputs&)> saliency = {};
  std::function<HumanCurve(const Mesh&, const GroundTruth&, const GroupScorer&, Rng)> people = {};

  std::shared_ptr<const GivenMaps> given = {};

  bool is_map() const { return saliency != nullptr || given != nullptr; }
};

struct ModelRow {
  std::string_view name;
  // Reads the model's section over the defaults of the protocol.
  std::function<Model(const Section& section, Protocol protocol)> bind;
};

// A row of the table. `saliency` passes the model what its signature names.
template <class Options>
ModelRow model_row(std::string_view name, std::int32_t version, unsigned reads,
                   ScalarField (*saliency)(const MapInputs&, const Options&)) {
  return {name, [=](const Section& section, Protocol protocol) {
            auto options = preset<Options>(protocol);
            section.read(options);
            return Model{std::string(name), version, reads, options_text(options),
                         [=](const MapInputs& in) { return saliency(in, options); }};
          }};
}

std::span<const ModelRow> model_rows();

}  // namespace salbench
