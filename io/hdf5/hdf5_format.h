// SPDX-License-Identifier: GPL-3.0-or-later
// The HDF5 file format, as far as writer and reader of images (io/hdf5/hdf5_image.h) share it: superblock 0,
// object headers 1, groups as symbol tables, attributes and data spaces 1, layout 3 [hdf5_format]. Numbers
// are little-endian.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "io/arrays.h"
#include "io/file.h"

namespace salbench::hdf5 {

inline constexpr std::string_view kSignature = "\x89HDF\r\n\x1a\n";
inline constexpr std::uint64_t kUndefined = ~std::uint64_t{0};  // an address where nothing is
inline constexpr std::size_t kSuperblockBytes = 96;
inline constexpr std::size_t kMaxMessageBytes = 65'528;  // the largest multiple of 8 in two bytes
inline constexpr std::size_t kTreeChunks = 64;           // entries of a node of chunks

// Limits that hold whether we or the library read and write.
inline constexpr std::size_t kMaxRank = 8;
inline constexpr std::size_t kMaxDepth = 64;          // groups within groups, which are visited by recursion
inline constexpr std::uint64_t kMaxInflation = 1032;  // the most that deflate can do
inline constexpr std::size_t kLongText = 60'000;      // bytes; an object header holds 64 KB of attributes

// Messages of object headers.
enum class Message : std::uint16_t {
  nothing = 0x00,
  space = 0x01,
  type = 0x03,
  old_fill_value = 0x04,
  fill_value = 0x05,
  layout = 0x08,
  filters = 0x0b,
  attribute = 0x0c,
  continuation = 0x10,
  symbol_table = 0x11,
};

enum class Layout : std::uint8_t { contiguous = 1, chunked = 2 };
enum class Filter : std::uint16_t { deflate = 1, shuffle = 2 };
enum class Node : std::uint8_t { group = 0, chunks = 1 };

// Numbers and texts, one behind the other.
class ByteWriter {
 public:
  Bytes bytes = {};

  void number(std::uint64_t value, std::size_t width);
  template <class... Octets>
  void octets(Octets... values) {
    (bytes.push_back(static_cast<std::byte>(values)), ...);
  }
  void zeros(std::size_t count) { bytes.resize(bytes.size() + count); }
  void append(std::span<const std::byte> more);
  void text(std::string_view text) { append(std::as_bytes(std::span(text))); }
  void align() { zeros((8 - bytes.size() % 8) % 8); }
};

// The type of the values of an array, by the alternative of ArrayValues: what a message of a data type holds.
Bytes type_message(std::size_t alternative);
std::size_t value_bytes(std::size_t alternative);  // of one value

inline constexpr std::size_t kTypes = std::variant_size_v<ArrayValues>;
inline constexpr std::size_t kReal = 0, kInteger = 3;  // the alternatives that numbers in attributes have

// The message that types a text of so many bytes: UTF-8, filled up with zeros.
Bytes text_type_message(std::size_t bytes);

}  // namespace salbench::hdf5
