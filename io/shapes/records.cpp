// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/shapes/records.h"

#include <cmath>
#include <span>

#include <fmt/format.h>

#include "io/shapes/mesh_parts.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

// A line may end only after a record, or after several complete ones; elsewhere it is too short or too long.
class TextBody {
 public:
  TextBody(const TextScanner& in, const Schema& schema, bool finite)
      : in_(in), schema_(schema), finite_(finite) {
    if (schema.further_columns) in_.skip_line();
  }

  // The first line with several records determines the number per line.
  void begin(const Records& records) {
    require_no_more_on_last_line();
    records_ = &records;
    begun_ = on_line_ = per_line_ = 0;
  }

  void next_record() {
    begins_line_ = in_.at_line_end();
    expected_at_line_end_ = {};
    if (begins_line_) {
      if (per_line_ == 0) per_line_ = on_line_;
      if (on_line_ != per_line_) fail_as_uneven();
      on_line_ = 0;
      if (!in_.next_filled_line()) fail(ends_early(begun_, records_->count, records_->plural()));
    }
    ++begun_;
  }

  void end_record() {
    ++on_line_;
    if (schema_.further_columns && expected_at_line_end_.empty()) in_.skip_line();
    if (!expected_at_line_end_.empty() && !in_.at_line_end())
      in_.fail_at(first_line_end_, fmt::format("the line ends where {} is expected", expected_at_line_end_));
  }

  double number(const NumberType&) {
    reach_word("a number");
    return finite_ ? in_.number() : in_.number_or_nan();
  }
  double whole_number(const NumberType&) {
    if (schema_.whole_numbers_have_points) return number({});
    reach_word("a whole number");
    return static_cast<double>(in_.integer());
  }
  void skip(const NumberType&, std::int64_t n) {
    for (std::int64_t i = 0; i < n; ++i) {
      reach_word("a value");
      in_.skip_word();
    }
  }

  void end() {
    require_no_more_on_last_line();
    if (!in_.at_line_end()) fail_as_too_many();
    if (in_.next_filled_line())
      fail(fmt::format("there is more text after the last {}: the counts of the header are wrong",
                       records_->one()));
  }

  std::size_t place() const { return in_.line_number(); }  // line of the record's end
  [[noreturn]] void fail(std::string_view what) const { in_.fail(what); }
  [[noreturn]] void fail_at(const Records&, std::size_t place, std::string_view what) const {
    in_.fail_at(place, what);
  }

 private:
  void reach_word(std::string_view what) {
    if (!in_.at_line_end()) return;
    if (!begins_line_) fail_as_too_many();
    if (expected_at_line_end_.empty()) {
      expected_at_line_end_ = what;
      first_line_end_ = in_.line_number();
    }
    if (!in_.next_filled_line()) fail(ends_early(begun_ - 1, records_->count, records_->plural()));
  }

  void require_no_more_on_last_line() const {
    if (per_line_ != 0 && on_line_ > per_line_) fail_as_uneven();
  }
  [[noreturn]] void fail_as_uneven() const {
    fail(fmt::format("the line has {} {}, and the lines before have {}", on_line_, records_->plural(),
                     per_line_));
  }
  [[noreturn]] void fail_as_too_many() const { fail("the line has more values than the header says"); }

  TextScanner in_;
  const Schema& schema_;
  bool finite_;  // numbers must be finite
  const Records* records_ = nullptr;
  std::int64_t begun_ = 0;
  std::int64_t on_line_ = 0;   // complete records on the line
  std::int64_t per_line_ = 0;  // 0 until the first line of records has ended
  bool begins_line_ = false;
  std::string_view expected_at_line_end_;  // in a record that spans lines; else empty
  std::size_t first_line_end_ = 0;         // line number of that line end
};

class BinaryBody {
 public:
  BinaryBody(const TextScanner& in, std::string_view bytes, const Schema& schema)
      : in_(in), schema_(schema), rest_(bytes) {}

  void begin(const Records& records) {
    records_ = &records;
    begun_ = 0;
  }
  void next_record() { ++begun_; }
  void end_record() {}

  double number(const NumberType& type) {
    const char* const bytes = taken(type.bytes);
    const bool swapped = schema_.encoding == Encoding::big_endian;
    return with_type(
        type, [&](auto zero) { return static_cast<double>(number_at<decltype(zero)>(bytes, swapped)); });
  }
  double whole_number(const NumberType& type) { return number(type); }
  void skip(const NumberType& type, std::int64_t n) { taken(type.bytes * static_cast<std::size_t>(n)); }
  void end() const {
    if (rest_.find_first_not_of(" \r\n") == rest_.npos) return;
    throw InputError(
        fmt::format("{}: there are {} bytes after the last {}: the header is wrong, or the file "
                    "went through a conversion of line ends",
                    in_.name(), rest_.size(), records_->one()));
  }

