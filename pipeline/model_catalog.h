// The table of saliency models. A new model is its file pair in stages/models and one row here; its section
// in a configuration follows from the row.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "pipeline/option_text.h"
#include "pipeline/section.h"
#include "stages/models/model.h"

namespace salbench {

// What a model reads beside the points: the parts of ModelInput that are filled, and the stages it waits for.
enum Reads : unsigned {
  kReadsPoints = 0,
  kReadsNormals = 1U << 0U,
  kReadsFaces = 1U << 1U,  // of a scan: its partial mesh
  kReadsFpfh = 1U << 2U,   // the shared descriptors
  kReadsSeed = 1U << 3U,   // random numbers: the key then carries seed and item
};

// A model with its options bound.
struct Model {
  std::string name;
  std::int32_t version = 0;  // raised when the model's output changes: old artefacts are then not used
  unsigned reads = 0;
  std::string options;  // canonical text
  std::function<ScalarField(const ModelInput&)> saliency;
};

struct ModelRow {
  std::string_view name;
  // Reads the model's section over the defaults of the protocol.
  std::function<Model(const Section& section, Protocol protocol)> bind;
};

std::span<const ModelRow> model_rows();

}  // namespace salbench
