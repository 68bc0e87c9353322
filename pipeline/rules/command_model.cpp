// SPDX-License-Identifier: GPL-3.0-or-later
// The key of a map contains the command line, its version, its inputs and the digests of the files it depends
// on, but not the timeout and the limits, which change no value. The front runs the command
// (python/salbench/models/command.py).
#include "pipeline/rules/command_model.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <memory>
#include <sstream>
#include <utility>

#include <fmt/format.h>

#include "io/file.h"
#include "pipeline/rules/function_model.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 5> kReadable = {"mesh", "points", "normals", "faces", "fpfh"};

// A placeholder in a command line, and the file of the shape that replaces it.
struct Placeholder {
  std::string_view text, file;
};
constexpr std::array<Placeholder, 5> kPlaceholders = {{{"{mesh}", "shape.ply"},
                                                       {"{shape}", "shape.h5"},
                                                       {"{out}", "out.val"},
                                                       {"{out.npy}", "out.npy"},
                                                       {"{out.h5}", "out.h5"}}};
// Path of the shape's original file, next to its textures; and the shape's name.
constexpr std::string_view kSource = "{source}", kItem = "{item}";
constexpr std::string_view kListOfMeshes = "{list}", kListOfShapes = "{list.h5}";

bool has(std::string_view text, std::string_view part) { return text.find(part) != std::string_view::npos; }
bool has_placeholder(std::string_view line) {
  return std::ranges::any_of(kPlaceholders, [&](const Placeholder& part) { return has(line, part.text); });
}
bool is_told_of_source(const CommandOptions& options) {
  return has(options.command, kSource) || has(options.command, kItem);
}
bool contains(const Words& words, std::string_view word) {
  return std::ranges::find(words, word) != words.end();
}

// True if a name refers to this file in any spelling: "./a.py" is "a.py".
bool names_file(const Words& names, const std::string& name) {
  const fs::path plain = fs::path(name).lexically_normal();
  return std::ranges::any_of(
      names, [&](const std::string& one) { return fs::path(one).lexically_normal() == plain; });
}

// Relative to the configuration's folder if it is there, else to the working directory, as `data` is.
fs::path place_of_depended(const std::string& name, const Section& written) {
  std::error_code missing;
  const fs::path beside = fs::path(written.folder()) / name;
  return fs::absolute(fs::exists(beside, missing) ? beside : fs::path(name));
}

// Reads the files that a command depends on. Duplicates count once. Throws ConfigError that names an
// unreadable file.
std::vector<DependedFile> read_depended(const Words& names, const Section& written) {
  std::vector<DependedFile> files;
  Words taken;
  for (const std::string& name : names) {
    if (names_file(taken, name)) continue;
    taken.push_back(name);
    const fs::path path = place_of_depended(name, written);
    try {
      files.push_back({name, path, file_digest(read_file(path))});
    } catch (const InputError& error) {
      written.fail("depends", fmt::format("names a file that the command needs: {}", error.what()));
    }
  }
  return files;
}

void check_reads(const CommandOptions& options, const Section& written) {
  for (const std::string& word : options.reads)
    if (std::ranges::find(kReadable, word) == kReadable.end())
      written.fail("reads", fmt::format("names '{}', expected some of {}", word, fmt::join(kReadable, ", ")));
  if (options.reads.empty()) written.fail("reads", "names nothing; leave the key out for [mesh]");
}

void check_command(const CommandOptions& options, const Section& written) {
  const std::string& line = options.command;
  const bool list = has(line, kListOfMeshes), list_of_hdf5 = has(line, kListOfShapes);
  const bool fpfh = contains(options.reads, "fpfh");
  if (list || list_of_hdf5) {
    if (has_placeholder(line) || is_told_of_source(options))
      written.fail("command",
                   "has {list}, whose lines name the files of each shape: it must not have {mesh}, {shape}, "
                   "{out}, {source} or {item} as well");
    if (list && (list_of_hdf5 || fpfh))
      written.fail("command",
                   fpfh ? "must have {list.h5}, with HDF5 files, in place of {list}, since it reads "
                          "fpfh, which a PLY file has no place for"
                        : "has both {list} and {list.h5}");
    return;
  }
  if (!has(line, "{out}") && !has(line, "{out.npy}") && !has(line, "{out.h5}"))
    written.fail("command", "must have {out} where the file is named that it writes its values to");
  if (!has(line, "{mesh}") && !has(line, "{shape}") && !has(line, kSource))
    written.fail("command",
                 "must have {mesh}, {shape} or {source}, the file it reads, or {list} for many shapes");
  if (fpfh && !has(line, "{shape}"))
    written.fail("command",
                 "must have {shape}, an HDF5 file, since it reads fpfh, which a PLY file has no place for");
}

