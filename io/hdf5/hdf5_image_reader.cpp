// SPDX-License-Identifier: GPL-3.0-or-later
// Takes what the writer beside it makes, and what the library makes of the same content: object headers that
// go on elsewhere, and groups with several nodes of symbols. Whatever else it meets is left to the library,
// which knows the whole format and says what is wrong with a file. Every address, size and count is checked
// before it is believed.
#include <algorithm>
#include <cstring>
#include <string>
#include <utility>

#include "io/hdf5/hdf5_format.h"
#include "io/hdf5/hdf5_image.h"
#include "io/hdf5/packed_chunks.h"

namespace salbench::hdf5 {
namespace {

constexpr std::size_t kObjectBytes = 16;  // the least that an object takes: more of them come from a cycle

struct Foreign {};  // thrown where a file is not of the kind that is read here

void expect(bool holds) {
  if (!holds) throw Foreign();
}

using View = std::span<const std::byte>;

View part(View bytes, std::uint64_t from, std::uint64_t size) {
  expect(from <= bytes.size() && size <= bytes.size() - from);
  return bytes.subspan(from, size);
}

class ByteReader {
 public:
  explicit ByteReader(View bytes) : left_(bytes) {}

  View take(std::uint64_t size) {
    const View taken = part(left_, 0, size);
    left_ = left_.subspan(size);
    return taken;
  }
  View take_aligned(std::uint64_t size) {
    const View taken = take(size);
    skip((8 - size % 8) % 8);
    return taken;
  }
  void skip(std::uint64_t size) { take(size); }
  std::uint64_t number(std::size_t width) {
    std::uint64_t value = 0;
    const View taken = take(width);
    for (std::size_t i = 0; i < width; ++i) value |= std::to_integer<std::uint64_t>(taken[i]) << (8 * i);
    return value;
  }
  void text(std::string_view expected) {
    expect(std::ranges::equal(take(expected.size()), std::as_bytes(std::span(expected))));
  }
  void octets(std::initializer_list<std::uint64_t> expected) {
    for (const std::uint64_t octet : expected) expect(number(1) == octet);
  }
  std::size_t size() const { return left_.size(); }

 private:
  View left_;
};

// The text up to the first zero byte, or all of it.
std::string text_in(View bytes) {
  const auto* begin = reinterpret_cast<const char*>(bytes.data());
  return {begin, std::find(begin, begin + bytes.size(), '\0')};
}

using Shape = std::vector<std::size_t>;

Shape shape_in(View message) {
  ByteReader space(message);
  space.octets({1});
  const std::uint64_t rank = space.number(1);
  expect(rank <= kMaxRank);
  expect(space.number(1) <= 1);  // whether the largest extents follow
  space.skip(5);
  Shape shape;
  for (std::uint64_t i = 0; i < rank; ++i) shape.push_back(space.number(8));
  return shape;
}

std::uint64_t bytes_of(std::uint64_t bytes, const Shape& shape) {
  for (const std::uint64_t extent : shape) expect(!__builtin_mul_overflow(bytes, extent, &bytes));
  return bytes;
}

// A message may be filled up to a multiple of 8.
bool is_type(View message, const Bytes& type) {
  return message.size() >= type.size() && std::ranges::equal(message.first(type.size()), type);
}

template <class T>
T value_in(View bytes) {
  expect(bytes.size() >= sizeof(T));
  T value;
  std::memcpy(&value, bytes.data(), sizeof value);
  return value;
}

std::pair<std::string, AttributeValue> attribute_in(View message) {
  ByteReader body(message);
  body.octets({1, 0});
  const std::uint64_t name_bytes = body.number(2), type_bytes = body.number(2), space_bytes = body.number(2);
  std::string name = text_in(body.take_aligned(name_bytes));
  const View type = body.take_aligned(type_bytes);
  expect(shape_in(body.take_aligned(space_bytes)).empty());
  const View value = body.take(body.size());
  if (is_type(type, type_message(kReal))) return {std::move(name), value_in<double>(value)};
  if (is_type(type, type_message(kInteger))) return {std::move(name), value_in<std::int64_t>(value)};
  expect(type.size() >= 8);
  const std::uint64_t size = ByteReader(type.subspan(4)).number(4);
  expect(is_type(type, text_type_message(size)));
  return {std::move(name), text_in(part(value, 0, size))};
}

struct Object {
  std::vector<std::pair<Message, View>> messages;

