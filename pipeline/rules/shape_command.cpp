// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/rules/shape_command.h"

#include <algorithm>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "io/commands/process.h"
#include "io/commands/scratch_folder.h"
#include "io/file.h"
#include "io/hdf5/hdf5_file.h"
#include "io/shapes/shape_file.h"
#include "io/shapes/values_file.h"
#include "pipeline/package/package.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

constexpr const char* kListFile = "/dev/stdin";
constexpr int kMostLate = 3;  // shapes that are waited for, one timeout each, without any answer before

Array rows_of(const char* name, std::span<const Vec3> rows, const char* description) {
  std::vector<double> values;
  values.reserve(3 * rows.size());
  for (const Vec3& row : rows) values.insert(values.end(), {row.x(), row.y(), row.z()});
  return {name, {rows.size(), 3}, std::move(values), "1", description};
}

void write_mesh(const fs::path& path, const ShapeParts& shape) {
  write_file(path, ply_of({.points = shape.points,
                           .normals = shape.normals == nullptr ? Points() : Points(*shape.normals),
                           .faces = shape.faces}));
}

void write_hdf5(const fs::path& path, const ShapeParts& shape) {
  Hdf5Content content{{rows_of("points", shape.points, "coordinates, in the mesh's unit")}, {}};
  if (shape.normals != nullptr) content.arrays.push_back(rows_of("normals", *shape.normals, "unit normals"));
  if (!shape.faces.empty()) {
    std::vector<std::int32_t> corners;
    for (const Triangle& face : shape.faces) corners.insert(corners.end(), face.begin(), face.end());
    content.arrays.push_back(
        {"faces", {shape.faces.size(), 3}, std::move(corners), "1", "0-based points of each triangle"});
  }
  if (shape.fpfh != nullptr)
    content.arrays.push_back(
        {"fpfh", {shape.fpfh->size(), kFpfhBins}, shape.fpfh->values, "1", "descriptors"});
  const Bytes image = hdf5_image(content);
  write_file(path, {reinterpret_cast<const char*>(image.data()), image.size()});
}

void replace_all(std::string& text, std::string_view what, const std::string& by) {
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size())
    text.replace(at, what.size(), by);
}

// Also under the name that numpy.save makes of one without ".npy". Throws InputError.
fs::path written_file(const fs::path& folder, const std::string& end) {
  for (const char* name : {"out.val", "out.npy", "out.h5", "out.val.npy"}) {
    std::error_code missing;
    if (fs::exists(folder / name, missing)) return folder / name;
  }
  throw InputError(
      fmt::format("the command {} without a file {{out}}; it must write one value per point there", end));
}

std::string file_of(std::string_view placeholder) {
  const auto* const row =
      std::ranges::find_if(kPlaceholders, [&](const Placeholder& each) { return each.text == placeholder; });
  return std::string(row->file);
}

}  // namespace

ShapeCommand::ShapeCommand(const std::string& name, std::string command,
                           std::chrono::duration<double> timeout, std::shared_ptr<DependedFiles> depends)
    : command_(std::move(command)), timeout_(timeout), depends_(std::move(depends)) {
  prepare_commands();
  if (!has(kListOfMeshes) && !has(kListOfShapes)) return;
  std::string line = command_;
  for (const std::string_view list : {kListOfMeshes, kListOfShapes}) replace_all(line, list, kListFile);
  servers_.emplace("models." + name, std::move(line),
                   [files = depends_](const fs::path& folder) { files->put_into(folder); });
}

ScalarField ShapeCommand::map(const ShapeParts& shape, std::size_t mapped_faces) {
  const ScratchFolder scratch;
  const fs::path& folder = scratch.path();
  if (has("{mesh}") || has(kListOfMeshes)) write_mesh(folder / file_of("{mesh}"), shape);
  if (has("{shape}") || has(kListOfShapes)) write_hdf5(folder / file_of("{shape}"), shape);
  const std::string end = [&] {
    try {
      return servers_ ? ask(folder) : run(folder, shape);
    } catch (const InputError& error) {
      const std::string left_out = depends_->left_out_of(error.what());
      throw InputError(without_scratch_folders(error.what()) +
                       (left_out.empty() ? who_has_module(error.what()) : left_out));
    }
  }();
  depends_->check_unchanged();
  const fs::path written = written_file(folder, end);
  return read_point_values(
      written, "the command's " + written.filename().string(), shape.points.size(),
      [&](const fs::path& file) { return importer_.values(file); }, mapped_faces);
}

// Returns what the command did, for a message.
std::string ShapeCommand::run(const fs::path& folder, const ShapeParts& shape) {
  depends_->put_into(folder);
  std::string command = command_;
  for (const Placeholder& placeholder : kPlaceholders)
    replace_all(command, placeholder.text, shell_quoted((folder / placeholder.file).string()));
  replace_all(command, kSource, shell_quoted(shape.source));
  replace_all(command, kItem, shell_quoted(shape.item));
  run_command(command, folder, timeout_);
  return "ended";
}

// Likewise.
std::string ShapeCommand::ask(const fs::path& folder) {
  const std::string shape = (folder / file_of(has(kListOfMeshes) ? "{mesh}" : "{shape}")).string();
  const std::string out = (folder / file_of("{out}")).string();
  if (shape.find_first_of("\t\r\n") != std::string::npos)
    throw StorageError(fmt::format(
        "{}: a tab or a line end in a path cannot be part of {{list}}; set TMPDIR to another", shape));
  constexpr const char* kAdvice =
      "does it print the second file of each line, as a line, and flush its standard output after it?";
  if (late_ >= kMostLate)
    throw InputError(
        fmt::format("the command was not asked any more: it has answered none of {} shapes within its "
                    "timeout of {} s; {}",
                    late_.load(), timeout_.count(), kAdvice));
  try {
    const std::string said = servers_->ask(shape + "\t" + out, out, timeout_);
    has_answered_ = true;
    return fmt::format("answered ({})", said);
  } catch (const TookTooLong& error) {
    if (has_answered_) throw;
    ++late_;
    throw InputError(fmt::format("{}; {}", error.what(), kAdvice));
  }
}

}  // namespace salbench
