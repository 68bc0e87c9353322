// SPDX-License-Identifier: GPL-3.0-or-later
// A request is a line of JSON and the file for the answer (docs/decisions/0023-*.md). A process answers with
// an image that this program's own reader takes, or with a file beside it that says what is wrong.
#include "pipeline/package/importer.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "io/commands/process.h"
#include "io/commands/scratch_folder.h"
#include "io/digest.h"
#include "io/file.h"
#include "pipeline/inputs/inputs.h"
#include "pipeline/package/listing.h"
#include "pipeline/package/package.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

// Ends a library that damaged bytes keep busy. The largest file that is read at all, of kMaxItemBytes, takes
// minutes as text.
constexpr std::chrono::minutes kTimeout(10);

// Paths of requests are those from where salbench was started.
std::string command_of_importer() {
  return fmt::format("cd {} && {}", shell_quoted(fs::current_path().string()), package_command({"_import"}));
}

// Whether this is what the importer read there: it says so in lines "DIGEST  PATH", below the data set.
bool has_read(const ShapeInForm& shape, const fs::path& root, const std::string& path, const Digest& digest) {
  const auto plain = [](const fs::path& place) { return fs::absolute(place).lexically_normal(); };
  const std::string line =
      fmt::format("\n{}  {}\n", digest.hex(), plain(path).lexically_relative(plain(root)).string());
  return std::ranges::any_of(shape.about, [&](const auto& about) {
    return about.first == "source_files" && ("\n" + about.second).find(line) != std::string::npos;
  });
}

const char* kind_name(bool is_cloud) { return is_cloud ? "point cloud" : "mesh"; }

}  // namespace

Importer::Importer(DataImporter of)
    : of_(std::move(of)), servers_("the importer", command_of_importer(), [](const fs::path&) {}) {}

std::string Importer::answer(const std::string& request, const std::string& about) {
  const ScratchFolder scratch;
  const fs::path out = scratch.path() / "answer", error = scratch.path() / "answer.error";
  const auto ask = [&] {
    return servers_.ask(fmt::format("{}\t{}", request, out.string()), out.string(), kTimeout);
  };
  std::string said;
  try {
    try {
      said = ask();
    } catch (const EndedFromOutside&) {  // which says nothing about the file
      said = ask();
    }
  } catch (const EndedFromOutside& end) {
    throw InputError(
        fmt::format("{}: its importer was ended from outside, twice: {}; run it again, with more memory free",
                    about, end.what()));
  } catch (const InputError& failure) {
    throw InputError(fmt::format("{}: its importer failed: {}; copy the file again, or leave the item out",
                                 about, failure.what()));
  }
  if (size_of_file(error)) throw InputError(read_file(error));
  if (!size_of_file(out))
    throw StorageError(fmt::format("{}: its importer could not answer; {}", about, said));
  return read_file(out);
}

ShapeInForm Importer::item(const Files& files) {
  const DatasetItem& item = item_of(files.source);
  const std::string bytes =
      answer(fmt::format(R"({{"do": "item", "layout": {}, "root": {}, "item": {}}})", json_text(of_.layout),
                         json_text(of_.root), item.imported->entry),
             item.mesh);
  auto shape = shape_in_form(bytes, item.mesh);
  if (!shape) throw std::runtime_error(fmt::format("the importer's form of {} cannot be read", item.name));
  if (shape->is_cloud != item.imported->known.is_cloud)
    throw std::runtime_error(
        fmt::format("the importer's form of {} is of another kind than its list says", item.name));
  for (std::size_t i = 0; i < files.data.size(); ++i)
    if (const std::string& path = item.imported->files[i].path;
        !has_read(*shape, of_.root, path, xxh128(files.data[i].text())))
      throw InputError(fmt::format("{}: changed while it was imported; run it again", path));
  return std::move(*shape);
}

// One that another program wrote is first rewritten as this one writes them.
std::optional<ShapeInForm> Importer::form_in(const Files& files, bool with_truth) {
  const DatasetItem& item = item_of(files.source);
  if (!item.is_in_form()) return {};
  constexpr std::string_view kNoView = "/";  // no view has such a name
  const std::string& path = item.mesh;
  const std::string_view view = with_truth ? std::string_view(item.view) : kNoView;
  auto shape = shape_in_form(files.data[0].text(), path, view);
  if (!shape) {
    const std::string own = answer(fmt::format(R"({{"do": "rewrite", "path": {}}})", json_text(path)), path);
    require_form_of(item.shape_name(), own, path);
    if (file_digest(read_file(path, kMaxItemBytes)) != files.data[0].digest)
      throw InputError(fmt::format("{}: changed while it was read; run it again", path));
    shape = shape_in_form(own, path, view);
    if (!shape) throw std::runtime_error(fmt::format("the importer's form of {} cannot be read", path));
  }
  if (shape->is_cloud != item.imported->known.is_cloud)
    throw InputError(
        fmt::format("{}: is a {}, and index.csv says that it is a {}: put the right file there, "
                    "or import the set again",
                    path, kind_name(shape->is_cloud), kind_name(!shape->is_cloud)));
  return shape;
}

std::vector<std::string> Importer::maps(const fs::path& file) {
  const std::string list =
      answer(fmt::format(R"({{"do": "maps", "path": {}}})", json_text(file.string())), file.string());
  return names_in_json(list);
}

// It answers with the numbers as they lie in memory.
ScalarField Importer::values_in(const std::string& request, const std::string& about) {
  const std::string bytes = answer(request, about);
  ScalarField values(bytes.size() / sizeof(double));
  if (values.size() * sizeof(double) != bytes.size())
    throw std::runtime_error(fmt::format("the importer's values of {} cannot be read", about));
  if (!values.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
  return values;
}

ScalarField Importer::map(const fs::path& file, const std::string& name) {
  return values_in(
      fmt::format(R"({{"do": "map", "path": {}, "name": {}}})", json_text(file.string()), json_text(name)),
      file.string());
}

ScalarField Importer::values(const fs::path& file) {
  return values_in(fmt::format(R"({{"do": "values", "path": {}}})", json_text(file.string())), file.string());
}

}  // namespace salbench
