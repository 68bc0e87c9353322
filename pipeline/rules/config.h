// SPDX-License-Identifier: GPL-3.0-or-later
// Configuration of a run: parsed from YAML, validated, defaults filled in.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/config/section.h"
#include "pipeline/rules/models.h"
#include "stages/descriptors/fpfh.h"
#include "stages/gaze/ground_truth.h"
#include "stages/ground_truth/simulation.h"
#include "stages/metrics/options.h"
#include "stages/normals/normals.h"
#include "stages/picture/picture.h"
#include "stages/scan/scan.h"
#include "stages/surface/surface.h"

namespace salbench {

enum class Participants { measured, simulated, recorded };
template <>
struct EnumNames<Participants> {
  static constexpr std::array<std::string_view, 3> names{"measured", "simulated", "recorded"};
};

// Elements that maps are scored on.
enum class ScoreOn { vertices, faces };
template <>
struct EnumNames<ScoreOn> {
  static constexpr std::array<std::string_view, 2> names{"vertices", "faces"};
};

struct DatasetOptions {
  std::string layout{kAutomaticLayout};
  std::string split;
  bool meshes = true;
  bool scans = true;
  Participants participants = Participants::measured;
  ScoreOn score_on = ScoreOn::vertices;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(
        "layout", self.layout,
        {"how the folder is laid out: automatic, a name of docs/data_sets.md, or a file of your own (.py)"});
    visit("split", self.split, {"only the items of this split, such as test; none: all items"});
    visit("meshes", self.meshes, {"evaluate the meshes themselves"});
    visit("scans", self.scans, {"evaluate 12 simulated scans of each mesh"});
    visit("participants", self.participants,
          {"ground truth from files, made up, or from gaze (without other files measured, too)"});
    visit("score_on", self.score_on,
          {"elements that maps are scored on; faces: against values that are published per face"});
  }
};
void check(const DatasetOptions& options);

// Ground truth from gaze recordings.
struct GazeOptions {
  FixationOptions fixations;
  GazeHitOptions hits;
  GazeTruthOptions truth;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    FixationOptions::fields(self.fixations, visit);
    GazeHitOptions::fields(self.hits, visit);
    GazeTruthOptions::fields(self.truth, visit);
  }
};

// Unit of inference, that is one observation. Views of a mesh share its shape and participants: they are not
// independent, and intervals that treat them as such are too narrow.
enum class Observation : std::uint8_t {
  mesh,        // a mesh, scored by the mean over its scans, or a point cloud
  item_class,  // a class of shapes: for claims about kinds of shapes
  shape        // a mesh, scan or point cloud, as in the paper, where 12 scans count as 12 shapes
};
template <>
struct EnumNames<Observation> {
  static constexpr std::array<std::string_view, 3> names{"mesh", "class", "shape"};
};

struct StatisticsOptions {
  Observation unit = Observation::mesh;
  std::string leading;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("unit", self.unit, {"what counts as one observation in intervals, tests and ranks"});
    visit("leading", self.leading,
          {"metric that models are ranked by; the others stand beside it; none: the first of the tables"});
  }
};

// Pictures that a run computes; no score needs them. Each value includes the previous one.
enum class Pictures { none, cached, computed };

inline constexpr std::uint64_t kDefaultSeed = 2016;

inline constexpr const char* kSimulatedNote =
    "SIMULATED participants: the ground truth was made by the program; these scores say nothing about "
    "people.";

struct Config {
  std::string name;                 // the file's stem
  std::string folder;               // base of relative paths in the file
  std::string data, cache, output;  // folders; empty: only the command line may set them
  Protocol protocol = Protocol::published;
  std::uint64_t seed = kDefaultSeed;
  DatasetOptions dataset;
  SimulationOptions simulation;
  GazeOptions gaze;
  ScanOptions scan;
  MeshNormalsOptions normals;
  ScanNormalsOptions scan_normals;
  SurfaceOptions surface;
  FpfhOptions fpfh;
  ScanFpfhOptions scan_fpfh;
  MetricsOptions metrics;
  StatisticsOptions statistics;
  PictureOptions picture;
  Pictures pictures = Pictures::none;  // computed if the file has the section
  bool cached_alone = false;           // only shapes and their pictures are computed
  std::vector<Model> models;           // in the file's order

  bool simulated() const { return dataset.participants == Participants::simulated; }
  bool recorded() const { return dataset.participants == Participants::recorded; }
  bool on_faces() const { return dataset.score_on == ScoreOn::faces; }
};

// Throws ConfigError, one line "file:line: key problem" per error.
Config read_config(const Section& root, const std::string& name);

// Complete configuration as YAML; read_config returns an equal one, except for models with given maps, which
// a configuration cannot name.
std::string config_yaml(const Config& config);

// The same with a comment above each option: meaning, unit and accepted values.
std::string annotated_config_yaml(const Config& config);

}  // namespace salbench