  std::size_t place() const { return static_cast<std::size_t>(begun_); }
  [[noreturn]] void fail(std::string_view what) const {
    throw InputError(fmt::format("{}: {} {} (counted from 1), before byte {}: {}", in_.name(),
                                 records_->one(), begun_, in_.size() - rest_.size(), what));
  }
  [[noreturn]] void fail_at(const Records& records, std::size_t place, std::string_view what) const {
    throw InputError(fmt::format("{}: {} {} (counted from 1): {}", in_.name(), records.one(), place, what));
  }

 private:
  const char* taken(std::size_t n) {
    if (n > rest_.size()) fail_as_cut_short();
    const char* const taken = rest_.data();
    rest_.remove_prefix(n);
    return taken;
  }
  [[noreturn]] void fail_as_cut_short() const {
    throw InputError(
        fmt::format("{}: {}", in_.name(), ends_early(begun_ - 1, records_->count, records_->plural())));
  }

  const TextScanner& in_;
  const Schema& schema_;
  const Records* records_ = nullptr;
  std::int64_t begun_ = 0;
  std::string_view rest_;
};

// Reads the requested numbers and lists of each record, and skips everything else.
template <class Body>
class RecordReader {
 public:
  RecordReader(Body& body, const Records& records, std::span<const std::string_view> numbers)
      : body_(body), records_(records), values_(numbers.size(), 0), places_(records.columns.size()) {
    for (std::size_t i = 0; i < numbers.size(); ++i)
      if (const Column* column = records.number(numbers[i]))
        places_[static_cast<std::size_t>(column - records.columns.data())] = &values_[i];
    body.begin(records);
  }

  void next(const Column* corners = nullptr, std::int64_t n_vertices = 0) {
    body_.next_record();
    for (std::size_t i = 0; i < places_.size(); ++i) {
      const Column& column = records_.columns[i];
      if (places_[i] != nullptr)
        *places_[i] = body_.number(column.type);
      else if (&column == corners)
        read_corners(column, n_vertices);
      else
        body_.skip(column.type, column.length ? list_length(column) : 1);
    }
    body_.end_record();
  }

  // The last record read: its numbers, and the corners of a face.
  const std::vector<double>& values() const { return values_; }
  const std::vector<std::int32_t>& corners() const { return corners_; }

 private:
  std::int64_t list_length(const Column& column) {
    return checked_length(body_.whole_number(*column.length));
  }
  std::int64_t checked_length(double length) const {
    constexpr double kMaxLength = 4294967295.0;  // maximum of the widest integer type
    if (!(length >= 0 && length <= kMaxLength) || length != std::floor(length))
      body_.fail(fmt::format("{} is not the length of a list", length));
    return static_cast<std::int64_t>(length);
  }

  void read_corners(const Column& column, std::int64_t n_vertices) {
    const double length = body_.whole_number(*column.length);
    if (const std::string wrong = wrong_with_polygon(length); !wrong.empty()) body_.fail(wrong);
    const std::int64_t size = checked_length(length);
    corners_.clear();
    for (std::int64_t i = 0; i < size; ++i) {
      const double index = body_.whole_number(column.type);
      if (index != std::floor(index)) body_.fail(fmt::format("{} is not a vertex index", index));
      if (index < 0 || index >= static_cast<double>(n_vertices))
        body_.fail(index_out_of_range(index, 0, n_vertices));
      corners_.push_back(static_cast<std::int32_t>(index));
    }
  }

  Body& body_;
  const Records& records_;
  std::vector<double> values_;
  std::vector<double*> places_;  // by column; null for skipped ones
  std::vector<std::int32_t> corners_;
};

// Number of records to reserve memory for: as announced by the header, but limited by the size of the file.
std::size_t room_for(const Records& records, std::size_t bytes) {
  constexpr std::size_t kMinBytesPerRecord = 6;  // "0 0 0\n"
  return std::min(static_cast<std::size_t>(records.count), bytes / kMinBytesPerRecord);
}

using Names = std::span<const std::string_view>;

