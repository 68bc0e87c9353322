// SPDX-License-Identifier: GPL-3.0-or-later
// The header says what the body consists of, so one walk over the elements serves every encoding; a body
// class reads text or bytes. The walk covers all elements, the last included, so a truncated file is detected
// wherever it ends. [turk1994]

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <functional>
#include <initializer_list>

#include <fmt/format.h>

#include "io/shapes/cloud_file.h"
#include "io/shapes/mesh_file.h"
#include "io/shapes/mesh_parts.h"
#include "io/shapes/ply_header.h"
#include "io/shapes/polygons.h"
#include "io/shapes/text_scanner.h"

namespace salbench {
namespace {

using ply::Element;
using ply::Encoding;
using ply::Property;
using ply::Type;

std::string singular_of(const Element& element) {
  const bool is_known = element.name == "vertex" || element.name == "face";
  return is_known ? element.name : fmt::format("element {}", in_quotes(element.name));
}

std::string plural_of(const Element& element) {
  if (element.name == "vertex") return "vertices";
  if (element.name == "face") return "faces";
  return fmt::format("elements {}", in_quotes(element.name));
}

class AsciiBody {
 public:
  AsciiBody(const TextScanner& after_header, bool finite) : in_(after_header), finite_(finite) {}

  void begin(const Element& element) { in_.begin_records(element.count, plural_of(element)); }
  void next_record() { in_.next_record(); }
  void end_record() { in_.end_record(); }
  double value(Type) { return finite_ ? in_.number() : in_.number_or_nan(); }
  void skip(Type, std::int64_t n) {
    for (std::int64_t i = 0; i < n; ++i) in_.skip_word();
  }
  void end() { in_.end_records("there is more text after the last element: the header is wrong"); }
  [[noreturn]] void fail(std::string_view what) const { in_.fail(what); }
  std::size_t place() const { return in_.line_number(); }  // of the record's end

 private:
  TextScanner in_;
  bool finite_;  // all numbers that are read
};

class BinaryBody {
 public:
  BinaryBody(const TextScanner& after_header, std::size_t file_size, bool swapped)
      : bytes_(after_header.text_after_line()),
        name_(after_header.name()),
        file_size_(file_size),
        swapped_(swapped) {}

  void begin(const Element& element) {
    element_ = &element;
    records_begun_ = 0;
  }
  void next_record() { ++records_begun_; }
  void end_record() {}

  double value(Type type) {
    return std::visit([&](auto zero) { return static_cast<double>(take<decltype(zero)>()); }, type);
  }
  void skip(Type type, std::int64_t n) {
    const std::size_t size = std::visit([](auto zero) { return sizeof zero; }, type);
    take_bytes(static_cast<std::size_t>(n) * size);
  }

  void end() const {  // some writers add a line break
    if (bytes_.find_first_not_of(" \r\n") != bytes_.npos)
      throw InputError(
          fmt::format("{}: there are {} bytes after the last element: the header is wrong, or the "
                      "file went through a conversion of line ends",
                      name_, bytes_.size()));
  }
  [[noreturn]] void fail(std::string_view what) const {
    throw InputError(fmt::format("{}: {} {} (counted from 1), before byte {}: {}", name_,
                                 singular_of(*element_), records_begun_, file_size_ - bytes_.size(), what));
  }
  std::size_t place() const { return static_cast<std::size_t>(records_begun_); }

 private:
  std::string_view take_bytes(std::size_t n) {
    if (n > bytes_.size())
      throw InputError(fmt::format("{}: {}", name_,
                                   ends_early(records_begun_ - 1, element_->count, plural_of(*element_))));
    const std::string_view taken = bytes_.substr(0, n);
    bytes_.remove_prefix(n);
    return taken;
  }

  template <class T>
  T take() {
    std::array<char, sizeof(T)> raw;
    std::memcpy(raw.data(), take_bytes(sizeof(T)).data(), sizeof(T));
    if (swapped_) std::reverse(raw.begin(), raw.end());
    return std::bit_cast<T>(raw);
  }

