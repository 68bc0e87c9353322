// SPDX-License-Identifier: GPL-3.0-or-later
// Follows Garland and Heckbert 1997, for pairs connected by an edge. Quadrics are weighted by area, and each
// border edge adds the plane through it perpendicular to its face, which preserves the outline of an open
// mesh.
//
// The queue contains every edge once for each state of its end points; an entry whose end points have changed
// since is skipped when it comes up. A refused collapse may become possible after changes of the faces around
// it, so an empty queue is refilled until a complete round changes nothing.
//
// meshoptimizer's simplification, which keeps vertices in place, takes a fraction of the time. By every
// measure of scripts/figures fidelity on meshes, MS on its results is farther from the published maps.
#include "stages/models/simplified.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <queue>
#include <span>
#include <utility>
#include <vector>

#include "stages/geometry/mesh_ops.h"
#include "stages/models/quadric.h"

namespace salbench {
namespace {

using Index = std::int32_t;            // vertex or face
using Edge = std::pair<Index, Index>;  // ascending

constexpr double kBorderWeight = 1;  // weight of a border edge's plane, per squared length of the edge
constexpr double kEvenness = 1e-8;   // factor of an edge's squared length in its cost; decides in flat parts
constexpr double kMinCosine = 0.2;   // cosine of the angle by which one collapse may turn a face

class EdgeCollapse {
 public:
  explicit EdgeCollapse(const Mesh& mesh);
  void run(std::size_t target_faces);
  Mesh result() const;

 private:
  struct Candidate {
    Edge edge;
    std::uint32_t state_a, state_b;  // states of the end points when it was queued
    Vec3 place;                      // midpoint of the edge until the cost is known
  };

  // Small, since the queue moves entries; the candidate's edge orders equal costs.
  struct Queued {
    double cost;
    std::uint32_t candidate;
    bool is_bound;  // `cost` is only a lower bound
  };
  struct Later {
    const std::vector<Candidate>& candidates;
    bool operator()(const Queued& a, const Queued& b) const {
      if (a.cost != b.cost) return a.cost > b.cost;
      if (a.is_bound != b.is_bound) return b.is_bound;
      return candidates[a.candidate].edge > candidates[b.candidate].edge;
    }
  };

  // Distinct neighbours of a vertex along edges.
  struct Ring {
    std::vector<Index> vertices;
    bool has_border = false;  // some neighbour is on one face only
  };

  struct Listed {  // range in listed_faces_
    std::size_t first = 0, count = 0;
  };

  struct Mark {
    std::size_t round = 0;  // number of the last ring that contained it
    int faces = 0;          // faces in that ring
  };

  struct Moved {  // both ends of an edge are moved to one place
    Edge edge;
    Vec3 place;
  };

  void add_faces(const Mesh& mesh);
  void add_border_planes();
  void fill_queue();
  void push(Index a, Index b);
  void push_cost(std::uint32_t candidate);
  bool is_current(const Candidate& candidate) const;
  bool keeps_topology(const Edge& edge);
  bool doubles_a_face(const Edge& edge) const;
  bool folds(const Edge& edge, const Vec3& place) const;
  void collapse(const Edge& edge, const Vec3& place);

  const Vec3& place(Index v) const { return places_[static_cast<std::size_t>(v)]; }
  std::uint32_t state_of(Index v) const { return states_[static_cast<std::size_t>(v)]; }
  Quadric quadric_of(const Edge& edge) const {
    Quadric sum = quadrics_[static_cast<std::size_t>(edge.first)];
    return sum += quadrics_[static_cast<std::size_t>(edge.second)];
  }
  double unevenness(const Edge& edge, const Quadric& quadric) const {
    return kEvenness * quadric.weight() * (place(edge.first) - place(edge.second)).squaredNorm();
  }
  const std::array<Index, 3>& face(Index f) const { return faces_[static_cast<std::size_t>(f)]; }
  std::span<const Index> faces_of(Index v) const {
    const Listed& listed = listed_[static_cast<std::size_t>(v)];
    return {listed_faces_.data() + listed.first, listed.count};
  }
  void unlist(Index v, Index f);
  bool has(Index f, Index v) const { return face(f)[0] == v || face(f)[1] == v || face(f)[2] == v; }
  Vec3 area_vector(Index f) const {
    return doubled_area(place(face(f)[0]), place(face(f)[1]), place(face(f)[2]));
  }
  Vec3 area_vector(Index f, const Moved& moved) const;
  std::size_t faces_on(Index a, Index b) const;
  void find_ring(Index v, Ring& ring);