  // Empty if there is none.
  View find(Message type) const {
    for (const auto& [one, body] : messages)
      if (one == type) return body;
    return {};
  }
  Attributes attributes() const {
    Attributes result;
    for (const auto& [type, body] : messages)
      if (type == Message::attribute) result.push_back(attribute_in(body));
    std::ranges::sort(result, {}, &Attributes::value_type::first);
    return result;
  }
};

std::string text_of(const Attributes& attributes, std::string_view name) {
  const AttributeValue* value = find_attribute(attributes, name);
  if (value == nullptr) return {};
  expect(std::holds_alternative<std::string>(*value));
  return std::get<std::string>(*value);
}

class Parser {
 public:
  explicit Parser(View file) : file_(file), objects_left_(file.size() / kObjectBytes) {}

  Hdf5Content content() {
    const Object root = root_object();
    Hdf5Content content{{}, root.attributes()};
    read_links(root, "", 0, content.arrays);
    return content;
  }
  Attributes attributes() { return root_object().attributes(); }

 private:
  Object root_object() {
    ByteReader superblock(file_);
    superblock.text(kSignature);
    superblock.octets({0, 0, 0, 0, 0, 8, 8, 0});
    superblock.skip(8);  // sizes of nodes, which say how many entries they hold
    expect(superblock.number(8) == 0);
    superblock.skip(8);
    expect(superblock.number(8) == file_.size());
    superblock.skip(16);
    return object_at(superblock.number(8));
  }

  Object object_at(std::uint64_t address) {
    expect(objects_left_-- > 0);
    ByteReader prefix(part(file_, address, 16));
    prefix.octets({1, 0});
    std::uint64_t messages = prefix.number(2);
    prefix.skip(4);
    Object object;
    std::vector<View> blocks = {part(file_, address + 16, prefix.number(4))};
    for (std::size_t i = 0; i < blocks.size(); ++i)
      for (ByteReader block(blocks[i]); block.size() >= 8;) {
        expect(messages-- > 0);
        const auto type = static_cast<Message>(block.number(2));
        const std::uint64_t size = block.number(2);
        expect((block.number(4) & 0x02) == 0);  // its body is elsewhere
        const View body = block.take(size);
        if (type == Message::continuation) {
          ByteReader where(body);
          const std::uint64_t at = where.number(8);
          blocks.push_back(part(file_, at, where.number(8)));
        } else if (type != Message::nothing) {
          object.messages.emplace_back(type, body);
        }
      }
    expect(messages == 0);
    return object;
  }

  void read_links(const Object& group, const std::string& path, std::size_t depth, Arrays& arrays) {
    expect(depth < kMaxDepth);
    ByteReader addresses(group.find(Message::symbol_table));
    const std::uint64_t tree = addresses.number(8);
    ByteReader heap(part(file_, addresses.number(8), 32));
    heap.text("HEAP");
    heap.octets({0, 0, 0, 0});
    const std::uint64_t names_bytes = heap.number(8);
    heap.skip(8);
    const View names = part(file_, heap.number(8), names_bytes);
    for (const View symbols : leaves_of(tree, Node::group, 8)) {
      ByteReader node(part(file_, ByteReader(symbols.subspan(8)).number(8), 8));
      node.text("SNOD");
      node.octets({1, 0});
      const std::uint64_t links = node.number(2);
      ByteReader link(part(file_, ByteReader(symbols.subspan(8)).number(8) + 8, links * 40));
      for (std::uint64_t i = 0; i < links; ++i) {
        const std::uint64_t at = link.number(8);
        expect(at < names.size());
        const std::string name = path + text_in(names.subspan(at));
        const std::uint64_t address = link.number(8);
        expect(link.number(4) <= 1);  // 2: a symbolic link
        link.skip(20);
        read_object(object_at(address), name, depth, arrays);
      }
    }
  }

  void read_object(const Object& object, const std::string& name, std::size_t depth, Arrays& arrays) {
    if (!object.find(Message::symbol_table).empty()) return read_links(object, name + "/", depth + 1, arrays);
    const View type = object.find(Message::type);
    Array array{.name = name,
                .shape = shape_in(object.find(Message::space)),
                .values = {},
                .unit = {},
                .description = {}};
    const Attributes attributes = object.attributes();
    array.unit = text_of(attributes, "unit");
    array.description = text_of(attributes, "description");
    std::size_t alternative = 0;
    while (alternative < kTypes && !is_type(type, type_message(alternative))) ++alternative;
    switch (alternative) {
      case 0:
        array.values = values_of<double>(object, array.shape);
        break;
      case 1:
        array.values = values_of<float>(object, array.shape);
        break;
      case 2:
        array.values = values_of<std::int32_t>(object, array.shape);
        break;
      case 3:
        array.values = values_of<std::int64_t>(object, array.shape);
        break;
      case 4:
        array.values = values_of<std::uint8_t>(object, array.shape);
        break;
      default:
        throw Foreign();
    }
    arrays.push_back(std::move(array));
  }