  std::string_view bytes_;  // not yet read
  std::string name_;
  std::size_t file_size_;
  bool swapped_;
  const Element* element_ = nullptr;
  std::int64_t records_begun_ = 0;
};

template <class Body>
std::int64_t list_length(Body& body, Type type) {
  const double length = body.value(type);
  constexpr double kMaxLength = 4294967295.0;  // of the widest integer type
  if (!(length >= 0 && length <= kMaxLength) || length != std::floor(length))
    body.fail(fmt::format("{} is not the length of a list", length));
  return static_cast<std::int64_t>(length);
}

template <class Body>
void skip_property(Body& body, const Property& property) {
  body.skip(property.type, property.length_type ? list_length(body, *property.length_type) : 1);
}

template <class Body>
void read_polygon(Body& body, const Property& corners, std::int64_t n_vertices,
                  std::vector<std::int32_t>& polygon) {
  const std::int64_t size = list_length(body, *corners.length_type);
  if (const std::string wrong = wrong_with_polygon(size); !wrong.empty()) body.fail(wrong);
  polygon.clear();
  for (std::int64_t i = 0; i < size; ++i) {
    const double index = body.value(corners.type);
    if (index != std::floor(index)) body.fail(fmt::format("{} is not a vertex index", index));
    if (index < 0 || index >= static_cast<double>(n_vertices))
      body.fail(fmt::format("vertex index {} is out of range: there are {} vertices, numbered from 0", index,
                            n_vertices));
    polygon.push_back(static_cast<std::int32_t>(index));
  }
}

const Property* corners_of(const Element& face) {
  const Property* corners = face.find("vertex_indices");
  return corners != nullptr ? corners : face.find("vertex_index");
}

// Numbers that are read of each record of an element: x, y, z, nx ...; null for what the file does not have.
struct Numbers {
  const Element* element = nullptr;
  std::vector<const Property*> properties = {};
  std::vector<double> values = {};  // of the latest record

