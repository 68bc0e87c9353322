// SPDX-License-Identifier: GPL-3.0-or-later
// Loss of fidelity by the samples of LS and CS:  quality_large_shapes DATA [SUBDIVISIONS]
//
// DATA contains SchellingData/ with Meshes/, and RawData/ of some of them. These are subdivided, and their
// maps with the default samples are compared with those of all points: rank correlation, and difference of
// the exact AUC over the picked vertices.
#include <algorithm>
#include <charconv>
#include <ctime>
#include <exception>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "io/shapes/mesh_file.h"
#include "stages/descriptors/fpfh.h"
#include "stages/models/cs.h"
#include "stages/models/ls.h"
#include "stages/normals/normals.h"
#include "tests/stages/metrics/published.h"
#include "tests/support/correlation.h"
#include "tests/support/subdivided.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMeshes = 4;  // the largest of those with picks

struct Picked {
  std::string name;
  Mesh mesh;
  std::vector<std::int32_t> picks;  // ascending and distinct
};

std::vector<Picked> largest_with_picks(const fs::path& data) {
  std::vector<Picked> all;
  for (const int mesh : published::kMeshes) {
    const std::string name = std::to_string(mesh);
    all.push_back({name, read_mesh(data / "SchellingData/Meshes" / (name + ".off")),
                   picked_points(published::ground_truth(data, mesh))});
  }
  std::ranges::sort(
      all, [](const Picked& a, const Picked& b) { return a.mesh.vertices.size() > b.mesh.vertices.size(); });
  all.resize(kMeshes);
  return all;
}

template <class Options, class Saliency>
void compare(const std::string& model, const Picked& of, std::size_t n, Saliency&& saliency) {
  Options all_points;
  all_points.sample = std::numeric_limits<std::int32_t>::max();
  const std::clock_t start = std::clock();
  const ScalarField exact = saliency(all_points);
  const std::clock_t middle = std::clock();
  const ScalarField estimate = saliency(Options{});
  const std::clock_t end = std::clock();
  const auto seconds = [](std::clock_t ticks) { return static_cast<double>(ticks) / CLOCKS_PER_SEC; };
  fmt::print(
      "{} of mesh {}, {} points: rank correlation {:.4f}, AUC {:.4f} to {:.4f} ({:+.4f}), {:.1f} to {:.1f} s "
      "of processor time\n",
      model, of.name, n, spearman(exact, estimate), published::auc_exact(exact, of.picks),
      published::auc_exact(estimate, of.picks),
      published::auc_exact(estimate, of.picks) - published::auc_exact(exact, of.picks),
      seconds(middle - start), seconds(end - middle));
}

void compare_all(const fs::path& data, unsigned int subdivisions) {
  for (const Picked& picked : largest_with_picks(data)) {
    const Mesh fine = subdivided(picked.mesh, subdivisions);
    const Normals normals = mesh_normals(fine);
    const Descriptors descriptors = fpfh(fine.vertices, normals, FpfhOptions{});
    const std::size_t n = fine.vertices.size();
    compare<LsOptions>("LS", picked, n, [&](const LsOptions& options) {
      return ls_saliency(fine.vertices, normals, descriptors, options);
    });
    compare<CsOptions>("CS", picked, n, [&](const CsOptions& options) {
      return cs_saliency(fine.vertices, normals, options);
    });
  }
}

}  // namespace
}  // namespace salbench

int main(int argc, char** argv) {
  const std::string given = argc == 3 ? argv[2] : "2";
  unsigned int subdivisions = 0;
  const auto [end, error] = std::from_chars(given.data(), given.data() + given.size(), subdivisions);
  if (argc < 2 || argc > 3 || error != std::errc() || end != given.data() + given.size()) {
    fmt::print(stderr, "usage: quality_large_shapes DATA [SUBDIVISIONS]\n");
    return 2;
  }
  try {
    salbench::compare_all(argv[1], subdivisions);
  } catch (const std::exception& e) {
    fmt::print(stderr, "quality_large_shapes: {}\n", e.what());
    return 1;
  }
}
