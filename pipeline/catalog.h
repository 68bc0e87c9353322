// THE table of stages: what there is to compute for a mesh and for a scan of it, from what, and how.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "io/dataset.h"
#include "io/value.h"
#include "pipeline/config.h"
#include "pipeline/source.h"

namespace salbench {

// Source of an input: an earlier stage of the same shape, a stage of the mesh that the shape is a scan of, or
// the reference histogram of the data set.
struct Input {
  enum class From : std::uint8_t { shape, mesh, reference } from = From::shape;
  std::size_t stage = 0;  // index in that chain
};

enum class Source : std::uint8_t { none, mesh_file, truth_files, map_file };

struct StageInputs {
  std::vector<const Value*> values;  // in the order of the row's inputs
  std::vector<SourceData> files;     // of the row's source, as they were read for this job
  const DatasetItem* source = nullptr;
  std::uint64_t seed = 0;
  std::string item;  // "52", "52_3"
  int view = 0;      // of a scan

  template <class T>
  const T& get(std::size_t i) const {
    return std::get<T>(*values[i]);
  }
};

// Canonical text of an options struct, with the path of its section in the configuration.
struct OptionLines {
  std::string section;  // "fpfh", "models.PS"
  std::string text;     // one `key: value` a line
};

struct Stage {
  std::string name;          // folder in the cache; the same for meshes and scans where the work is the same
  std::int32_t version = 1;  // raised when the output changes; tests/pipeline/golden_test.cpp watches
  std::string_view kind = {};             // layout of its result (io/value.h)
  std::vector<OptionLines> options = {};  // what it depends on
  std::vector<Input> inputs = {};
  Source source = Source::none;
  bool seeded = false;           // uses random numbers: seed and item enter the key
  bool per_view = false;         // the view enters the key
  bool after_reference = false;  // needs the whole data set's ground truth first: second pass
  std::function<bool(const DatasetItem&)> applies = {};  // to an item and its scans; empty: to every one
  std::function<Value(const StageInputs&)> run = {};
};

using Chain = std::vector<Stage>;  // every input stands before its user

// The mean over a whole data set, of meshes or of scans, of the histograms of one stage's fields.
struct MeanHistogram {
  std::string name;  // folder in the cache
  std::int32_t version = 1;
  std::string of_mesh, of_scan;  // the stage that is averaged, in either chain
};

struct Catalog {
  Chain mesh, scan;
  std::vector<MeanHistogram>
      means;  // first the ground truth's, the reference of the matching; then the maps'
};
inline constexpr std::size_t kReference = 0;  // in Catalog::means

Histogram histogram_of(const Value& value);  // of a ground truth's saliency, or of a map

Catalog make_catalog(const Config& config);

// Configuration path of a stage's option, such as "fpfh.radius"; the bare key if no section has it.
std::string option_path(const Stage& stage, std::string_view key);

// Index of a stage in a chain. Throws std::out_of_range.
std::size_t stage_index(const Chain& chain, std::string_view name);
bool has_stage(const Chain& chain, std::string_view name);

}  // namespace salbench
