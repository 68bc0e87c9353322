// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/package/listing.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "io/commands/process.h"
#include "io/commands/scratch_folder.h"
#include "io/file.h"
#include "io/shapes/text_scanner.h"
#include "pipeline/package/package.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// A folder of millions of files on a busy disk is listed in minutes.
constexpr std::chrono::hours kLongest(2);

// Where `automatic` expects the shapes of layouts that the package lists.
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

}  // namespace

std::string automatic_layout(const fs::path& root) {
  if (!is_folder(root)) throw InputError(fmt::format("{}: there is no such folder", root.string()));
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

namespace {

// The bytes of a text, each a character of its own.
std::string bytes_of(const std::string& text) {
  std::string bytes;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto c = static_cast<unsigned char>(text[i]);
    if (c == 0 || c > 0xc3) throw std::logic_error("a text is not one character per byte");
    bytes +=
        c < 0x80 ? text[i] : static_cast<char>(((c & 3U) << 6U) | (static_cast<unsigned>(text[++i]) & 0x3fU));
  }
  return bytes;
}

std::string text_at(const Json& object, const char* key) {
  return bytes_of(object.at(key).get<std::string>());
}
std::vector<std::string> texts_at(const Json& object, const char* key) {
  std::vector<std::string> texts;
  for (const Json& text : object.at(key)) texts.push_back(bytes_of(text.get<std::string>()));
  return texts;
}

void read_native(const Json& native, DatasetItem& item) {
  item.mesh = text_at(native, "mesh");
  item.picks = texts_at(native, "picks");
  const std::vector<std::string> saliency = texts_at(native, "saliency");
  if (saliency.size() > 1) throw std::logic_error("an item without importer has several files of saliency");
  if (!saliency.empty()) item.saliency = saliency[0];
}

void read_imported(const Json& row, DatasetItem& item) {
  ImportedItem imported{.known = {.is_cloud = row.at("kind").get<std::string>() == "cloud",
                                  .has_truth = row.at("truth").get<bool>(),
                                  .participants = row.at("participants").get<std::size_t>(),
                                  .viewers = row.at("viewers").get<std::size_t>(),
                                  .recorded = row.at("recorded").get<std::size_t>()},
                        .files = {},
                        .entry = row.dump()};
  for (const Json& file : row.at("files"))
    imported.files.push_back({text_at(file, "name"), text_at(file, "path"), text_at(file, "title")});
  if (imported.files.empty()) throw std::logic_error("an item has no files");
  item.mesh = imported.files[0].path;
  item.imported = std::make_shared<const ImportedItem>(std::move(imported));
}

DatasetItem item_from(const Json& row) {
  DatasetItem item{.name = text_at(row, "name"), .category = text_at(row, "category"), .mesh = {}};
  if (item.name.empty() || item.name.find('/') != std::string::npos)
    throw std::logic_error(fmt::format("'{}' cannot be the name of an item", item.name));
  item.view = text_at(row, "view");
  if (!item.view.empty()) item.shape = text_at(row, "shape");
  item.split = text_at(row, "split");
  item.problem = text_at(row, "problem");
  row.contains("native") ? read_native(row.at("native"), item) : read_imported(row, item);
  return item;
}

// What the package prints. Its messages are for the user.
std::string list_printed_by_package(const fs::path& root, const std::string& layout) {
  if (const std::string wrong = wrong_with_interpreter(); !wrong.empty())
    throw ConfigError(fmt::format("the layout '{}' needs Python: {}", layout, wrong));
  const ScratchFolder scratch;
  const fs::path out = scratch.path() / "list", errors = scratch.path() / "errors";
  const CommandEnd end =
      try_command(fmt::format("{} > {} 2> {}", package_command({"_list", layout, "--data", root.string()}),
                              shell_quoted(out.string()), shell_quoted(errors.string())),
                  fs::current_path(), kLongest);
  if (end.status == 0) return read_file(out);
  constexpr int kUnusable = 2, kUnusableStorage = 3;
  constexpr std::string_view kError = "error: ";
  std::string said = read_file(errors);
  if (const std::string none = no_interpreter(end.status); !none.empty())
    throw ConfigError(fmt::format("the layout '{}' needs Python: {}", layout, none));
  if (said.starts_with(kError)) said.erase(0, kError.size());
  while (said.ends_with('\n')) said.pop_back();
  if (end.status == kNoPackage)
    throw ConfigError(fmt::format("the layout '{}' needs Python: {}", layout, said));
  if (end.status == kUnusable) throw InputError(said);
  if (end.status == kUnusableStorage) throw StorageError(said);
  throw std::runtime_error(fmt::format("the list of the data set's items failed: {}; {}", end.reason, said));
}

}  // namespace

