// SPDX-License-Identifier: GPL-3.0-or-later
// How often Hoppe's orientation is right:  quality_orientation DATA_DIR
//
// DATA_DIR holds N.off, closed meshes with outward faces; twenty of them, evenly spread, are taken.
//   meshes: the vertices as a point set; share whose normal agrees in sign with the area-weighted face
//   normal. scans:  the twelve scans of each; share of points whose normal faces the camera that saw them.
#include <algorithm>
#include <charconv>
#include <exception>
#include <filesystem>
#include <map>
#include <numeric>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "io/mesh_file.h"
#include "stages/normals/normals.h"
#include "stages/scan/scan.h"

namespace salbench {
namespace {

constexpr std::size_t kMeshes = 20;

// By number, so that the classes, which come in runs of numbers, are all there.
std::vector<std::filesystem::path> evenly_spread_meshes(const std::filesystem::path& folder) {
  std::map<int, std::filesystem::path> by_number;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string stem = entry.path().stem().string();
    int number = 0;
    const auto [end, error] = std::from_chars(stem.data(), stem.data() + stem.size(), number);
    if (entry.path().extension() == ".off" && error == std::errc() && end == stem.data() + stem.size())
      by_number.emplace(number, entry.path());
  }
  std::vector<std::filesystem::path> all, chosen;
  for (const auto& [number, path] : by_number) all.push_back(path);
  const std::size_t count = std::min(kMeshes, all.size());
  for (std::size_t k = 0; k < count; ++k) chosen.push_back(all[(2 * k + 1) * all.size() / (2 * count)]);
  return chosen;
}

template <class Agrees>
double share(std::size_t n, Agrees&& agrees) {
  std::size_t good = 0;
  for (std::size_t i = 0; i < n; ++i) good += agrees(i) ? 1 : 0;
  return static_cast<double>(good) / static_cast<double>(n);
}

double share_outward(const Mesh& mesh) {
  MeshNormalsOptions pca;
  pca.method = MeshNormalsMethod::pca;
  const Normals outward = mesh_normals(mesh), normals = mesh_normals(mesh, pca);
  return share(normals.size(), [&](std::size_t i) { return normals[i].dot(outward[i]) > 0; });
}

double share_facing(const Scan& scan) {
  const Normals normals = scan_normals(scan, ScanNormalsOptions::text());  // by Hoppe's tree
  return share(normals.size(),
               [&](std::size_t i) { return normals[i].dot(scan.camera - scan.points[i]) > 0; });
}

void print_summary(std::string_view what, std::vector<double> shares) {
  std::sort(shares.begin(), shares.end());
  const std::size_t n = shares.size();
  const double median = (shares[(n - 1) / 2] + shares[n / 2]) / 2;
  const double mean = std::accumulate(shares.begin(), shares.end(), 0.0) / static_cast<double>(n);
  fmt::print("{}: n {}  median {:.4f}  min {:.4f}  mean {:.4f}\n", what, n, median, shares.front(), mean);
}

int run(const std::filesystem::path& folder) {
  std::vector<double> outward, facing;
  for (const auto& path : evenly_spread_meshes(folder)) {
    const Mesh mesh = read_mesh(path);
    outward.push_back(share_outward(mesh));
    const ScanScene scene(mesh);
    double lowest = 1;
    for (int view = 0; view < kViews; ++view) {
      facing.push_back(share_facing(scene.scan(view)));
      lowest = std::min(lowest, facing.back());
    }
    fmt::print("{:>10}  outward {:.4f}  lowest scan {:.4f}\n", path.filename().string(), outward.back(),
               lowest);
  }
  if (outward.empty()) {
    fmt::print(stderr, "{}: no N.off here\n", folder.string());
    return 1;
  }
  print_summary("meshes, share outward", outward);
  print_summary("scans, share facing the camera", facing);
  return 0;
}

}  // namespace
}  // namespace salbench

int main(int argc, char** argv) {
  if (argc != 2) {
    fmt::print(stderr, "usage: quality_orientation DATA_DIR\n");
    return 2;
  }
  try {
    return salbench::run(argv[1]);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}
