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

// From recordings of gaze to ground truth.
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

// The unit of inference: what one observation is. The views of a mesh share its form and its participants:
// they are no independent shapes, and intervals that take them for such are too narrow.
enum class Observation : std::uint8_t {
  mesh,        // a mesh, its score being the mean over its scans; a point cloud
  item_class,  // a class of shapes: for statements about kinds of shapes
  shape        // a mesh, scan or point cloud: the paper's reading, which takes 12 scans for 12 shapes
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

// Which pictures a run makes; no score needs them. In this order, each makes more than the one before.
enum class Pictures { none, cached, computed };

inline constexpr std::uint64_t kDefaultSeed = 2016;

inline constexpr const char* kSimulatedNote =
    "SIMULATED participants: the ground truth was made by the program; these scores say nothing about "
    "people.";

struct Config {
  std::string name;                 // the file's stem
  std::string folder;               // that files which it names lie in
  std::string data, cache, output;  // folders; empty where only the command line can say
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
  Pictures pictures = Pictures::none;  // computed where the file has the section
  bool cached_alone = false;           // nothing is computed but shapes and how they look
  std::vector<Model> models;           // in the order of the file

  bool simulated() const { return dataset.participants == Participants::simulated; }
  bool recorded() const { return dataset.participants == Participants::recorded; }
  bool on_faces() const { return dataset.score_on == ScoreOn::faces; }
};

// Throws ConfigError: "file:line: key what is wrong", a line for each thing that is.
Config read_config(const Section& root, const std::string& name);

// The complete configuration as YAML that read_config reads back as the same, but for models with given maps,
// which no configuration names.
std::string config_yaml(const Config& config);

// The same with a comment above each option: its meaning, unit and the values accepted.
std::string annotated_config_yaml(const Config& config);

}  // namespace salbench
