// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/results/space.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "cache/layout.h"
#include "io/file.h"
#include "stages/core/options.h"

namespace salbench {
namespace {

constexpr double kMeshFileBytes = 38;    // per vertex, binary PLY: 3 floats, and 2 triangles of 13 bytes
constexpr double kCloudFileBytes = 12;   // per point, 3 floats
constexpr std::size_t kEnough = 8;       // artefacts of a rule whose sizes say something of the others
constexpr std::size_t kLookedAt = 1000;  // of a rule's artefacts
constexpr double kAround = 2500;     // bytes of an artefact's record and of HDF5, as measured and rounded up
constexpr double kRowOfTable = 200;  // bytes of a shape in a table of scores
constexpr double kBytesPerPixel = 1.3;  // of a picture, packed

// Of an artefact: of its arrays, as they are laid out (io/hdf5/value.cpp), and of all else, as measured and
// rounded up.
struct Size {
  std::string_view kind;
  double bytes_per_point, bytes;
};
constexpr std::array<Size, 10> kSizes = {{{"shape_in_form", 56, 8000},  // a vertex, its value, 2 triangles
                                          {"mesh", 48, 4000},           // a vertex, and 2 triangles
                                          {"point_cloud", 48, 4000},
                                          {"scan", 24, 4000},
                                          {"normals", 24, 2600},
                                          {"faces", 24, 2600},  // 2 triangles
                                          {"descriptors", 132, 4000},
                                          {"field", 8, 2600},
                                          {"ground_truth", 12, 4000},  // a value, and picks
                                          {"picture", 0, 4000}}};
constexpr Size kOther = {"", 0, 3200};  // numbers of a shape, however large it is

// Of descriptors, as measured on the meshes of scripts/demo and of SHREC'07 and rounded up; small arrays stay
// as they are.
constexpr double kPackedPart = 0.28, kPackedFrom = 65536;

double packed(double bytes) { return std::max(bytes * kPackedPart, std::min(bytes, kPackedFrom)); }

class Estimate {
 public:
  Estimate(const Config& config, const Inputs& inputs, const Project& project)
      : config_(config), project_(project), scan_points_(points_of_scan(config.scan)) {
    if (!inputs.shape_files) return;
    for (const std::vector<File>& files : *inputs.shape_files) {
      const auto bytes = files.empty() ? std::nullopt : size_of(files.front().place);
      file_bytes_.push_back(static_cast<double>(bytes.value_or(0)));
    }
  }

  double bytes_of(const Job& job) const {
    const Rule& rule = project_.rule(job);
    if (rule.gathers)
      return kOther.bytes * 2 + (rule.kind == "score_table" ? kRowOfTable * units_of(rule) : 0);
    const auto* known = std::ranges::find(kSizes, rule.kind, &Size::kind);
    const Size& size = known == kSizes.end() ? kOther : *known;
    const double pixels = rule.kind == "picture" ? std::pow(static_cast<double>(config_.picture.size), 2) : 0;
    const double arrays = size.bytes_per_point * points_of(job.unit) + kBytesPerPixel * pixels;
    return size.bytes + (rule.kind == "descriptors" ? packed(arrays) : arrays);
  }

 private:
  static std::optional<std::uintmax_t> size_of(const std::string& path) {
    std::error_code error;
    const std::uintmax_t bytes = std::filesystem::file_size(path, error);
    return error ? std::nullopt : std::optional(bytes);
  }

  double units_of(const Rule& rule) const { return static_cast<double>(project_.units.of(rule.over).size()); }

  double points_of(Unit unit) const {
    if (unit.level == kScans) return scan_points_;
    const std::size_t family = project_.units.family_of(unit);
    if (unit.level == kRoot || family >= file_bytes_.size()) return 0;
    return file_bytes_[family] / (unit.level == kClouds ? kCloudFileBytes : kMeshFileBytes);
  }

