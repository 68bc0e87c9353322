// SPDX-License-Identifier: GPL-3.0-or-later
// A data set written in the one form (io/one_form.h), which is a layout of its own: hdf5.
#pragma once

#include <atomic>
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "io/dataset.h"
#include "stages/core/progress.h"

namespace salbench {

enum class Outcome { written, unchanged, failed };
template <>
struct EnumNames<Outcome> {
  static constexpr std::array<std::string_view, 3> names{"written", "unchanged", "failed"};
};

struct ConvertedShape {
  std::string name;
  Outcome outcome = Outcome::failed;  // of its file
  std::string problem = {};  // why it, or one of its views, is not in the set: one line; empty: it is
};

struct Conversion {
  std::string layout;                  // of the source
  std::vector<ConvertedShape> shapes;  // that were selected
  std::vector<std::string> notes;      // on the source
  std::size_t removed = 0;             // files of shapes that the source no longer has
};

// Writes items/NAME.h5 for each selected shape, with all of its views, and index.csv of them and of those
// that were there before. What is there already and would be the same is left alone; what fails is taken out
// of the index. Ends early, with the index of what is done, once `stop` is set. Throws ConfigError if `to`
// holds another set, StorageError, and as find_dataset and select_items do.
Conversion convert_data(const std::filesystem::path& root, std::span<const Layout> layouts,
                        const std::string& items, const std::string& split, const std::filesystem::path& to,
                        Progress& progress, const std::atomic<bool>& stop);

}  // namespace salbench
