// Follows Garland and Heckbert 1997, for pairs that are joined by an edge. Quadrics are weighted by area, and
// each border edge adds the plane through it at right angles to its face, which keeps the outline of an open
// mesh.
//
// The queue holds every edge once for each state of its end points; an entry whose end points have changed
// since is skipped when it comes up. A refused collapse may become possible when the faces around it have
// changed, so an empty queue is filled again until a whole round changes nothing.
#include "stages/models/simplified.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <iterator>
#include <optional>
#include <queue>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include <Eigen/Eigenvalues>

#include "stages/core/mesh_ops.h"

namespace salbench {
namespace {

using Edge = std::pair<std::size_t, std::size_t>;  // ascending

constexpr double kBorderWeight = 1;  // of a border edge's plane, per squared length of the edge
constexpr double kEvenness = 1e-8;  // factor of an edge's squared length in its error; decides in flat places
constexpr double kMinStiffness = 1e-5;  // relative to the largest eigenvalue: below, a direction is free
constexpr double kMinCosine = 0.2;      // of the angle by which one collapse turns a face

// Sum of weighted squared distances to planes: x'Ax + 2b'x + c.
struct Quadric {
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
  Vec3 b = Vec3::Zero();
  double c = 0;

  void add_plane(const Vec3& normal, const Vec3& point, double weight) {
    const double d = -normal.dot(point);
    a += weight * normal * normal.transpose();
    b += weight * d * normal;
    c += weight * d * d;
  }
  Quadric& operator+=(const Quadric& other) {
    a += other.a;
    b += other.b;
    c += other.c;
    return *this;
  }
  double weight() const { return a.trace(); }  // of all planes
  double operator()(const Vec3& x) const { return std::max(0.0, x.dot(a * x) + 2 * b.dot(x) + c); }
};

// The point of least error. Along directions that the quadric leaves free it is the one nearest to `near`.
Vec3 optimum(const Quadric& quadric, const Vec3& near) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(quadric.a);
  const Vec3 pull = -(quadric.b + quadric.a * near);
  Vec3 place = near;
  for (int k = 0; k < 3; ++k) {
    const double stiffness = axes.eigenvalues()[k];
    if (stiffness <= kMinStiffness * axes.eigenvalues()[2]) continue;
    const Vec3 axis = axes.eigenvectors().col(k);
    place += axis * (axis.dot(pull) / stiffness);
  }
  return place;
}

class EdgeCollapse {
 public:
  explicit EdgeCollapse(const Mesh& mesh);
  void run(std::size_t target_faces);
  Mesh result() const;

 private:
  struct Candidate {
    double cost;
    Edge edge;
    std::uint32_t state_a, state_b;  // of the end points when it was queued
    bool operator>(const Candidate& other) const {
      return std::tie(cost, edge) > std::tie(other.cost, other.edge);
    }
  };

  struct Moved {  // both ends of an edge are moved to one place
    Edge edge;
    Vec3 place;
  };

  void add_faces(const Mesh& mesh);
  void add_border_planes();
  void fill_queue();
  void push(std::size_t a, std::size_t b);
  Vec3 place_for(const Edge& edge) const;
  bool is_current(const Candidate& candidate) const;
  bool keeps_topology(const Edge& edge) const;
  bool doubles_a_face(const Edge& edge, const std::vector<std::size_t>& shared) const;
  bool folds(const Edge& edge, const Vec3& place) const;
  void collapse(const Edge& edge, const Vec3& place);

  bool has(std::size_t face, std::size_t vertex) const;
  Vec3 area_vector(std::size_t face, const std::optional<Moved>& moved) const;
  std::size_t faces_on(std::size_t a, std::size_t b) const;
  std::vector<std::size_t> ring(std::size_t vertex) const;
  bool on_border(std::size_t vertex) const;

  Vec3 origin_ = Vec3::Zero();
  double unit_ = 1;
  std::vector<Vec3> places_;  // from the origin, in units
  std::vector<Quadric> quadrics_;
  std::vector<std::uint32_t> states_;  // counts the changes of each vertex
  std::vector<std::array<std::size_t, 3>> faces_;
  std::vector<std::vector<std::size_t>> faces_of_;  // no vertex lists a face that has collapsed
  std::size_t n_faces_ = 0;
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> queue_;
};

EdgeCollapse::EdgeCollapse(const Mesh& mesh)
    : places_(mesh.vertices),
      quadrics_(mesh.vertices.size()),
      states_(mesh.vertices.size(), 0),
      faces_of_(mesh.vertices.size()) {
  // Quadrics hold squared coordinates: far from the origin they would lose the digits that matter, and in
  // units of the wrong size overflow.
  if (places_.empty()) return;
  origin_ = centroid(places_);
  if (const double radius = bounding_radius(places_); radius > 0) unit_ = radius;
  for (Vec3& place : places_) place = (place - origin_) / unit_;
  add_faces(mesh);
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    const Vec3 doubled = area_vector(f, {});
    for (const std::size_t v : faces_[f])
      quadrics_[v].add_plane(doubled.normalized(), places_[v], doubled.norm() / 2);
  }
  add_border_planes();
}