  static Vec3 doubled_area(const Vec3& a, const Vec3& b, const Vec3& c) { return (b - a).cross(c - a); }

  Vec3 origin_ = Vec3::Zero();
  double unit_ = 1;
  std::vector<Vec3> places_;  // from the origin, in units
  std::vector<Quadric> quadrics_;
  std::vector<std::uint32_t> states_;  // number of changes per vertex
  std::vector<std::array<Index, 3>> faces_;
  std::vector<Index> listed_faces_;  // vertex by vertex; those of a merged vertex are appended
  std::vector<Listed> listed_;       // excludes collapsed faces
  std::size_t n_faces_ = 0;
  std::vector<Candidate> candidates_;  // all that were ever queued
  std::priority_queue<Queued, std::vector<Queued>, Later> queue_{Later{candidates_}};
  Ring ring_a_, ring_b_;  // working memory, as the following
  std::vector<Mark> marks_;
  std::size_t round_ = 0;
  std::vector<Index> shared_;  // neighbours of both ends of an edge
};

EdgeCollapse::EdgeCollapse(const Mesh& mesh)
    : places_(mesh.vertices),
      quadrics_(mesh.vertices.size()),
      states_(mesh.vertices.size(), 0),
      listed_(mesh.vertices.size()),
      marks_(mesh.vertices.size()) {
  // Quadrics contain squared coordinates: far from the origin they would lose significant digits, and in
  // unsuitable units overflow.
  if (places_.empty()) return;
  origin_ = centroid(places_);
  if (const double radius = bounding_radius(places_); radius > 0) unit_ = radius;
  for (Vec3& place : places_) place = (place - origin_) / unit_;
  add_faces(mesh);
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    const Vec3 doubled = area_vector(static_cast<Index>(f));
    for (const Index v : faces_[f])
      quadrics_[static_cast<std::size_t>(v)].add_plane(doubled.normalized(), place(v), doubled.norm() / 2);
  }
  add_border_planes();
}

// Keeps the first of several faces with the same corners.
void EdgeCollapse::add_faces(const Mesh& mesh) {
  for (const Triangle& corners : mesh.faces)
    for (const Index v : corners) ++listed_[static_cast<std::size_t>(v)].count;
  std::size_t room = 0;
  for (Listed& listed : listed_) listed = {std::exchange(room, room + listed.count), 0};
  listed_faces_.resize(room);
  for (const Triangle& corners : mesh.faces) {
    const Index a = corners[0], b = corners[1], c = corners[2];  // Clang 14 captures no structured bindings
    if (a == b || b == c || c == a) continue;
    const Index least = std::ranges::min(corners, {}, [&](Index v) { return faces_of(v).size(); });
    if (std::ranges::any_of(faces_of(least), [&](Index f) { return has(f, a) && has(f, b) && has(f, c); }))
      continue;
    for (const Index v : corners) {
      Listed& listed = listed_[static_cast<std::size_t>(v)];
      listed_faces_[listed.first + listed.count++] = static_cast<Index>(faces_.size());
    }
    faces_.push_back(corners);
  }
  n_faces_ = faces_.size();
}

void EdgeCollapse::add_border_planes() {
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    const auto& corners = faces_[f];
    const Vec3 normal = area_vector(static_cast<Index>(f)).normalized();
    for (std::size_t k = 0; k < 3; ++k) {
      const Index a = corners[k], b = corners[(k + 1) % 3];
      if (faces_on(a, b) != 1) continue;
      const Vec3 edge = place(b) - place(a);
      for (const Index v : {a, b})
        quadrics_[static_cast<std::size_t>(v)].add_plane(edge.cross(normal).normalized(), place(a),
                                                         kBorderWeight * edge.squaredNorm());
    }
  }
}

