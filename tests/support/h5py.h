// SPDX-License-Identifier: GPL-3.0-or-later
// HDF5 files as another program reads them.
#pragma once

#include <cstdio>
#include <filesystem>
#include <string>

#include <fmt/format.h>

namespace salbench {

// Name, type, shape, sum and unit of each numeric data set of a group, one per line; links are not followed.
// A text for each way of reading, if one range of format versions gives another.
inline std::string shown_by_h5py(const std::filesystem::path& file, const std::string& group) {
  constexpr const char* kScript = R"(
import h5py, sys
def shown(bounds):
    lines = []
    def show(name, entry):
        if isinstance(entry, h5py.Dataset) and entry.dtype.kind in "iuf":
            total, unit = entry[()].astype(float).sum(), entry.attrs["unit"].decode()
            lines.append(f"{name} {entry.dtype} {entry.shape} {total:.6g} {unit}\n")
    h5py.File(sys.argv[1], "r", libver=bounds)[sys.argv[2]].visititems(show)
    return "".join(lines)
ranges = None, ("earliest", "v108"), ("v108", "latest"), ("v110", "latest")
print(*{shown(bounds) for bounds in ranges}, end="")
)";
  std::string output;
  const std::string command =
      fmt::format("/usr/bin/python3 -c '{}' '{}' '{}'", kScript, file.string(), group);
  FILE* pipe = ::popen(command.c_str(), "r");
  for (char block[256]; std::fgets(block, sizeof block, pipe) != nullptr;) output += block;
  ::pclose(pipe);
  return output;
}

}  // namespace salbench
