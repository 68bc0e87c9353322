// SPDX-License-Identifier: GPL-3.0-or-later
// Triangulates by ear clipping. [meisters1975] No ear is inverted, so the triangles cover each point as often
// as the polygon winds around it: exactly the interior of a polygon without self-intersection. Holes that a
// bridge of two equal edges connects to the outline are handled.
//
// CGAL's Delaunay triangulation is no alternative: it breaks ties by the addresses of its faces, and depends
// on its version, while meshes must be equal on every machine. Polygons of mesh files are small.
#include "io/shapes/polygons.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

namespace salbench {
namespace {

using Vec2 = Eigen::Vector2d;

// Limit, since all pairs of edges are tested for crossings.
constexpr std::size_t kMostCorners = 1 << 14;

// The polygon projected along its normal, counter-clockwise, scaled to a largest extent of 1.
class Outline {
 public:
  explicit Outline(const std::vector<Vec3>& corners);

  std::size_t size() const { return corners_.size(); }
  bool has_area() const { return has_area_; }
  const Vec2& operator[](std::size_t i) const { return corners_[i]; }

  // 1: a, b, c turn left; -1: right; 0: collinear within the rounding error of the coordinates.
  int turn(std::size_t a, std::size_t b, std::size_t c) const {
    const Vec2 ab = corners_[b] - corners_[a], ac = corners_[c] - corners_[a];
    const double area = ab.x() * ac.y() - ab.y() * ac.x();
    const double least = rounding_ * std::max(ab.cwiseAbs().maxCoeff(), ac.cwiseAbs().maxCoeff());
    return area > least ? 1 : area < -least ? -1 : 0;
  }

 private:
  std::vector<Vec2> corners_;
  double rounding_ = 0;
  bool has_area_ = false;
};

Outline::Outline(const std::vector<Vec3>& corners) {
  double largest = 0, extent = 0;
  for (const Vec3& corner : corners) {
    largest = std::max(largest, corner.cwiseAbs().maxCoeff());
    extent = std::max(extent, (corner - corners[0]).cwiseAbs().maxCoeff());
  }
  if (extent == 0) return;
  rounding_ = 8 * std::numeric_limits<double>::epsilon() * std::max(largest / extent, 1.0);

  // The normal is the sum over the triangles of the fan. If they cancel, as in a bow tie, any one will do.
  Vec3 normal = Vec3::Zero(), longest = Vec3::Zero();
  for (std::size_t i = 2; i < corners.size(); ++i) {
    const Vec3 part = ((corners[i - 1] - corners[0]) / extent).cross((corners[i] - corners[0]) / extent);
    normal += part;
    if (part.squaredNorm() > longest.squaredNorm()) longest = part;
  }
  if (normal.norm() <= rounding_) normal = longest;
  has_area_ = normal.norm() > rounding_;
  if (!has_area_) return;
  const Vec3 x = normal.normalized().unitOrthogonal(), y = normal.normalized().cross(x);
  corners_.reserve(corners.size());
  for (const Vec3& corner : corners) {
    const Vec3 place = (corner - corners[0]) / extent;
    corners_.emplace_back(place.dot(x), place.dot(y));
  }
}

bool is_concave(const Outline& outline) {
  const std::size_t n = outline.size();
  for (std::size_t i = 0; i < n; ++i)
    if (outline.turn(i, (i + 1) % n, (i + 2) % n) < 0) return true;
  return false;
}

// True if no triangle of the fan is inverted, and the fan turns around the first corner at most once.
bool is_filled_by_fan(const Outline& outline) {
  bool half_way = false;
  for (std::size_t i = 2; i < outline.size(); ++i) {
    if (outline.turn(0, i - 1, i) < 0) return false;
    const int side = outline.turn(0, 1, i);
    if (half_way && side > 0) return false;
    half_way |= side < 0;
  }
  return true;
}

// Two edges, by their first corners, that intersect in the interior of both.
std::optional<std::pair<std::size_t, std::size_t>> crossing_edges(const Outline& outline) {
  const std::size_t n = outline.size();
  std::vector<Eigen::AlignedBox2d> boxes;
  for (std::size_t i = 0; i < n; ++i)
    boxes.push_back(Eigen::AlignedBox2d(outline[i]).extend(outline[(i + 1) % n]));
  const auto parts = [&](std::size_t edge, std::size_t other) {  // true if the other's ends lie on both sides
    const std::size_t a = edge, b = (edge + 1) % n;
    return outline.turn(a, b, other) * outline.turn(a, b, (other + 1) % n) < 0;
  };
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 2; j < n; ++j)
      if (boxes[i].intersects(boxes[j]) && parts(i, j) && parts(j, i)) return std::pair(i, j);
  return {};
}

class EarCutter {
 public:
  explicit EarCutter(const Outline& outline) : outline_(outline), left_(outline.size()) {
    for (std::size_t i = 0; i < left_; ++i) {
      next_.push_back((i + 1) % left_);
      before_.push_back((i + left_ - 1) % left_);
    }
  }