void EdgeCollapse::run(std::size_t target_faces) {
  for (bool changed = true; changed && n_faces_ > target_faces;) {
    changed = false;
    fill_queue();
    while (!queue_.empty() && n_faces_ > target_faces) {
      const auto [cost, candidate, is_bound] = queue_.top();
      const Candidate next = candidates_[candidate];
      queue_.pop();
      if (!is_current(next)) continue;
      if (is_bound) {
        push_cost(candidate);
        continue;
      }
      if (!keeps_topology(next.edge) || folds(next.edge, next.place)) continue;
      collapse(next.edge, next.place);
      changed = true;
    }
  }
}

// Requires an empty queue.
void EdgeCollapse::fill_queue() {
  candidates_.clear();
  for (Index a = 0; a < static_cast<Index>(places_.size()); ++a) {
    find_ring(a, ring_a_);
    for (const Index b : ring_a_.vertices)
      if (a < b) push(a, b);
  }
}

void EdgeCollapse::push(Index a, Index b) {
  const Edge edge = std::minmax(a, b);
  const Vec3 middle = (place(edge.first) + place(edge.second)) / 2;
  candidates_.push_back({edge, state_of(edge.first), state_of(edge.second), middle});
  const auto candidate = static_cast<std::uint32_t>(candidates_.size() - 1);
  const Quadric quadric = quadric_of(edge);
  if (const auto bound = error_bound(quadric, middle))
    queue_.push({*bound + unevenness(edge, quadric), candidate, true});
  else
    push_cost(candidate);
}

// Most candidates are outdated before their turn, so expensive work is deferred until then.
void EdgeCollapse::push_cost(std::uint32_t candidate) {
  auto& [edge, state_a, state_b, place] = candidates_[candidate];
  const Quadric quadric = quadric_of(edge);
  place = optimum(quadric, place);
  queue_.push({quadric(place) + unevenness(edge, quadric), candidate, false});
}

bool EdgeCollapse::is_current(const Candidate& candidate) const {
  return state_of(candidate.edge.first) == candidate.state_a &&
         state_of(candidate.edge.second) == candidate.state_b;
}

// The link condition: a manifold surface keeps its topology. A triangle that alone connects a corner to the
// rest is kept, so that connected points remain connected.
bool EdgeCollapse::keeps_topology(const Edge& edge) {
  const auto [a, b] = edge;
  find_ring(a, ring_a_);
  find_ring(b, ring_b_);
  shared_.clear();
  for (const Index c : ring_a_.vertices)
    if (marks_[static_cast<std::size_t>(c)].round == round_) shared_.push_back(c);  // b's ring is the latest
  const std::size_t n_faces = faces_on(a, b);
  if (shared_.size() != n_faces) return false;
  if (n_faces > 1 && ring_a_.has_border && ring_b_.has_border) return false;
  for (const Index c : shared_)
    if (faces_on(a, c) == 1 && faces_on(b, c) == 1) return false;
  return !doubles_a_face(edge);
}

// True if faces (a, c, d) and (b, c, d) would coincide, for edges cd among the shared neighbours.
bool EdgeCollapse::doubles_a_face(const Edge& edge) const {
  const auto spans = [&](Index v, Index c, Index d) {
    return std::any_of(faces_of(v).begin(), faces_of(v).end(),
                       [&](Index f) { return has(f, c) && has(f, d); });
  };
  for (std::size_t i = 0; i < shared_.size(); ++i) {
    for (std::size_t j = i + 1; j < shared_.size(); ++j)
      if (spans(edge.first, shared_[i], shared_[j]) && spans(edge.second, shared_[i], shared_[j]))
        return true;
  }
  return false;
}

bool EdgeCollapse::folds(const Edge& edge, const Vec3& to) const {
  const auto turns_over = [&](Index f) {
    if (has(f, edge.first) && has(f, edge.second)) return false;  // removed by the collapse
    const Vec3 before = area_vector(f), after = area_vector(f, Moved{edge, to});
    return before.norm() > 0 && before.dot(after) <= kMinCosine * before.norm() * after.norm();
  };
  return std::any_of(faces_of(edge.first).begin(), faces_of(edge.first).end(), turns_over) ||
         std::any_of(faces_of(edge.second).begin(), faces_of(edge.second).end(), turns_over);
}

