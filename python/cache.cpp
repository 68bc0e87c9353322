// SPDX-License-Identifier: GPL-3.0-or-later
// A cache folder, read-only (cache/layout.h): artefacts by item and stage, whatever their keys. Nothing is
// written, moved or quarantined, and a run may go on in the folder meanwhile.
#include <algorithm>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <pybind11/stl.h>

#include "cache/layout.h"
#include "cache/verify.h"
#include "io/file.h"
#include "io/shapes/text_scanner.h"
#include "python/arrays.h"
#include "python/computing.h"
#include "python/module.h"
#include "stages/core/errors.h"

namespace salbench::python {
namespace {

using Names = std::vector<ArtefactName>;  // of one stage, by label and key

bool is_before(const ArtefactName& a, const ArtefactName& b) {
  return std::tie(a.item, a.key, a.content) < std::tie(b.item, b.key, b.content);
}

Names list_stage(const std::filesystem::path& folder, const std::string& stage) {
  Names names;
  for (std::size_t shard = 0; shard < kShards; ++shard)
    visit_names(folder / shard_of(stage, first_key(shard)), [&](std::string_view file, bool) {
      if (auto name = parse_artefact_name(file)) names.push_back(std::move(*name));
    });
  std::ranges::sort(names, is_before);
  return names;
}

py::array shown_array(const std::shared_ptr<const Hdf5Content>& owner, const Array& array) {
  const std::vector<py::ssize_t> shape(array.shape.begin(), array.shape.end());
  return std::visit(
      [&]<class T>(const std::vector<T>& values) {
        return read_only(shown(owner, py::dtype::of<T>(), shape, values.data()));
      },
      array.values);
}

py::object text_or_bytes(const std::string& value) {
  PyObject* text =
      PyUnicode_DecodeUTF8(value.data(), static_cast<py::ssize_t>(value.size()), "surrogateescape");
  if (text == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::object>(text);
}

class Folder {
 public:
  explicit Folder(const std::string& path) : path_(path) {
    if (!is_cache(path_))
      throw py::value_error(fmt::format("{}: not a salbench cache (CACHEDIR.TAG is missing)", path));
    check_format(path_);
  }

  std::vector<std::string> stages() const {
    return computed([&] { return list_stages(path_); });
  }

  // Labels of the items of all stages, looked for now, in natural order.
  std::vector<std::string> items() {
    return computed([&] {
      std::set<std::string, decltype(&natural_less)> labels(natural_less);
      for (const std::string& stage : list_stages(path_))
        for (const ArtefactName& name : names_of(stage, true)) labels.insert(name.item);
      return std::vector<std::string>(labels.begin(), labels.end());
    });
  }

  // (stage, key, content) of the artefacts of an item in some stages; all if there are none given.
  // Names that are known already are looked up; where none fits, folders are listed again.
  std::vector<std::tuple<std::string, std::string, std::string>> find(const std::string& item,
                                                                      std::vector<std::string> stages) {
    return computed([&] {
      if (stages.empty()) stages = list_stages(path_);
      auto found = find_among(item, stages, false);
      if (found.empty()) found = find_among(item, stages, true);
      return found;
    });
  }

  // Arrays and attributes of one of those that were found. Throws InputError for a damaged file.
  py::tuple read(const std::string& item, const std::string& stage, const std::string& key,
                 const std::string& content) {
    std::filesystem::path file;
    const auto owner = computed([&] {
      const ArtefactName name = known(item, stage, key, content);
      file = path_ / shard_of(stage, name.key) / name.text();
      return read(file, stage, name);
    });
    py::dict arrays, attributes;
    for (const Array& array : owner->arrays) arrays[text_or_bytes(array.name)] = shown_array(owner, array);
    for (const auto& [name, value] : owner->attributes) {
      const py::object key_of_it = text_or_bytes(name);
      if (const auto* text = std::get_if<std::string>(&value))
        attributes[key_of_it] = text_or_bytes(*text);
      else
        attributes[key_of_it] = py::cast(value);
    }
    return py::make_tuple(arrays, attributes, py::bytes(file.native()));
  }

 private:
  static std::shared_ptr<const Hdf5Content> read(const std::filesystem::path& file, const std::string& stage,
                                                 const ArtefactName& name) {
    const auto bytes = read_bytes(file);
    if (!bytes) throw InputError(fmt::format("{}: was removed meanwhile", file.string()));
    Inspection inspection = inspect_artefact(*bytes, stage, name);
    if (!inspection.content)
      throw InputError(fmt::format("{}: {}; a run will compute it again", file.string(), inspection.fault));
    return std::make_shared<const Hdf5Content>(std::move(*inspection.content));
  }

  // Names stay where they are until the stage is listed again; callers take copies.
  Names names_of(const std::string& stage, bool again) {
    const std::lock_guard lock(mutex_);
    const auto known = names_.find(stage);
    if (known != names_.end() && !again) return known->second;
    return names_[stage] = list_stage(path_, stage);
  }

  std::vector<std::tuple<std::string, std::string, std::string>> find_among(
      const std::string& item, const std::vector<std::string>& stages, bool again) {
    std::vector<std::tuple<std::string, std::string, std::string>> found;
    const std::string label = item_label(item);
    for (const std::string& stage : stages) {
      if (again) names_of(stage, true);
      for_item(stage, label, [&](const ArtefactName& name) {
        found.emplace_back(stage, name.key.hex(), name.content.hex());
      });
    }
    return found;
  }

  template <class Visit>
  void for_item(const std::string& stage, const std::string& label, const Visit& visit) {
    const std::lock_guard lock(mutex_);
    auto known = names_.find(stage);
    if (known == names_.end()) known = names_.emplace(stage, list_stage(path_, stage)).first;
    const auto [first, last] = std::ranges::equal_range(known->second, label, {}, &ArtefactName::item);
    std::for_each(first, last, visit);
  }

  ArtefactName known(const std::string& item, const std::string& stage, const std::string& key,
                     const std::string& content) {
    std::optional<ArtefactName> found;
    for_item(stage, item_label(item), [&](const ArtefactName& name) {
      if (name.key.hex() == key && name.content.hex() == content) found = name;
    });
    if (!found) throw InputError(fmt::format("{} of {}: was removed meanwhile", stage, item));
    return *found;
  }

  std::filesystem::path path_;
  std::mutex mutex_;  // of names_; nothing of Python is asked for under it
  std::map<std::string, Names> names_;
};

}  // namespace

void bind_cache(py::module_& module) {
  module.def("item_label", &item_label);
  py::class_<Folder>(module, "CacheFolder")
      .def(py::init<const std::string&>())
      .def("stages", &Folder::stages)
      .def("items", &Folder::items)
      .def("find", &Folder::find)
      .def("read",
           py::overload_cast<const std::string&, const std::string&, const std::string&, const std::string&>(
               &Folder::read));
}

}  // namespace salbench::python
