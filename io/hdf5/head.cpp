// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/hdf5/head.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "io/digest.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

// The whole file in memory:
//   0   kMagic
//   16  checksum of all that follows
//   24  bytes of the user block; attributes; arrays; zeros
constexpr std::string_view kMagic = "salbench image 1";
constexpr std::size_t kSummedFrom = kMagic.size() + sizeof(std::uint64_t);

enum AttributeType : std::uint64_t { kText, kReal, kInteger };

void add(FieldWriter& out, const std::vector<std::size_t>& extents) {
  out.add(extents.size());
  for (const std::size_t extent : extents) out.add(extent);
}

std::vector<std::size_t> extents_in(FieldReader& in) {
  std::vector<std::size_t> extents(in.count());
  for (std::size_t& extent : extents) extent = in.number();
  return extents;
}

std::uint64_t checksum_of(const std::vector<Bytes>& pieces) {
  Hasher hasher;
  for (const Bytes& piece : pieces) hasher.add(std::span(piece));
  return hasher.digest().low;
}

// Fields of an image's head, and its HDF5 part; nullopt if the bytes are not ours.
std::optional<std::pair<FieldReader, std::span<const std::byte>>> parts_of(std::span<const std::byte> image) {
  const auto magic = std::as_bytes(std::span(kMagic));
  if (image.size() < kSummedFrom || !std::ranges::equal(image.first(magic.size()), magic)) return {};
  const auto summed = image.subspan(kSummedFrom);
  if (FieldReader(image.subspan(magic.size())).number() != checksum(summed)) return {};
  FieldReader head(summed);
  const std::uint64_t block = head.number();
  return std::pair(head, image.subspan(std::min<std::uint64_t>(block, image.size())));
}

}  // namespace

void add(FieldWriter& out, const Attributes& attributes) {
  out.add(attributes.size());
  for (const auto& [name, value] : attributes) {
    out.add(name);
    out.add(value.index());
    if (const auto* text = std::get_if<std::string>(&value))
      out.add(*text);
    else if (const auto* real = std::get_if<double>(&value))
      out.add(std::bit_cast<std::uint64_t>(*real));
    else
      out.add(static_cast<std::uint64_t>(std::get<std::int64_t>(value)));
  }
}

Attributes attributes_in(FieldReader& in) {
  Attributes attributes(in.count());
  for (auto& [name, value] : attributes) {
    name = in.text();
    switch (in.number()) {
      case kText:
        value = in.text();
        break;
      case kReal:
        value = std::bit_cast<double>(in.number());
        break;
      default:
        value = static_cast<std::int64_t>(in.number());
    }
  }
  return attributes;
}

void add(FieldWriter& out, const PackedArray& array, const std::vector<FilePiece>& pieces) {
  out.add(array.name);
  add(out, array.shape);
  out.add(array.type);
  out.add(array.unit);
  out.add(array.description);
  add(out, array.chunk);
  out.add(pieces.size());
  for (const FilePiece& piece : pieces) {
    out.add(piece.at);
    out.add(piece.bytes);
  }
  out.add(checksum_of(array.pieces));
}

ListedArray array_in(FieldReader& in) {
  ListedArray listed;
  PackedArray& array = listed.array;
  array.name = in.text();
  array.shape = extents_in(in);
  array.type = in.number();
  array.unit = in.text();
  array.description = in.text();
  array.chunk = extents_in(in);
  listed.pieces.resize(in.count());
  for (FilePiece& piece : listed.pieces) {
    piece.at = in.number();
    piece.bytes = in.number();
  }
  listed.checksum = in.number();
  return listed;
}

PackedArray whole_array(ListedArray listed, const std::function<Bytes(const FilePiece&)>& read) {
  for (const FilePiece& piece : listed.pieces) listed.array.pieces.push_back(read(piece));
  if (checksum_of(listed.array.pieces) != listed.checksum) throw InputError("checksum mismatch");
  return std::move(listed.array);
}

std::uint64_t user_block(std::uint64_t head) {
  constexpr std::uint64_t kLeast = 512;
  return std::max(kLeast, std::bit_ceil(head));
}

// Relocates the superblock's file addresses. H5Pset_userblock would avoid this, but the block's size depends
// on the positions of the pieces, and library versions differ in which addresses they count from its end.
void move_behind(std::uint64_t user_block, Bytes& part) {
  constexpr std::size_t kVersionAt = 8, kBaseAt = 24, kEndAt = 40;  // in version 0
  if (part.at(kVersionAt) != std::byte{0})
    throw std::logic_error(fmt::format("HDF5 wrote a superblock of version {}, expected 0",
                                       std::to_integer<int>(part[kVersionAt])));
  for (const std::size_t at : {kBaseAt, kEndAt}) {
    std::uint64_t place = 0;
    std::memcpy(&place, part.data() + at, sizeof place);
    place += user_block;
    std::memcpy(part.data() + at, &place, sizeof place);
  }
}

Bytes image_with_head(const Hdf5Content& content) {
  std::vector<PackedArray> arrays;
  for (const Array& array : content.arrays) arrays.push_back(pack(array));
  std::vector<NamedArray> named;
  for (const PackedArray& array : arrays) named.push_back({array.name, array});
  auto [part, pieces] = hdf5_image(named, content.attributes);

  FieldWriter fields;
  add(fields, content.attributes);
  fields.add(arrays.size());
  for (std::size_t i = 0; i < arrays.size(); ++i) add(fields, arrays[i], pieces[i]);
  const std::uint64_t block = user_block(kSummedFrom + sizeof block + fields.bytes.size());
  move_behind(block, part);

  FieldWriter image;
  image.add_bytes(std::as_bytes(std::span(kMagic)));
  image.add(std::uint64_t{0});
  image.add(block);
  image.add_bytes(fields.bytes);
  image.bytes.resize(block);
  image.add_bytes(part);
  const std::uint64_t sum = checksum(std::span(image.bytes).subspan(kSummedFrom));
  std::memcpy(image.bytes.data() + kMagic.size(), &sum, sizeof sum);
  return std::move(image.bytes);
}

std::optional<Hdf5Content> content_by_head(std::span<const std::byte> image) try {
  auto parts = parts_of(image);
  if (!parts) return {};
  auto& [head, hdf5] = *parts;
  Hdf5Content content{{}, attributes_in(head)};
  std::uint64_t left = hdf5.size();  // each piece belongs to one array
  const auto bytes_of_piece = [&, hdf5 = hdf5](const FilePiece& piece) {
    if (piece.bytes > left || piece.at > hdf5.size() - piece.bytes) throw InputError("cut short");
    left -= piece.bytes;
    const auto bytes = hdf5.subspan(piece.at, piece.bytes);
    return Bytes(bytes.begin(), bytes.end());
  };
  for (std::uint64_t arrays = head.count(); arrays > 0; --arrays)
    content.arrays.push_back(unpack(whole_array(array_in(head), bytes_of_piece)));
  return content;
} catch (const InputError&) {
  return {};
}

std::optional<Attributes> attributes_by_head(std::span<const std::byte> image) try {
  auto parts = parts_of(image);
  return parts ? std::optional(attributes_in(parts->first)) : std::nullopt;
} catch (const InputError&) {
  return {};
}

}  // namespace salbench