  template <class T>
  std::vector<T> values_of(const Object& object, const Shape& shape) {
    ByteReader layout(object.find(Message::layout));
    layout.octets({3});
    const std::uint64_t bytes = bytes_of(sizeof(T), shape);
    const auto kind = static_cast<Layout>(layout.number(1));
    if (kind == Layout::chunked) return values_in_chunks<T>(object, layout, shape, bytes);
    expect(kind == Layout::contiguous && object.find(Message::filters).empty());
    const std::uint64_t address = layout.number(8);
    expect(layout.number(8) == bytes);
    std::vector<T> values(bytes == 0 ? 0 : part(file_, address, bytes).size() / sizeof(T));
    if (bytes > 0) std::memcpy(values.data(), file_.subspan(address).data(), bytes);
    return values;
  }

  template <class T>
  std::vector<T> values_in_chunks(const Object& object, ByteReader layout, const Shape& shape,
                                  std::uint64_t bytes) {
    expect(!shape.empty() && bytes > 0 && bytes / kMaxInflation <= file_.size());
    expect(layout.number(1) == shape.size() + 1);
    const std::uint64_t tree = layout.number(8);
    Shape chunk;
    for (std::size_t i = 0; i < shape.size(); ++i) chunk.push_back(layout.number(4));
    expect(layout.number(4) == sizeof(T) && std::equal(chunk.begin() + 1, chunk.end(), shape.begin() + 1));
    expect_filters(object.find(Message::filters), sizeof(T));
    const std::uint64_t chunk_bytes = bytes_of(sizeof(T), chunk);
    expect(chunk_bytes > 0 && chunk_bytes / kMaxInflation <= file_.size());
    std::vector<T> values(bytes / sizeof(T));
    const auto all = std::as_writable_bytes(std::span(values));
    std::uint64_t done = 0;
    for (const View entry : leaves_of(tree, Node::chunks, 8 + 8 * (shape.size() + 1))) {
      ByteReader key(entry);
      const std::uint64_t packed_bytes = key.number(4);
      expect(key.number(4) == 0 && done < bytes && key.number(8) * (chunk_bytes / chunk[0]) == done);
      key.skip(8 * shape.size());
      const std::uint64_t size = std::min(chunk_bytes, bytes - done);
      expect(
          unpack(part(file_, key.number(8), packed_bytes), sizeof(T), chunk_bytes, all.subspan(done, size)));
      done += size;
    }
    expect(done == bytes);
    return values;
  }

  // Entries of a tree that is a leaf: a key of so many bytes, and an address.
  std::vector<View> leaves_of(std::uint64_t address, Node kind, std::size_t key_bytes) const {
    ByteReader node(part(file_, address, 24));
    node.text("TREE");
    node.octets({static_cast<std::uint64_t>(kind), 0});
    const std::uint64_t entries = node.number(2);
    ByteReader rest(part(file_, address + 24, entries * (key_bytes + 8)));
    std::vector<View> result;
    for (std::uint64_t i = 0; i < entries; ++i) result.push_back(rest.take(key_bytes + 8));
    return result;
  }

  static void expect_filters(View message, std::size_t value) {
    ByteReader filters(message);
    filters.octets({1, 2});
    filters.skip(6);
    for (const auto& [filter, parameter] :
         {std::pair{Filter::shuffle, value}, {Filter::deflate, kPackLevel}}) {
      expect(filters.number(2) == static_cast<std::uint64_t>(filter));
      const std::uint64_t name_bytes = filters.number(2);
      filters.skip(2);
      expect(filters.number(2) == 1);
      filters.skip(name_bytes);
      expect(filters.number(4) == parameter);
      filters.skip(4);
    }
  }

  View file_;
  std::uint64_t objects_left_;
};

}  // namespace

std::optional<Hdf5Content> parsed_image(View image) try {
  return Parser(image).content();
} catch (const Foreign&) {
  return {};
}

std::optional<Attributes> attributes_of_image(View image) try {
  return Parser(image).attributes();
} catch (const Foreign&) {
  return {};
}

}  // namespace salbench::hdf5