void EdgeCollapse::add_faces(const Mesh& mesh) {
  std::set<Triangle> seen;
  for (const Triangle& face : mesh.faces) {
    Triangle key = face;
    std::sort(key.begin(), key.end());
    if (key[0] == key[1] || key[1] == key[2] || !seen.insert(key).second) continue;
    for (const std::int32_t v : face) faces_of_[static_cast<std::size_t>(v)].push_back(faces_.size());
    faces_.push_back({static_cast<std::size_t>(face[0]), static_cast<std::size_t>(face[1]),
                      static_cast<std::size_t>(face[2])});
  }
  n_faces_ = faces_.size();
}

void EdgeCollapse::add_border_planes() {
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    const auto& face = faces_[f];
    const Vec3 normal = area_vector(f, {}).normalized();
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t a = face[k], b = face[(k + 1) % 3];
      if (faces_on(a, b) != 1) continue;
      const Vec3 edge = places_[b] - places_[a];
      for (const std::size_t v : {a, b})
        quadrics_[v].add_plane(edge.cross(normal).normalized(), places_[a],
                               kBorderWeight * edge.squaredNorm());
    }
  }
}

void EdgeCollapse::run(std::size_t target_faces) {
  for (bool changed = true; changed && n_faces_ > target_faces;) {
    changed = false;
    fill_queue();
    while (!queue_.empty() && n_faces_ > target_faces) {
      const Candidate next = queue_.top();
      queue_.pop();
      if (!is_current(next) || !keeps_topology(next.edge)) continue;
      const Vec3 place = place_for(next.edge);
      if (folds(next.edge, place)) continue;
      collapse(next.edge, place);
      changed = true;
    }
  }
}

void EdgeCollapse::fill_queue() {
  for (std::size_t a = 0; a < places_.size(); ++a) {
    for (const std::size_t b : ring(a))
      if (a < b) push(a, b);
  }
}

void EdgeCollapse::push(std::size_t a, std::size_t b) {
  const Edge edge = std::minmax(a, b);
  Quadric sum = quadrics_[a];
  sum += quadrics_[b];
  const double evenness = kEvenness * sum.weight() * (places_[a] - places_[b]).squaredNorm();
  queue_.push({sum(place_for(edge)) + evenness, edge, states_[edge.first], states_[edge.second]});
}

Vec3 EdgeCollapse::place_for(const Edge& edge) const {
  Quadric sum = quadrics_[edge.first];
  sum += quadrics_[edge.second];
  return optimum(sum, (places_[edge.first] + places_[edge.second]) / 2);
}

bool EdgeCollapse::is_current(const Candidate& candidate) const {
  return states_[candidate.edge.first] == candidate.state_a &&
         states_[candidate.edge.second] == candidate.state_b;
}

// The link condition: where the surface is a manifold, it is homeomorphic before and after. A triangle that
// alone connects a corner to the rest stays, so that connected points remain connected.
bool EdgeCollapse::keeps_topology(const Edge& edge) const {
  const auto [a, b] = edge;
  const std::vector<std::size_t> ring_a = ring(a), ring_b = ring(b);
  std::vector<std::size_t> shared;
  std::set_intersection(ring_a.begin(), ring_a.end(), ring_b.begin(), ring_b.end(),
                        std::back_inserter(shared));
  const std::size_t n_faces = faces_on(a, b);
  if (shared.size() != n_faces) return false;
  if (n_faces > 1 && on_border(a) && on_border(b)) return false;
  for (const std::size_t c : shared)
    if (faces_on(a, c) == 1 && faces_on(b, c) == 1) return false;
  return !doubles_a_face(edge, shared);
}

