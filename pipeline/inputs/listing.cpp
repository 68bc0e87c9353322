// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/inputs/listing.h"

#include <algorithm>
#include <array>
#include <string_view>

#include <fmt/format.h>

#include "io/file.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

// Folder in which `automatic` expects the shapes of a layout that the front lists.
struct Guess {
  std::string_view layout, needs, shapes;
};
constexpr std::array kGuesses = {
    Guess{"gs", "GS", "off"},
    Guess{"gs", "Saliency", "off"},
    Guess{"gs", "Saliency", "../off"},
    Guess{"gs", "GS", "Meshes"},
    Guess{"gs", "Saliency", "Meshes"},
    Guess{"gs", "Saliency", "../Meshes"},
    Guess{"princeton", "off", "off"},
    Guess{"princeton", "data/off", "data/off"},
    Guess{"princeton", "MeshsegBenchmark-1.0/data/off", "MeshsegBenchmark-1.0/data/off"}};

bool is_like(const fs::path& root, std::string_view layout) {
  if (layout == "princeton" && root.filename() == "off" && has_shapes(root)) return true;
  return std::ranges::any_of(kGuesses, [&](const Guess& guess) {
    return guess.layout == layout && is_folder(root / guess.needs) && has_shapes(root / guess.shapes);
  });
}

Dataset listed(const fs::path& root, const std::string& layout, const Front& front) {
  const std::string chosen = layout == kAutomaticLayout ? automatic_layout(root) : layout;
  if (chosen == kSchelling || chosen == kFolder || chosen == kOneForm) return native_dataset(root, chosen);
  return answering(front.list, fmt::format("the layout '{}'", chosen))(root, chosen);
}

}  // namespace

std::string automatic_layout(const fs::path& root) {
  require_folder(root);
  if (is_like(root, "gs")) return "gs";
  if (fits_layout(root, kSchelling)) return std::string(kSchelling);
  if (is_like(root, "princeton")) return "princeton";
  if (fits_layout(root, kFolder)) return std::string(kFolder);
  throw InputError(
      fmt::format("{0}: no .off, .obj or .ply meshes found, and no .ply, .pcd or .xyz point clouds; looked "
                  "in gs: off and "
                  "Meshes beside a folder GS or Saliency; schelling: {1}; princeton: {0}/off, {0}/data/off, "
                  "{0}/MeshsegBenchmark-1.0/data/off; folder: {2}",
                  root.string(), places_of(root, kSchelling), places_of(root, kFolder)));
}

Dataset find_dataset(const fs::path& root, const std::string& layout, const Front& front) try {
  return listed(data_folder(root), layout, front);
} catch (const InputError& error) {
  // Only after errors that say where shapes were looked for.
  if (!front.layouts_that_fit ||
      std::string_view(error.what()).find("; looked in ") == std::string_view::npos)
    throw;
  const std::string others = front.layouts_that_fit(data_folder(root));
  if (others.empty()) throw;
  throw InputError(error.what() + others);
}

}  // namespace salbench