std::string layouts_that_fit(const fs::path& root, std::string_view error) {
  if (error.find("; looked in ") == error.npos || !wrong_with_interpreter().empty()) return {};
  const ScratchFolder scratch;
  const fs::path out = scratch.path() / "layouts";
  const std::string asked = package_command({"_layouts", data_folder(root).string()});
  const CommandEnd end = try_command(fmt::format("{} > {} 2> /dev/null", asked, shell_quoted(out.string())),
                                     fs::current_path(), kLongest);
  return end.status == 0 ? read_file(out) : "";
}

std::string json_text(const std::string& bytes) {
  std::string text;
  for (const char byte : bytes) {
    const auto c = static_cast<unsigned char>(byte);
    if (c >= 0x80) text += static_cast<char>(0xc0U | (c >> 6U));
    text += static_cast<char>(c < 0x80 ? c : 0x80U | (c & 0x3fU));
  }
  return Json(text).dump();
}

std::vector<std::string> names_in_json(std::string_view list) {
  std::vector<std::string> names;
  for (const Json& name : Json::parse(list)) names.push_back(bytes_of(name.get<std::string>()));
  return names;
}

Dataset listed_dataset(std::string_view document) try {
  const Json json = Json::parse(document);
  Dataset dataset{.layout = text_at(json, "layout"),
                  .items = {},
                  .notes = texts_at(json, "notes"),
                  .splits_where = text_at(json, "splits_where"),
                  .no_splits = text_at(json, "no_splits"),
                  .remark = text_at(json, "remark")};
  for (const Json& entry : json.at("unknown"))
    dataset.unknown.push_back({text_at(entry, "split"), text_at(entry, "name"), text_at(entry, "where")});
  for (const Json& row : json.at("items")) dataset.items.push_back(item_from(row));
  if (dataset.items.empty()) throw std::logic_error("there are no items");
  const auto is_imported = [](const DatasetItem& item) { return item.imported != nullptr; };
  if (std::ranges::any_of(dataset.items, is_imported)) {
    if (!std::ranges::all_of(dataset.items, is_imported))
      throw std::logic_error("some items have an importer, and others have none");
    dataset.importer.version = json.at("version").get<std::int32_t>();
    if (dataset.importer.version < 1) throw std::logic_error("the version of the importer is none");
  }
  return dataset;
} catch (const Json::exception& error) {
  throw std::logic_error(fmt::format("the package's list of items is not as agreed: {}", error.what()));
} catch (const std::logic_error& error) {
  throw std::logic_error(fmt::format("the package's list of items is not as agreed: {}", error.what()));
}

Dataset find_dataset(const fs::path& root, const std::string& layout) {
  const fs::path folder = data_folder(root);
  const std::string chosen = layout == kAutomaticLayout ? automatic_layout(folder) : layout;
  if (chosen == kSchelling || chosen == kFolder || chosen == kOneForm) return native_dataset(folder, chosen);
  Dataset dataset = listed_dataset(list_printed_by_package(folder, chosen));
  dataset.importer.layout = chosen;
  dataset.importer.root = folder;
  return dataset;
}

}  // namespace salbench