// Two faces (a, c, d) and (b, c, d) would become the same: the edges cd lie among the shared neighbours.
bool EdgeCollapse::doubles_a_face(const Edge& edge, const std::vector<std::size_t>& shared) const {
  const auto spans = [&](std::size_t v, std::size_t c, std::size_t d) {
    return std::any_of(faces_of_[v].begin(), faces_of_[v].end(),
                       [&](std::size_t face) { return has(face, c) && has(face, d); });
  };
  for (std::size_t i = 0; i < shared.size(); ++i) {
    for (std::size_t j = i + 1; j < shared.size(); ++j)
      if (spans(edge.first, shared[i], shared[j]) && spans(edge.second, shared[i], shared[j])) return true;
  }
  return false;
}

bool EdgeCollapse::folds(const Edge& edge, const Vec3& place) const {
  const auto turns_over = [&](std::size_t face) {
    if (has(face, edge.first) && has(face, edge.second)) return false;  // it vanishes
    const Vec3 before = area_vector(face, {}), after = area_vector(face, Moved{edge, place});
    return before.norm() > 0 && before.dot(after) <= kMinCosine * before.norm() * after.norm();
  };
  return std::any_of(faces_of_[edge.first].begin(), faces_of_[edge.first].end(), turns_over) ||
         std::any_of(faces_of_[edge.second].begin(), faces_of_[edge.second].end(), turns_over);
}

// The first vertex becomes the merged one.
void EdgeCollapse::collapse(const Edge& edge, const Vec3& place) {
  const auto [a, b] = edge;
  places_[a] = place;
  quadrics_[a] += quadrics_[b];
  for (const std::size_t face : faces_of_[b]) {
    if (has(face, a)) {
      for (const std::size_t v : faces_[face])
        if (v != b) std::erase(faces_of_[v], face);
      --n_faces_;
    } else {
      std::replace(faces_[face].begin(), faces_[face].end(), b, a);
      faces_of_[a].push_back(face);
    }
  }
  faces_of_[b].clear();
  ++states_[a];
  ++states_[b];
  for (const std::size_t c : ring(a)) push(a, c);
}

bool EdgeCollapse::has(std::size_t face, std::size_t vertex) const {
  return std::find(faces_[face].begin(), faces_[face].end(), vertex) != faces_[face].end();
}

Vec3 EdgeCollapse::area_vector(std::size_t face, const std::optional<Moved>& moved) const {
  std::array<Vec3, 3> corner;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t v = faces_[face][k];
    const bool merged = moved && (v == moved->edge.first || v == moved->edge.second);
    corner[k] = merged ? moved->place : places_[v];
  }
  return (corner[1] - corner[0]).cross(corner[2] - corner[0]);
}

std::size_t EdgeCollapse::faces_on(std::size_t a, std::size_t b) const {
  return static_cast<std::size_t>(std::count_if(faces_of_[a].begin(), faces_of_[a].end(),
                                                [&](std::size_t face) { return has(face, b); }));
}

// The distinct neighbours along edges, ascending.
std::vector<std::size_t> EdgeCollapse::ring(std::size_t vertex) const {
  std::vector<std::size_t> around;
  for (const std::size_t face : faces_of_[vertex])
    for (const std::size_t v : faces_[face])
      if (v != vertex) around.push_back(v);
  std::sort(around.begin(), around.end());
  around.erase(std::unique(around.begin(), around.end()), around.end());
  return around;
}

bool EdgeCollapse::on_border(std::size_t vertex) const {
  const std::vector<std::size_t> around = ring(vertex);
  return std::any_of(around.begin(), around.end(),
                     [&](std::size_t other) { return faces_on(vertex, other) == 1; });
}

Mesh EdgeCollapse::result() const {
  constexpr std::int32_t kUnused = -1;
  std::vector<std::int32_t> index(places_.size(), kUnused);
  Mesh mesh;
  for (std::size_t v = 0; v < places_.size(); ++v) {
    if (faces_of_[v].empty()) continue;
    index[v] = static_cast<std::int32_t>(mesh.vertices.size());
    mesh.vertices.push_back(origin_ + unit_ * places_[v]);
  }
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    const auto& [a, b, c] = faces_[f];
    const bool alive = std::find(faces_of_[a].begin(), faces_of_[a].end(), f) != faces_of_[a].end();
    if (alive) mesh.faces.push_back({index[a], index[b], index[c]});
  }
  return mesh;
}

}  // namespace

Mesh simplified(const Mesh& mesh, std::size_t target_faces) {
  EdgeCollapse collapse(mesh);
  collapse.run(target_faces);
  return collapse.result();
}

}  // namespace salbench
