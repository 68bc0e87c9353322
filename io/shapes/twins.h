// SPDX-License-Identifier: GPL-3.0-or-later
// Several shape files of one name, such as a.off and a.ply: which of them is the item.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "stages/core/options.h"

namespace salbench {

enum class Twins { refuse, off, obj, ply, pcd, xyz };
template <>
struct EnumNames<Twins> {
  static constexpr std::array<std::string_view, 6> names = {"refuse", "off", "obj", "ply", "pcd", "xyz"};
};

struct NamedFile {
  std::string name;  // of the item
  std::filesystem::path path;
};

// One file per name, in the order of the first of each name. Of several, the one with the extension `kept`;
// a note tells how many were left out. Throws InputError, which names all that are still twins, if the
// extension does not tell them apart.
std::vector<NamedFile> without_twins(const std::vector<NamedFile>& files, Twins kept,
                                     std::vector<std::string>& notes);

}  // namespace salbench