  Numbers(const ply::Header& header, std::string_view name, std::initializer_list<std::string_view> wanted)
      : element(header.find(name)), values(wanted.size(), 0) {
    for (const std::string_view number : wanted) {
      const Property* property = element == nullptr ? nullptr : element->find(number);
      properties.push_back(property != nullptr && !property->length_type ? property : nullptr);
    }
  }
  bool has(std::size_t first, std::size_t count) const {
    return std::all_of(properties.begin() + static_cast<long>(first),
                       properties.begin() + static_cast<long>(first + count),
                       [](const Property* property) { return property != nullptr; });
  }
  Vec3 triple(std::size_t first) const { return {values[first], values[first + 1], values[first + 2]}; }
  double* place_of(const Property& property) {
    const auto found = std::find(properties.begin(), properties.end(), &property);
    return found == properties.end() ? nullptr
                                     : &values[static_cast<std::size_t>(found - properties.begin())];
  }
};

// Properties that are read of each record.
struct Wanted {
  Numbers vertex, camera;
  const Element* face = nullptr;  // null for point clouds
  const Property* corners = nullptr;
  std::function<std::string_view()> end_vertex = {};  // what is wrong with it
  std::function<void(const std::vector<std::int32_t>& polygon, std::size_t place)> end_face = {};
};

// Other elements are passed over, and so are all other properties of these.
template <class Body>
void read_body(Body body, const ply::Header& header, Wanted& wanted) {
  std::vector<std::int32_t> polygon;
  for (const Element& element : header.elements) {
    if (element.properties.empty()) continue;  // no bytes, however many are announced
    Numbers& numbers = &element == wanted.camera.element ? wanted.camera : wanted.vertex;
    body.begin(element);
    for (std::int64_t i = 0; i < element.count; ++i) {
      body.next_record();
      for (const Property& property : element.properties) {
        if (double* place = numbers.place_of(property))
          *place = body.value(property.type);
        else if (&property == wanted.corners)
          read_polygon(body, property, wanted.vertex.element->count, polygon);
        else
          skip_property(body, property);
      }
      body.end_record();
      if (&element == wanted.vertex.element)
        if (const std::string_view wrong = wanted.end_vertex(); !wrong.empty()) body.fail(wrong);
      if (&element == wanted.face) wanted.end_face(polygon, body.place());
    }
  }
  body.end();
}

void read_encoded(const TextScanner& in, std::size_t file_size, const ply::Header& header, bool finite,
                  Wanted& wanted) {
  if (header.encoding == Encoding::ascii) return read_body(AsciiBody(in, finite), header, wanted);
  const bool swapped = (header.encoding == Encoding::big_endian) != (std::endian::native == std::endian::big);
  read_body(BinaryBody(in, file_size, swapped), header, wanted);
}

// Refuses headers that read_body cannot follow.
void check_vertices(const TextScanner& in, const ply::Header& header, std::string_view held) {
  const Element* vertex = header.find("vertex");
  if (vertex == nullptr)
    in.fail(fmt::format("the header has no element \"vertex\": the file holds no {}", held));
  for (const char* axis : {"x", "y", "z"}) {
    const Property* property = vertex->find(axis);
    if (property == nullptr || property->length_type)
      in.fail(fmt::format("the header gives vertices no number \"{}\"", axis));
  }
}

void check_count(const TextScanner& in, const Element* element) {
  if (element == nullptr) return;
  if (const std::string wrong = wrong_with_count(element->count, plural_of(*element)); !wrong.empty())
    in.fail(wrong);
}

void check_faces(const TextScanner& in, const ply::Header& header) {
  if (header.find("tristrips") != nullptr)
    in.fail("triangle strips cannot be read: write the mesh with an element \"face\"");
  const Element* face = header.find("face");
  if (face != nullptr && (corners_of(*face) == nullptr || !corners_of(*face)->length_type))
    in.fail("the header gives faces no list \"vertex_indices\"");
}

}  // namespace

Mesh parse_ply(std::string_view bytes, std::string_view name, PolygonCounts* counts) {
  TextScanner in(bytes, name, '\0', LineEnds::as_first);
  const ply::Header header = ply::read_header(in);
  check_vertices(in, header, "mesh");
  check_faces(in, header);
  const Element *vertex = header.find("vertex"), *face = header.find("face");
  check_count(in, vertex);
  check_count(in, face);
  Mesh mesh;
  mesh.vertices.reserve(room_for(vertex->count, bytes.size()));
  if (face != nullptr) mesh.faces.reserve(room_for(face->count, bytes.size()));
  Wanted wanted{.vertex = {header, "vertex", {"x", "y", "z"}},
                .camera = {header, "camera", {}},
                .face = face,
                .corners = face == nullptr ? nullptr : corners_of(*face)};
  wanted.end_vertex = [&] {
    mesh.vertices.push_back(wanted.vertex.triple(0));
    return wrong_with_point(mesh.vertices.back());
  };
  Polygons polygons;
  wanted.end_face = [&](const std::vector<std::int32_t>& polygon, std::size_t place) {
    polygons.add(polygon, place, mesh.faces);
  };
  read_encoded(in, bytes.size(), header, true, wanted);
  const PolygonCounts found = polygons.split(mesh, [&](std::size_t place, const std::string& why) {
    if (header.encoding == Encoding::ascii) in.fail_at(place, why);
    throw InputError(fmt::format("{}: face {} (counted from 1): {}", name, place, why));
  });
  if (counts != nullptr) *counts = found;
  return mesh;
}

PointCloud parse_ply_cloud(std::string_view bytes, std::string_view name) {
  TextScanner in(bytes, name, '\0', LineEnds::as_first);
  const ply::Header header = ply::read_header(in);
  check_vertices(in, header, "point cloud");
  const Element *vertex = header.find("vertex"), *face = header.find("face");
  check_count(in, vertex);
  if (face != nullptr && face->count > 0)
    in.fail("the header announces faces: the file holds a mesh, and a point cloud was expected");
  PointCloud cloud;
  cloud.points.reserve(room_for(vertex->count, bytes.size()));
  Wanted wanted{.vertex = {header, "vertex", {"x", "y", "z", "nx", "ny", "nz"}},
                .camera = {header, "camera", {"view_px", "view_py", "view_pz", "viewporty"}}};
  const bool normals = wanted.vertex.has(3, 3);
  wanted.end_vertex = [&]() -> std::string_view {
    cloud.points.push_back(wanted.vertex.triple(0));
    if (normals) cloud.normals.push_back(wanted.vertex.triple(3));
    return {};
  };
  read_encoded(in, bytes.size(), header, false, wanted);
  const Numbers& camera = wanted.camera;
  if (camera.has(0, 3) && camera.triple(0).allFinite() &&
      (!camera.triple(0).isZero(0) || camera.values[3] > 1))
    cloud.viewpoint = camera.triple(0);
  return cloud;
}

}  // namespace salbench
