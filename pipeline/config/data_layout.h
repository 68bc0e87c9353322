// SPDX-License-Identifier: GPL-3.0-or-later
// Descriptions of data sets: YAML that says where the files of a set lie and how they are read. Those in
// configs/datasets are part of the program; a user's own is a file.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/dataset.h"
#include "pipeline/config/section.h"

namespace salbench {

// A file that is a part of the program, which finds it wherever it lies.
struct NamedYaml {
  std::string_view name;  // of the file, without .yaml
  std::string_view yaml;
};
std::span<const NamedYaml> descriptions();    // the files of configs/datasets, by name
std::span<const NamedYaml> configurations();  // those of configs and of configs/protocols ("protocols/3dva")

inline constexpr std::string_view kAutomaticLayout = "automatic";

// Names that a configuration may have as its layout: automatic, and those in configs/datasets.
std::vector<std::string_view> layout_names();

// True if the text may be a layout: one of the names, or a file *.yaml, which is not opened.
bool is_layout(std::string_view text);

// The layouts to try, in their order: one, or for "automatic" those that say so. Reads the file of a user's
// description. Throws ConfigError: "file:line: key what is wrong".
std::vector<Layout> layouts_of(const std::string& layout);

Layout read_layout(const Section& root, const std::string& name);

}  // namespace salbench