// Compiled programs such as interpreters, in contrast to the scripts and weights that they are given.
bool is_compiled(const fs::path& path) {
  std::array<char, 4> start = {};
  std::ifstream(path, std::ios::binary).read(start.data(), start.size());
  return start == std::array{'\x7f', 'E', 'L', 'F'};
}

// Rejects files that the command reads but that would be missing from its scratch folder or from its key.
void check_depends(const CommandOptions& options, const Section& written) {
  for (const std::string& file : options.depends) {
    const fs::path path(file);
    if (path.filename().empty() || std::ranges::find(path, "..") != path.end())
      written.fail("depends", fmt::format("names '{}', expected a file below the configuration's folder or "
                                          "the present one, or its whole path",
                                          file));
    for (const Placeholder& taken : kPlaceholders)
      if (names_file({std::string(taken.file), "out.val.npy"}, file))
        written.fail("depends", fmt::format("names '{}', which salbench writes itself", file));
  }
  std::istringstream words(options.command);
  bool is_written = false;
  for (std::string word; words >> word; is_written = word.ends_with('>')) {
    const fs::path path(word);
    std::error_code ignored;
    if (is_written || names_file(options.depends, word) ||
        !fs::is_regular_file(place_of_depended(word, written), ignored))
      continue;
    if (path.is_relative())
      written.fail("command",
                   fmt::format("names the file '{0}', which is not in the folder where the command runs: add "
                               "depends: [{0}]",
                               word));
    if (!is_compiled(path))
      written.fail("command", fmt::format("names the file '{0}', whose changes would not be noticed: add "
                                          "depends: [{0}]",
                                          word));
  }
}

CommandOptions read_options(const Section& written) {
  CommandOptions options;
  written.read(options);
  SectionErrors errors;
  errors.gather([&] { check_reads(options, written); });
  errors.gather([&] { check_command(options, written); });
  errors.gather([&] { check_depends(options, written); });
  errors.throw_any();
  return options;
}

Output<ScalarField> add_command(RuleTable& table, const ShapeOutputs& shape, const std::string& name,
                                const CommandOptions& options, const std::vector<DependedFile>& depends) {
  RuleHead head = stage_of(name, Role::map, options.version);
  head.limit = static_cast<std::size_t>(options.at_once > 0 ? options.at_once : options.gpu);
  std::string in_key =
      fmt::format("command: {}\nreads: {}\n", yaml_quoted(options.command), option_text(options.reads, true));
  for (const DependedFile& file : depends)
    in_key += fmt::format("{}{}: {}\n", kDependsOption, file.name, file.digest.hex());
  Words reads = options.reads;
  if (contains(reads, "mesh")) reads.insert(reads.end(), {"normals", "faces"});
  return add_own_map(table, shape,
                     {.head = head,
                      .reads = reads,
                      .options = {"models." + name, options_text(options, false, true), in_key},
                      .told = shape.originals ? shape.names : KeyText(),
                      .call = shape.command});
}

}  // namespace

void reject_misspelt_command(const std::string& name, const Section& models) {
  const auto is_command_line = [](const std::string& text) {
    return has(text, kListOfMeshes) || has(text, kListOfShapes) || has_placeholder(text);
  };
  if (!models.has_mapping(name)) return;
  const Section model = models.child(name);
  for (const std::string& key : model.keys())
    if (!model.has_mapping(key) && std::ranges::any_of(model.words(key), is_command_line))
      model.fail(key, "is not a known key; " + did_you_mean(key, {"command"}, "a command line is 'command'"));
}

Model command_model(const std::string& name, const Section& models) {
  if (const std::string wrong = wrong_with_model_name(name); !wrong.empty()) models.fail(name, wrong);
  const Section written = models.child(name);
  const CommandOptions options = read_options(written);
  // Read on first use: a configuration may be parsed where the files do not exist.
  const auto read = std::make_shared<std::vector<DependedFile>>();
  const auto depends = [=]() -> const std::vector<DependedFile>& {
    if (read->empty()) *read = read_depended(options.depends, written);
    return *read;
  };
  return {.name = name,
          .version = options.version,
          .options = options_text(options, false, true),
          .annotated_options = options_text(options, true, true),
          .add_map =
              [=](RuleTable& table, const ShapeOutputs& shape) {
                return add_command(table, shape, name, options, depends());
              },
          .command =
              [=](const Front& front) {
                return answering(front.command, fmt::format("models.{}: a command", name))(
                    {name, options.command, options.timeout, depends()});
              },
          .trained_on = options.trained_on,
          .trained = options.trained,
          .reads_originals = is_told_of_source(options)};
}

}  // namespace salbench