  const Config& config_;
  const Project& project_;
  double scan_points_;
  std::vector<double> file_bytes_;  // [family]
};

// How the artefacts of a rule that are in the cache compare with their estimate; nothing if there are few.
std::optional<double> correction(const Estimate& estimate, std::size_t rule, const Project& project,
                                 const Plan& plan, const FolderStore& store) {
  const std::vector<Decision>& decisions = plan.decisions[rule];
  const Level level = project.rules[rule].level();
  const std::size_t step = std::max<std::size_t>(1, decisions.size() / kLookedAt);
  double expected = 0, found = 0;
  std::size_t known = 0;
  for (std::size_t i = 0; i < decisions.size(); i += step) {
    if (!decisions[i].known()) continue;
    const auto bytes = store.bytes_of(decisions[i].key);
    if (!bytes) continue;  // given, and not stored
    found += static_cast<double>(*bytes) + kAround;
    expected += estimate.bytes_of({rule, {level, static_cast<std::uint32_t>(i)}});
    ++known;
  }
  return known >= kEnough && expected > 0 ? std::optional(found / expected) : std::nullopt;
}

// A segment for each stratum of a family with work, and for each value that is gathered; more where there is
// much of them. And their folders.
std::uint64_t files_needed(const Project& project, const Plan& plan, std::uint64_t bytes) {
  constexpr std::uint64_t kBytesOfSegment = 8U << 20U;
  std::vector<bool> has_work(project.units.families().size(), false);
  std::uint64_t segments = bytes / kBytesOfSegment;
  for (const Job& job : project.jobs()) {
    if (!plan[job].open()) continue;
    if (job.unit.level == kRoot)
      ++segments;
    else
      has_work[project.units.family_of(job.unit)] = true;
  }
  segments += 2 * static_cast<std::uint64_t>(std::ranges::count(has_work, true));
  return segments + std::min<std::uint64_t>(segments, segment_folders().size());
}

}  // namespace

double points_of_scan(const ScanOptions& options) {
  // A convex body of area A has shadows of A / 4 on average (Cauchy). At the distance d sqrt(A), rays are d
  // sqrt(A) tan(step) apart.
  const double spacing = options.distance * std::tan(options.step_degrees * std::numbers::pi / 180);
  return 1 / (4 * spacing * spacing);
}

SpaceNeed space_needed(const Config& config, const Inputs& inputs, const Project& project, const Plan& plan,
                       const FolderStore& store) {
  SpaceNeed need;
  std::optional<Estimate> estimate;
  for (std::size_t rule = 0; rule < project.rules.size(); ++rule) {
    const std::size_t open = plan.open(rule);
    if (open == 0) continue;
    if (!estimate) estimate.emplace(config, inputs, project);
    const std::optional<double> corrected = correction(*estimate, rule, project, plan, store);
    for (const Unit unit : project.units_of(rule))
      if (const Job job{rule, unit}; plan[job].open())
        need.bytes += static_cast<std::uint64_t>(estimate->bytes_of(job) * corrected.value_or(1));
    need.artefacts += open;
    need.by_cache += corrected ? open : 0U;
  }
  need.files = files_needed(project, plan, need.bytes);
  return need;
}

std::string bytes_text(std::uint64_t bytes) {
  const auto value = static_cast<double>(bytes);
  return value < 1e9 ? fmt::format("{:.1f} MB", value / 1e6) : fmt::format("{:.1f} GB", value / 1e9);
}

std::string need_text(const SpaceNeed& need) {
  return fmt::format("about {} in {} files", bytes_text(need.bytes), need.files);
}

std::string shortage(const SpaceNeed& need, const FreeSpace& free) {
  if (need.bytes <= free.bytes && need.files <= free.files) return {};
  const std::string left =
      need.bytes > free.bytes ? bytes_text(free.bytes) : fmt::format("{} files", free.files);
  return fmt::format(
      "the run needs {}, and {} are free: free some space, choose another disk with {}, or take fewer "
      "shapes with {}",
      need_text(need), left, as_option("cache"), as_option("items"));
}

}  // namespace salbench