  // Returns n - 2 triangles of corners; fewer if the polygon overlaps itself.
  std::vector<std::array<std::size_t, 3>> triangles() {
    bool flat = false;  // no ear is left: cuts off a corner within a straight line
    for (std::size_t corner = 0, missed = 0; left_ > 2;) {
      if (flat ? turn_at(corner) == 0 : is_ear(corner)) {
        triangles_.push_back({before_[corner], corner, next_[corner]});
        corner = cut(corner);
        missed = 0;
        flat = false;
      } else {
        corner = next_[corner];
        if (++missed < left_) continue;
        if (std::exchange(flat, true)) break;
        missed = 0;
      }
    }
    return std::move(triangles_);
  }

 private:
  int turn_at(std::size_t corner) const { return outline_.turn(before_[corner], corner, next_[corner]); }

  // Returns the next corner to test. Not the neighbour: all ears around it would form a fan of slivers.
  std::size_t cut(std::size_t corner) {
    const std::size_t before = before_[corner], after = next_[corner];
    next_[before] = after;
    before_[after] = before;
    --left_;
    return next_[after];
  }

  // True for a spike (there and back), and for a convex corner whose triangle contains no other corner.
  bool is_ear(std::size_t b) const {
    const std::size_t a = before_[b], c = next_[b];
    const auto same = [&](std::size_t i, std::size_t j) { return outline_[i] == outline_[j]; };
    if (same(a, c) || same(a, b) || same(b, c)) return true;
    if (turn_at(b) <= 0) return false;
    const Eigen::AlignedBox2d box = Eigen::AlignedBox2d(outline_[a]).extend(outline_[b]).extend(outline_[c]);
    for (std::size_t k = next_[c]; k != a; k = next_[k]) {
      if (!box.contains(outline_[k]) || same(k, a) || same(k, b) || same(k, c)) continue;
      if (outline_.turn(a, b, k) > 0 && outline_.turn(b, c, k) > 0 && outline_.turn(c, a, k) >= 0)
        return false;
    }
    return true;
  }

  const Outline& outline_;
  std::size_t left_;
  std::vector<std::size_t> next_, before_;
  std::vector<std::array<std::size_t, 3>> triangles_;
};

}  // namespace

std::size_t faces_in_file(const PolygonCounts& counts, std::size_t n_triangles) {
  for (const SplitPolygon& polygon : counts.polygons) n_triangles -= polygon.triangles - 1;
  return n_triangles;
}

std::vector<std::int32_t> faces_of_triangles(const PolygonCounts& counts, std::size_t n_triangles) {
  std::vector<std::int32_t> faces;
  faces.reserve(n_triangles);
  std::int32_t face = 0;
  const auto add_triangles_before = [&](std::size_t end) {
    while (faces.size() < end) faces.push_back(face++);
  };
  for (const auto& [first, triangles] : counts.polygons) {
    add_triangles_before(first);
    faces.insert(faces.end(), triangles, face++);
  }
  add_triangles_before(n_triangles);
  return faces;
}

std::string text_of_faces(std::size_t n_in_file, std::size_t n_triangles) {
  return n_in_file == n_triangles ? fmt::format("{} faces", n_triangles)
                                  : fmt::format("{} faces, split into {} triangles", n_in_file, n_triangles);
}

void Polygons::add(std::span<const std::int32_t> corners, std::size_t place, std::vector<Triangle>& faces) {
  if (corners.size() > 3) fans_.push_back({faces.size(), corners.size(), place});
  for (std::size_t i = 2; i < corners.size(); ++i) faces.push_back({corners[0], corners[i - 1], corners[i]});
}

PolygonCounts Polygons::split(Mesh& mesh, const Refuse& refuse) const {
  PolygonCounts counts{.split = std::ssize(fans_)};
  for (const Fan& fan : fans_) counts.polygons.push_back({fan.first, fan.corners - 2});
  std::vector<std::int32_t> vertices;
  std::vector<Vec3> corners;
  for (const Fan& fan : fans_) {
    const std::span<Triangle> faces = std::span(mesh.faces).subspan(fan.first, fan.corners - 2);
    vertices.assign({faces[0][0], faces[0][1]});
    for (const Triangle& face : faces) vertices.push_back(face[2]);
    corners.clear();
    for (const std::int32_t v : vertices) corners.push_back(mesh.vertices[static_cast<std::size_t>(v)]);
    const Outline outline(corners);
    if (!outline.has_area()) continue;
    counts.concave += is_concave(outline) ? 1 : 0;
    if (is_filled_by_fan(outline)) continue;

    if (outline.size() > kMostCorners)
      refuse(fan.place, fmt::format("a concave face with {} corners: at most {} can be split into triangles; "
                                    "write it as triangles",
                                    outline.size(), kMostCorners));
    if (const auto edges = crossing_edges(outline))
      refuse(fan.place,
             fmt::format("edges {} and {} of the face (counted from 1) cross each other: write it as "
                         "faces that do not cross themselves",
                         edges->first + 1, edges->second + 1));
    const auto triangles = EarCutter(outline).triangles();
    if (triangles.size() != faces.size())
      refuse(fan.place, "the face overlaps itself: write it as faces that do not");
    for (std::size_t t = 0; t < faces.size(); ++t)
      faces[t] = {vertices[triangles[t][0]], vertices[triangles[t][1]], vertices[triangles[t][2]]};
  }
  return counts;
}

}  // namespace salbench
