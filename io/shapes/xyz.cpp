// SPDX-License-Identifier: GPL-3.0-or-later
// Points as text, one per line. The format has no header, so what the columns are is told by their number.

#include <array>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "io/shapes/cloud_file.h"
#include "io/shapes/mesh_parts.h"
#include "io/shapes/text_scanner.h"

namespace salbench {
namespace {

class XyzParser {
 public:
  XyzParser(std::string_view text, std::string_view name) : in_(text, name, '#') {}

  PointCloud parse() {
    bool more = in_.next_filled_line();
    if (more && holds_one_word()) {
      read_count();
      more = in_.next_filled_line();
    }
    for (; more; more = in_.next_filled_line()) read_point();
    const std::int64_t n = std::ssize(cloud_.points);
    if (n == 0) in_.fail("the file ends without a point");
    if (announced_ && n < *announced_) in_.fail(ends_early(n, *announced_, "points"));
    if (!cloud_.normals.empty() && !has_unit_normal_) fail_as_colours(cloud_.normals[0], first_point_);
    return std::move(cloud_);
  }

 private:
  bool holds_one_word() const {
    TextScanner ahead = in_;
    ahead.word();
    return ahead.at_line_end();
  }

  void read_count() {
    announced_ = in_.integer();
    if (const std::string wrong = wrong_with_count(*announced_, "points"); !wrong.empty()) in_.fail(wrong);
  }

  void read_point() {
    const std::int64_t n = std::ssize(cloud_.points);
    if (announced_ && n == *announced_)
      in_.fail(fmt::format("there are more points than the {} that the first line announces", n));
    if (n == 0) first_point_ = in_.line_number();
    if (n == kMaxVertices) in_.fail(wrong_with_count(n + 1, "points"));
    std::array<double, 6> values{};
    std::size_t count = 0;
    for (; !in_.at_line_end() && count < values.size(); ++count) values[count] = in_.number_or_nan();
    if (!in_.at_line_end() || (count != 3 && count != 6))
      in_.fail("a point needs 3 values, x y z, or 6, x y z nx ny nz, separated by blanks");
    if (n > 0 && (count == 6) == cloud_.normals.empty())
      in_.fail(fmt::format("the line has {} values, and the lines before have {}", count, 9 - count));
    cloud_.points.emplace_back(values[0], values[1], values[2]);
    if (count == 6) add_normal({values[3], values[4], values[5]});
  }

  // Columns have no names, and three numbers of another length may be a colour. Rounding to two decimals
  // leaves a unit normal within 1 %. NaN and zeros: no normal was measured there.
  void add_normal(const Vec3& normal) {
    constexpr double kTolerance = 0.01;
    const double length = normal.stableNorm();
    if (length > 0 && !(std::abs(length - 1) <= kTolerance)) fail_as_colours(normal, in_.line_number());
    if (length > 0) has_unit_normal_ = true;
    cloud_.normals.push_back(normal);
  }

  [[noreturn]] void fail_as_colours(const Vec3& values, std::size_t line) const {
    in_.fail_at(
        line, fmt::format("the last three of six values are {} {} {}, which is not a unit normal: are these "
                          "colours? Write x y z alone, or name the columns in a description",
                          values.x(), values.y(), values.z()));
  }

  TextScanner in_;
  PointCloud cloud_;
  std::optional<std::int64_t> announced_;
  std::size_t first_point_ = 0;  // line number
  bool has_unit_normal_ = false;
};

}  // namespace

PointCloud parse_xyz(std::string_view text, std::string_view name) { return XyzParser(text, name).parse(); }

}  // namespace salbench