// The first vertex becomes the merged one.
void EdgeCollapse::collapse(const Edge& edge, const Vec3& to) {
  const auto [a, b] = edge;
  const auto first = static_cast<std::size_t>(a), second = static_cast<std::size_t>(b);
  places_[first] = to;
  quadrics_[first] += quadrics_[second];
  const Listed of_a = listed_[first], of_b = listed_[second];
  listed_[first] = {listed_faces_.size(), 0};
  listed_[second] = {};
  for (std::size_t k = 0; k < of_a.count; ++k) {
    const Index f = listed_faces_[of_a.first + k];
    if (!has(f, b)) listed_faces_.push_back(f);
  }
  for (std::size_t k = 0; k < of_b.count; ++k) {
    const Index f = listed_faces_[of_b.first + k];
    if (has(f, a)) {
      for (const Index v : face(f))
        if (v != a && v != b) unlist(v, f);
      --n_faces_;
    } else {
      std::ranges::replace(faces_[static_cast<std::size_t>(f)], b, a);
      listed_faces_.push_back(f);
    }
  }
  listed_[first].count = listed_faces_.size() - listed_[first].first;
  ++states_[first];
  ++states_[second];
  find_ring(a, ring_a_);
  for (const Index c : ring_a_.vertices) push(a, c);
}

void EdgeCollapse::unlist(Index v, Index f) {
  Listed& listed = listed_[static_cast<std::size_t>(v)];
  Index* const last = listed_faces_.data() + listed.first + listed.count;
  Index* const found = std::find(last - listed.count, last, f);
  if (found == last) return;
  std::copy(found + 1, last, found);  // a hub of many thousands is moved at once
  --listed.count;
}

Vec3 EdgeCollapse::area_vector(Index f, const Moved& moved) const {
  const auto corner = [&](std::size_t k) {
    const Index v = face(f)[k];
    return v == moved.edge.first || v == moved.edge.second ? moved.place : place(v);
  };
  return doubled_area(corner(0), corner(1), corner(2));
}

// Both ends list these faces: a hub of many thousands is not asked.
std::size_t EdgeCollapse::faces_on(Index a, Index b) const {
  if (faces_of(b).size() < faces_of(a).size()) std::swap(a, b);
  return static_cast<std::size_t>(
      std::count_if(faces_of(a).begin(), faces_of(a).end(), [&](Index f) { return has(f, b); }));
}

void EdgeCollapse::find_ring(Index v, Ring& ring) {
  ring.vertices.clear();
  ++round_;
  for (const Index f : faces_of(v))
    for (const Index other : face(f)) {
      if (other == v) continue;
      Mark& mark = marks_[static_cast<std::size_t>(other)];
      if (std::exchange(mark.round, round_) != round_) {
        mark.faces = 0;
        ring.vertices.push_back(other);
      }
      ++mark.faces;
    }
  ring.has_border = std::ranges::any_of(
      ring.vertices, [&](Index c) { return marks_[static_cast<std::size_t>(c)].faces == 1; });
}

Mesh EdgeCollapse::result() const {
  constexpr Index kUnused = -1;
  std::vector<Index> index(places_.size(), kUnused);
  Mesh mesh;
  for (std::size_t v = 0; v < places_.size(); ++v) {
    if (listed_[v].count == 0) continue;
    index[v] = static_cast<Index>(mesh.vertices.size());
    mesh.vertices.emplace_back(origin_ + unit_ * places_[v]);
  }
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    const auto& corners = faces_[f];
    const auto listed = faces_of(corners[0]);
    if (std::ranges::find(listed, static_cast<Index>(f)) == listed.end()) continue;
    Triangle renamed;
    for (std::size_t k = 0; k < 3; ++k) renamed[k] = index[static_cast<std::size_t>(corners[k])];
    mesh.faces.push_back(renamed);
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
