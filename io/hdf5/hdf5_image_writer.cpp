// SPDX-License-Identifier: GPL-3.0-or-later
// The format's earliest version [hdf5_format], with one node wherever it has trees: the superblock says how
// many links a node of a group takes, and chunks are few (io/hdf5/packed_chunks.h). What an address leads to
// is written before it, so that every address is known when it is written.
#include <algorithm>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>

#include <fmt/format.h>

#include "io/hdf5/hdf5_format.h"
#include "io/hdf5/hdf5_image.h"
#include "io/hdf5/packed_chunks.h"
#include "io/shapes/text_scanner.h"

namespace salbench::hdf5 {
namespace {

constexpr std::uint64_t kGroupTreeK = 16;  // half the links of a node of a group's tree
constexpr std::size_t kGroupTreeBytes = 24 + (2 * kGroupTreeK + 1) * 8 + 2 * kGroupTreeK * 8;
constexpr std::uint64_t kNoFreeBlock = 1;  // of a local heap
constexpr std::uint8_t kFillLate = 2, kFillIncremental = 3, kFillIfSet = 2, kDefined = 1;

struct Header {
  ByteWriter messages = {};
  std::size_t count = 0;

  void add(Message type, ByteWriter body) {
    body.align();
    messages.number(static_cast<std::uint64_t>(type), 2);
    messages.number(body.bytes.size(), 2);
    messages.zeros(4);  // flags, reserved
    messages.append(body.bytes);
    ++count;
  }
};

ByteWriter space_of(const std::vector<std::size_t>& shape) {
  ByteWriter body;
  body.octets(1, shape.size());
  body.zeros(6);
  for (const std::size_t extent : shape) body.number(extent, 8);
  return body;
}

void add_attribute(Header& header, const std::string& name, const Bytes& type,
                   std::span<const std::byte> value) {
  ByteWriter body;
  const Bytes space = space_of({}).bytes;
  body.octets(1, 0);
  body.number(name.size() + 1, 2);
  body.number(type.size(), 2);
  body.number(space.size(), 2);
  body.text(name);
  body.zeros(1);
  body.align();
  body.append(type);
  body.align();
  body.append(space);
  body.append(value);
  if (body.bytes.size() > kMaxMessageBytes) throw std::runtime_error("HDF5: an attribute is too long");
  header.add(Message::attribute, std::move(body));
}

void add_attribute(Header& header, const std::string& name, const AttributeValue& value) {
  if (const auto* text = std::get_if<std::string>(&value)) {
    const std::string_view shown = text->empty() ? std::string_view("\0", 1) : *text;
    add_attribute(header, name, text_type_message(shown.size()), std::as_bytes(std::span(shown)));
  } else if (const auto* real = std::get_if<double>(&value)) {
    add_attribute(header, name, type_message(kReal), std::as_bytes(std::span(real, 1)));
  } else {
    add_attribute(header, name, type_message(kInteger),
                  std::as_bytes(std::span(&std::get<std::int64_t>(value), 1)));
  }
}

// A group's links by name. An array has none.
struct Tree {
  const Array* array = nullptr;
  std::map<std::string, std::unique_ptr<Tree>, std::less<>> links = {};
};

Tree& linked(Tree& group, const std::string& name) {
  auto& link = group.links[name];
  if (!link) link = std::make_unique<Tree>();
  return *link;
}

Tree tree_of(const Arrays& arrays) {
  Tree root;
  for (const Array& array : arrays) {
    Tree* place = &root;
    for (std::size_t begin = 0, end = 0; end < array.name.size(); begin = end + 1) {
      end = std::min(array.name.find('/', begin), array.name.size());
      place = &linked(*place, array.name.substr(begin, end - begin));
      if (place->array != nullptr) break;
    }
    if (place == &root || place->array != nullptr || !place->links.empty())
      throw std::runtime_error(fmt::format("HDF5: two things are called {}", in_quotes(array.name)));
    place->array = &array;
  }
  return root;
}

std::size_t most_links(const Tree& tree) {
  std::size_t most = tree.links.size();
  for (const auto& [name, link] : tree.links) most = std::max(most, most_links(*link));
  return most;
}

class Image {
 public:
  explicit Image(const Hdf5Content& content) : root_(tree_of(content.arrays)) {
    links_ = std::max<std::size_t>(8, (most_links(root_) + 1) / 2 * 2);
    if (links_ > 60'000) throw std::runtime_error("HDF5: too many arrays in a group");
    file_.zeros(kSuperblockBytes);
    Header header;
    const GroupAddresses links = write_links(root_);
    header.add(Message::symbol_table, links.message());
    for (const auto& [name, value] : content.attributes) add_attribute(header, name, value);
    const std::uint64_t root = write_header(header);
    const Bytes superblock = superblock_of(root, links);
    std::ranges::copy(superblock, file_.bytes.begin());
  }

  Bytes take() { return std::move(file_.bytes); }

 private:
  struct GroupAddresses {
    std::uint64_t tree = 0, heap = 0;
    ByteWriter message() const {
      ByteWriter body;
      body.number(tree, 8);
      body.number(heap, 8);
      return body;
    }
  };

  std::uint64_t append(const ByteWriter& block) {
    const std::uint64_t address = file_.bytes.size();
    file_.append(block.bytes);
    file_.align();
    return address;
  }

  std::uint64_t write_header(const Header& header) {
    ByteWriter block;
    block.octets(1, 0);
    block.number(header.count, 2);
    block.number(1, 4);  // links to it
    block.number(header.messages.bytes.size(), 4);
    block.zeros(4);
    block.append(header.messages.bytes);
    return append(block);
  }

  Bytes superblock_of(std::uint64_t root, const GroupAddresses& links) const {
    ByteWriter block;
    block.text(kSignature);
    block.octets(0, 0, 0, 0, 0, 8, 8, 0);  // versions; sizes of addresses and lengths
    block.number(links_ / 2, 2);
    block.number(kGroupTreeK, 2);
    block.number(0, 4);
    block.number(0, 8);
    block.number(kUndefined, 8);
    block.number(file_.bytes.size(), 8);
    block.number(kUndefined, 8);
    block.number(0, 8);
    block.number(root, 8);
    block.number(1, 4);  // the addresses of the root group's links follow
    block.zeros(4);
    block.append(links.message().bytes);
    return block.bytes;
  }

  std::uint64_t write(const Tree& tree) {
    if (tree.array != nullptr) return write(*tree.array);
    Header header;
    header.add(Message::symbol_table, write_links(tree).message());
    return write_header(header);
  }

  GroupAddresses write_links(const Tree& group) {
    ByteWriter names, symbols;
    names.zeros(8);  // the empty name
    symbols.text("SNOD");
    symbols.octets(1, 0);
    symbols.number(group.links.size(), 2);
    std::size_t last = 0;
    for (const auto& [name, link] : group.links) {
      last = names.bytes.size();
      symbols.number(last, 8);
      symbols.number(write(*link), 8);
      symbols.zeros(24);
      names.text(name);
      names.zeros(1);
      names.align();
    }
    symbols.zeros((links_ - group.links.size()) * 40);
    const std::uint64_t names_at = append(names), symbols_at = append(symbols);
    ByteWriter heap;
    heap.text("HEAP");
    heap.zeros(4);
    heap.number(names.bytes.size(), 8);
    heap.number(kNoFreeBlock, 8);
    heap.number(names_at, 8);
    ByteWriter tree = tree_node(Node::group, group.links.empty() ? 0 : 1);
    tree.number(0, 8);
    if (!group.links.empty()) {
      tree.number(symbols_at, 8);
      tree.number(last, 8);
    }
    tree.zeros(kGroupTreeBytes - tree.bytes.size());
    const std::uint64_t heap_at = append(heap);
    return {append(tree), heap_at};
  }

  static ByteWriter tree_node(Node kind, std::size_t entries) {
    ByteWriter node;
    node.text("TREE");
    node.octets(kind, 0);  // a leaf
    node.number(entries, 2);
    node.number(kUndefined, 8);  // no siblings
    node.number(kUndefined, 8);
    return node;
  }

  std::uint64_t write(const Array& array) {
    const std::size_t values = std::visit([](const auto& v) { return v.size(); }, array.values);
    if (values != array.count())
      throw std::logic_error(
          fmt::format("array {} has {} values for its shape of {}", array.name, values, array.count()));
    const std::size_t value = value_bytes(array.values.index());
    const auto packed_values = packed(array);
    const ByteWriter layout = packed_values ? write_chunks(*packed_values, value) : write_values(array);
    Header header;
    header.add(Message::space, space_of(array.shape));
    header.add(Message::type, {type_message(array.values.index())});
    ByteWriter fill;
    fill.octets(2, packed_values ? kFillIncremental : kFillLate, kFillIfSet, kDefined, 0, 0, 0, 0);
    header.add(Message::fill_value, fill);
    header.add(Message::layout, layout);
    if (packed_values) header.add(Message::filters, filters(value));
    add_attribute(header, "unit", array.unit);
    add_attribute(header, "description", array.description);
    return write_header(header);
  }

  ByteWriter write_values(const Array& array) {
    const std::uint64_t address = file_.bytes.size();
    std::visit([&](const auto& values) { file_.append(std::as_bytes(std::span(values))); }, array.values);
    const std::uint64_t size = file_.bytes.size() - address;
    file_.align();
    ByteWriter layout;
    layout.octets(3, Layout::contiguous);
    layout.number(size == 0 ? kUndefined : address, 8);
    layout.number(size, 8);
    return layout;
  }

  // A key is a chunk's size and the indices of its first value; the one behind the last chunk follows it.
  ByteWriter write_chunks(const PackedChunks& packed, std::size_t value) {
    const std::size_t rank = packed.shape.size();
    const auto key = [rank](ByteWriter& node, std::size_t bytes, std::uint64_t row) {
      node.number(bytes, 4);
      node.number(0, 4);  // every filter was applied
      node.number(row, 8);
      node.zeros(rank * 8);
    };
    ByteWriter node = tree_node(Node::chunks, packed.chunks.size());
    std::uint64_t row = 0;
    for (const Bytes& chunk : packed.chunks) {
      key(node, chunk.size(), row);
      const std::uint64_t address = file_.bytes.size();
      file_.append(chunk);
      file_.align();
      node.number(address, 8);
      row += packed.shape[0];
    }
    key(node, 0, row);
    const std::size_t key_bytes = 8 + (rank + 1) * 8;
    node.zeros(24 + (kTreeChunks + 1) * key_bytes + kTreeChunks * 8 - node.bytes.size());
    ByteWriter layout;
    layout.octets(3, Layout::chunked, rank + 1);
    layout.number(append(node), 8);
    for (const std::size_t extent : packed.shape) layout.number(extent, 4);
    layout.number(value, 4);
    return layout;
  }

  static ByteWriter filters(std::size_t value) {
    ByteWriter body;
    body.octets(1, 2);
    body.zeros(6);
    // Without the names, which the format allows, the library's H5Ocopy would write a message cut short
    // (1.10.8).
    const auto add = [&](Filter filter, std::string_view name, std::uint64_t parameter) {
      body.number(static_cast<std::uint64_t>(filter), 2);
      body.number(name.size() + 1, 2);
      body.number(1, 2);  // optional
      body.number(1, 2);  // parameters
      body.text(name);
      body.zeros(1);
      body.number(parameter, 4);
      body.zeros(4);
    };
    add(Filter::shuffle, "shuffle", value);
    add(Filter::deflate, "deflate", kPackLevel);
    return body;
  }

  Tree root_;
  std::size_t links_ = 0;  // that a node of a group takes
  ByteWriter file_ = {};
};

Bytes number_type(std::uint8_t kind, std::initializer_list<int> bits, std::size_t size,
                  const ByteWriter& properties) {
  ByteWriter type;
  type.octets(0x10 | kind);
  for (const int bit : bits) type.octets(bit);
  type.number(size, 4);
  type.append(properties.bytes);
  return type.bytes;
}

Bytes whole_type(std::size_t size, bool is_signed) {
  ByteWriter properties;
  properties.number(0, 2);
  properties.number(8 * size, 2);
  return number_type(0, {is_signed ? 0x08 : 0, 0, 0}, size, properties);
}

Bytes real_type(std::size_t size, int exponent_bits, int mantissa_bits, std::uint64_t bias) {
  constexpr int kLeadingBitIsImplied = 0x20;
  ByteWriter properties;
  properties.number(0, 2);
  properties.number(8 * size, 2);
  properties.octets(mantissa_bits, exponent_bits, 0, mantissa_bits);
  properties.number(bias, 4);
  return number_type(1, {kLeadingBitIsImplied, static_cast<int>(8 * size) - 1, 0}, size, properties);
}

}  // namespace

void ByteWriter::number(std::uint64_t value, std::size_t width) {
  for (std::size_t i = 0; i < width; ++i) bytes.push_back(static_cast<std::byte>(value >> (8 * i)));
}

void ByteWriter::append(std::span<const std::byte> more) {
  const std::size_t end = bytes.size();
  bytes.resize(end + more.size());
  std::ranges::copy(more, bytes.begin() + static_cast<std::ptrdiff_t>(end));
}

std::size_t value_bytes(std::size_t alternative) {
  constexpr std::array<std::size_t, kTypes> kBytes = {8, 4, 4, 8, 1};
  return kBytes.at(alternative);
}

Bytes type_message(std::size_t alternative) {
  const std::size_t size = value_bytes(alternative);
  switch (alternative) {
    case 0:
      return real_type(size, 11, 52, 1023);
    case 1:
      return real_type(size, 8, 23, 127);
    default:
      return whole_type(size, alternative != 4);
  }
}

Bytes text_type_message(std::size_t bytes) {
  constexpr int kZerosAndUtf8 = 0x11;
  return number_type(3, {kZerosAndUtf8, 0, 0}, bytes, {});
}

std::optional<Bytes> written_image(const Hdf5Content& content) {
  const auto is_long = [](const auto& attribute) {
    const auto* text = std::get_if<std::string>(&attribute.second);
    return text != nullptr && text->size() > kLongText;
  };
  if (std::ranges::any_of(content.attributes, is_long)) return {};
  return Image(content).take();
}

}  // namespace salbench::hdf5
