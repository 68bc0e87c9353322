// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/hdf5/hdf5_file.h"

#include <algorithm>
#include <new>

#include <fmt/format.h>

#include "io/hdf5/hdf5_driver.h"
#include "io/hdf5/hdf5_library.h"
#include "io/shapes/text_scanner.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

using namespace hdf5;

constexpr std::string_view kSignature = "\x89HDF\r\n\x1a\n";

}  // namespace

bool is_hdf5(const std::filesystem::path& file) { return read_head(file, kSignature.size()) == kSignature; }

PlacedImage hdf5_image(const std::vector<NamedArray>& arrays, const Attributes& attributes) {
  constexpr unsigned kTreeK = 4, kLinksK = 2;  // half of the defaults: groups with few links become small
  constexpr std::uint64_t kAround = 1000;      // bytes of an array's header and links
  PlacedImage placed;
  Memory memory;
  std::uint64_t expected = kAround;
  for (const NamedArray& named : arrays) expected += bytes_of(named.array) + kAround;
  memory.bytes.reserve(expected);
  {
    const auto lock = library();
    const Handle creation = file_creation();
    must(H5Pset_sym_k(creation, kTreeK, kLinksK), "H5Pset_sym_k");
    Handle file = created_on(memory, creation);
    const Handle links = groups_between();
    for (const auto& [name, value] : attributes) write_attribute(file, name, value);
    for (const NamedArray& named : arrays) placed.pieces.push_back(write_array(file, links, named));
    must(file.close(), "H5Fclose");
  }
  if (memory.error() != 0) throw std::bad_alloc();
  placed.bytes = std::move(memory.bytes);
  return placed;
}

Bytes hdf5_image(const Hdf5Content& content) {
  std::vector<PackedArray> arrays;
  for (const Array& array : content.arrays) arrays.push_back(pack(array));
  std::vector<NamedArray> named;
  for (const PackedArray& array : arrays) named.push_back({array.name, array});
  return hdf5_image(named, content.attributes).bytes;
}

}  // namespace salbench
