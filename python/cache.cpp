// SPDX-License-Identifier: GPL-3.0-or-later
// Read-only access to a cache folder: artefacts by item and stage, regardless of keys. Nothing is written or
// renamed; a run may use the folder at the same time.
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <iterator>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <system_error>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <pybind11/stl.h>

#include "cache/layout.h"
#include "cache/recipes.h"
#include "cache/segment.h"
#include "io/shapes/text_scanner.h"
#include "python/arrays.h"
#include "python/computing.h"
#include "python/module.h"
#include "stages/core/errors.h"

namespace salbench::python {
namespace {

using Known = std::vector<KnownArtefact>;  // sorted by label, stage and key

bool is_before(const KnownArtefact& a, const KnownArtefact& b) {
  return std::tie(a.label, a.stage, a.key, a.content) < std::tie(b.label, b.stage, b.key, b.content);
}

// Content of an artefact; lives as long as any of its arrays.
struct Shown {
  Arrays arrays;
  Attributes attributes;
};

// Invalid UTF-8 becomes surrogates, as in file names.
py::object text_with_surrogates(const std::string& value) {
  PyObject* text =
      PyUnicode_DecodeUTF8(value.data(), static_cast<py::ssize_t>(value.size()), "surrogateescape");
  if (text == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::object>(text);
}

std::shared_ptr<const Shown> shown_of(const KnownArtefact& known) try {
  const std::optional<Artefact> artefact = read_artefact(known);
  if (!artefact) throw InputError("was removed meanwhile");
  return std::make_shared<const Shown>(Shown{arrays_of(*artefact), attributes_of(*artefact)});
} catch (const InputError& error) {
  throw InputError(fmt::format("{}: {} of {}: {}; a run will compute it again", known.file.string(),
                               known.stage, known.label, error.what()));
}

// Arrays and attributes of an artefact, and its file. Throws InputError if it is damaged.
py::tuple read(const KnownArtefact& known) {
  const auto owner = computed([&] { return shown_of(known); });
  py::dict arrays, attributes;
  for (const Array& array : owner->arrays)
    arrays[text_with_surrogates(array.name)] = read_only(shown(owner, array));
  for (const auto& [name, value] : owner->attributes) {
    const py::object key_of_it = text_with_surrogates(name);
    if (const auto* text = std::get_if<std::string>(&value))
      attributes[key_of_it] = text_with_surrogates(*text);
    else
      attributes[key_of_it] = py::cast(value);
  }
  return py::make_tuple(arrays, attributes, py::bytes(known.file.native()));
}

// Time at which its file was written, in seconds since 1970; 0 if it is gone.
double stored_at(const KnownArtefact& known) {
  std::error_code gone;
  const auto time = std::filesystem::last_write_time(known.file, gone);
  if (gone) return 0;
  return std::chrono::duration<double>(std::chrono::file_clock::to_sys(time).time_since_epoch()).count();
}

class Folder {
 public:
  explicit Folder(const std::string& path) : path_(path) {
    if (!is_cache(path_))
      throw py::value_error(fmt::format("{}: not a salbench cache (CACHEDIR.TAG is missing)", path));
    check_format(path_);
  }

  std::vector<std::string> stages() {
    return computed([&] {
      std::set<std::string> stages;
      for (const KnownArtefact& artefact : *known()) stages.insert(artefact.stage);
      return std::vector<std::string>(stages.begin(), stages.end());
    });
  }

  // Labels of all items in the cache, re-listed if needed, in natural order.
  std::vector<std::string> items() {
    return computed([&] {
      std::set<std::string, decltype(&natural_less)> labels(natural_less);
      for (const KnownArtefact& artefact : *known()) labels.insert(artefact.label);
      return std::vector<std::string>(labels.begin(), labels.end());
    });
  }

  // Artefacts of an item in the given stages; all stages if empty.
  Known find(const std::string& item, const std::vector<std::string>& stages) {
    return computed([&] {
      const std::shared_ptr<const Known> all = known();
      Known found;
      for (const KnownArtefact& artefact :
           std::ranges::equal_range(*all, item_label(item), {}, &KnownArtefact::label))
        if (stages.empty() || std::ranges::count(stages, artefact.stage) > 0) found.push_back(artefact);
      return found;
    });
  }

 private:
  using Times = std::vector<std::filesystem::file_time_type>;

  // Modification times of the segment folders; nullopt if so recent that another change could have the same
  // time.
  std::optional<Times> times() const {
    Times times;
    for (const std::filesystem::path& below : segment_folders()) {
      std::error_code missing;
      times.push_back(std::filesystem::last_write_time(path_ / below, missing));
    }
    constexpr std::chrono::seconds kRecent(2);
    const bool is_old = std::ranges::max(times) + kRecent < std::filesystem::file_time_type::clock::now();
    return is_old ? std::optional(std::move(times)) : std::nullopt;
  }

  // Current content of the folder, listed again if it changed. Reads the heads of new files; of all files if
  // one is gone.
  std::shared_ptr<const Known> known() {
    const std::lock_guard lock(mutex_);
    std::optional<Times> times = this->times();
    if (known_ != nullptr && times && times == times_) return known_;
    times_.reset();
    std::set<std::filesystem::path> files;
    for (std::filesystem::path& file : list_segments(path_)) files.insert(std::move(file));
    if (known_ == nullptr || !std::ranges::includes(files, files_)) {
      files_.clear();
      known_ = std::make_shared<const Known>();
    }
    Known all;
    for (const std::filesystem::path& file : files)
      if (!files_.contains(file)) std::ranges::move(artefacts_in(file), std::back_inserter(all));
    if (!all.empty()) {
      std::ranges::copy(*known_, std::back_inserter(all));
      known_ = std::make_shared<const Known>(without_repetitions(std::move(all)));
    }
    files_ = std::move(files);
    times_ = std::move(times);
    return known_;
  }

  // Keeps one artefact per key.
  static Known without_repetitions(Known known) {
    std::ranges::sort(known, is_before);
    const auto repeated = std::ranges::unique(known, [](const KnownArtefact& a, const KnownArtefact& b) {
      return !is_before(a, b) && !is_before(b, a);
    });
    known.erase(repeated.begin(), repeated.end());
    return known;
  }

  std::filesystem::path path_;
  std::mutex mutex_;            // guards the members below; no call to Python while it is held
  std::optional<Times> times_;  // for the listing below; nullopt: list again
  std::set<std::filesystem::path> files_;
  std::shared_ptr<const Known> known_;
};

}  // namespace

void bind_cache(py::module_& module) {
  module.def("item_label", &item_label);
  py::class_<Folder>(module, "CacheFolder")
      .def(py::init<const std::string&>())
      .def("stages", &Folder::stages)
      .def("items", &Folder::items)
      .def("find", &Folder::find);
  py::class_<KnownArtefact>(module, "KnownArtefact")
      .def_readonly("stage", &KnownArtefact::stage)
      .def_property_readonly("stored", &stored_at)
      .def_property_readonly("content", [](const KnownArtefact& known) { return known.content.hex(); })
      .def("read", &read);
}

}  // namespace salbench::python