template <class Body>
Mesh mesh_in(Body body, const Schema& schema, const Column* corners, PolygonCounts* counts,
             std::size_t bytes) {
  constexpr std::array<std::string_view, 3> kPlace = {"x", "y", "z"};
  const Records *vertices = schema.find("vertex"), *faces = schema.find("face");
  Mesh mesh;
  mesh.vertices.reserve(room_for(*vertices, bytes));
  if (faces != nullptr) mesh.faces.reserve(room_for(*faces, bytes));
  Polygons polygons;
  for (const Records& records : schema.records) {
    if (records.columns.empty()) continue;  // records without bytes, however many are announced
    RecordReader in(body, records, &records == vertices ? Names(kPlace) : Names());
    for (std::int64_t i = 0; i < records.count; ++i) {
      in.next(corners, vertices->count);
      if (&records == faces) polygons.add(in.corners(), body.place(), mesh.faces);
      if (&records != vertices) continue;
      mesh.vertices.emplace_back(in.values()[0], in.values()[1], in.values()[2]);
      if (const auto wrong = wrong_with_point(mesh.vertices.back()); !wrong.empty()) body.fail(wrong);
    }
  }
  body.end();
  const PolygonCounts found = polygons.split(
      mesh, [&](std::size_t place, const std::string& why) { body.fail_at(*faces, place, why); });
  if (counts != nullptr) *counts = found;
  return mesh;
}

bool has_numbers(const Records& records, Names names) {
  return std::ranges::all_of(names, [&](std::string_view name) { return records.number(name) != nullptr; });
}

// Viewpoint of a file. The origin means "unknown", except for an organised cloud, which has one camera.
std::optional<Vec3> known_viewpoint(const Vec3& written, double rows) {
  const bool is_known = written.allFinite() && (!written.isZero(0) || rows > 1);
  return is_known ? std::optional(written) : std::nullopt;
}

template <class Body>
PointCloud cloud_in(Body body, const Schema& schema, std::size_t bytes) {
  constexpr std::array<std::string_view, 6> kOfPoint = {"x", "y", "z", "nx", "ny", "nz"};
  constexpr std::array<std::string_view, 4> kOfCamera = {"view_px", "view_py", "view_pz", "viewporty"};
  const Records* camera = schema.find("camera");
  const Records& points = *schema.find("vertex");
  const bool has_normals = has_numbers(points, kOfPoint);
  const Names of_point = has_normals ? Names(kOfPoint) : Names(kOfPoint).first(3);
  PointCloud cloud;
  cloud.points.reserve(room_for(points, bytes));
  for (const Records& records : schema.records) {
    if (records.columns.empty()) continue;
    const bool is_point = &records == &points, is_camera = &records == camera;
    RecordReader in(body, records, is_point ? of_point : is_camera ? Names(kOfCamera) : Names());
    for (std::int64_t i = 0; i < records.count; ++i) {
      in.next();
      if (!is_point) continue;
      const std::vector<double>& values = in.values();
      cloud.points.emplace_back(values[0], values[1], values[2]);
      if (has_normals) cloud.normals.emplace_back(values[3], values[4], values[5]);
    }
    if (is_camera && has_numbers(records, Names(kOfCamera).first(3)))
      cloud.viewpoint = known_viewpoint(Vec3(in.values().data()), in.values()[3]);
  }
  body.end();
  return cloud;
}

template <class Named>
const Named* find_named(const std::vector<Named>& all, std::string_view name) {
  const auto found = std::ranges::find(all, name, &Named::name);
  return found == all.end() ? nullptr : &*found;
}

}  // namespace

const Column* Records::number(std::string_view column) const {
  const Column* found = find_named(columns, column);
  return found == nullptr || found->length ? nullptr : found;
}

const Column* Records::list(std::string_view column) const {
  const Column* found = find_named(columns, column);
  return found == nullptr || !found->length ? nullptr : found;
}

std::string Records::one() const {
  const bool is_known = name == "vertex" || name == "face";
  return is_known ? name : fmt::format("element {}", in_quotes(name));
}

std::string Records::plural() const {
  if (name == "vertex") return "vertices";
  return name == "face" ? "faces" : fmt::format("elements {}", in_quotes(name));
}

const Records* Schema::find(std::string_view name) const { return find_named(records, name); }

Mesh read_mesh_records(const TextScanner& in, const Schema& schema, const Column* corners,
                       PolygonCounts* counts) {
  const std::string_view body = in.text_after_line();
  if (schema.encoding == Encoding::text)
    return mesh_in(TextBody(in, schema, true), schema, corners, counts, body.size());
  return mesh_in(BinaryBody(in, body, schema), schema, corners, counts, body.size());
}

PointCloud read_cloud_records(const TextScanner& in, const Schema& schema) {
  const std::string_view body = in.text_after_line();
  if (schema.encoding == Encoding::text) return cloud_in(TextBody(in, schema, false), schema, body.size());
  return cloud_in(BinaryBody(in, body, schema), schema, body.size());
}

}  // namespace salbench
