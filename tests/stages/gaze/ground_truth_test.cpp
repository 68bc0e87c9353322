// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/gaze/ground_truth.h"

#include "stages/geometry/faces.h"
#include "stages/geometry/mesh_ops.h"
#include "tests/stages/gaze/integral.h"
#include "tests/support/recordings.h"
#include "tests/support/shapes.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

class GazeTruth : public testing::Test {
 protected:
  GazeHits hits() const { return hits_of(mesh_, fixations_of(recording_, mesh_, {}), {}); }
  GroundTruth truth(const GazeTruthOptions& options = {}) const {
    return gaze_ground_truth(mesh_, hits(), nullptr, options);
  }

  const Mesh mesh_ = shapes::bumpy_sphere(3);
  GazeRecording recording_ = toy_recording(mesh_, 4);
};

TEST_F(GazeTruth, FixationsAreThoseOfEachPersonAlone) {
  const GazeFixations found = fixations_of(recording_, mesh_, {});
  EXPECT_THAT(found.people.names, ElementsAre("P1", "P2", "P3", "P4"));
  EXPECT_THAT(found.people.samples, Each(90));
  EXPECT_THAT(found.people.lost, Each(0));
  EXPECT_TRUE(std::ranges::is_sorted(found.person));
  EXPECT_GE(found.start.size(), 4U * 5);  // two rests may be on one vertex
  EXPECT_LE(found.start.size(), 4U * 6);
}

TEST_F(GazeTruth, IsTheMeanOverPeopleOfDensitiesWithOneIntegral) {
  const GroundTruth of_all = truth();
  ASSERT_THAT(of_all.viewers, SizeIs(4));
  for (const ScalarField& own : of_all.viewers) EXPECT_NEAR(integral(mesh_, own), 1, 1e-9);
  EXPECT_NEAR(integral(mesh_, of_all.saliency), 1, 1e-9);
  for (std::size_t v = 0; v < mesh_.vertices.size(); ++v)
    EXPECT_NEAR(
        of_all.saliency[v],
        (of_all.viewers[0][v] + of_all.viewers[1][v] + of_all.viewers[2][v] + of_all.viewers[3][v]) / 4,
        1e-12);
  EXPECT_TRUE(of_all.picks.empty());
}

TEST_F(GazeTruth, MayWeighPeopleByTheirTimeOnTheShape) {
  const GazeHits all = hits();
  const GroundTruth pooled = truth({.weight = GazeWeight::mass});
  double mass = 0;
  for (std::size_t i = 0; i < all.face.size(); ++i)
    if (all.face[i] >= 0) mass += all.duration[i];
  EXPECT_NEAR(integral(mesh_, pooled.saliency), mass / 4, 1e-6);
  const GroundTruth counted = truth({.mass = GazeMass::one, .weight = GazeWeight::mass});
  EXPECT_NEAR(integral(mesh_, counted.saliency),
              static_cast<double>(std::ranges::count_if(all.face, [](auto face) { return face >= 0; })) / 4,
              1e-9);
}

TEST_F(GazeTruth, SomebodyWhoLookedElsewhereHasNoDensityAndCountsForNothing) {
  const GroundTruth before = truth();
  recording_.people.emplace_back("P5");
  for (int k = 0; k < 150; ++k) {
    recording_.person.push_back(4);
    recording_.time.push_back(k * 10);
    recording_.valid.push_back(1);
    recording_.origins.emplace_back(0, 0, 9);
    recording_.directions.emplace_back(0, 0, 1);
  }
  const GroundTruth after = truth();
  EXPECT_THAT(after.viewers, SizeIs(4));
  EXPECT_EQ(after.saliency, before.saliency);
  EXPECT_THAT(remark_on_people(hits(), mesh_),
              StartsWith("1 of 5 people have no fixation on the shape: P5 (0 of 1)"));
}

TEST_F(GazeTruth, PeopleWhoWereHardlyTrackedAreLeftOut) {
  // P1 lost more than half, marked; P2 has 0.4 s of rows; P3 lost more than half, as missing rows.
  GazeRecording rows = recording_;
  rows.person = {}, rows.time = {}, rows.valid = {}, rows.origins = {}, rows.directions = {};
  for (std::size_t i = 0; i < recording_.person.size(); ++i) {
    const std::int32_t person = recording_.person[i];
    const std::size_t own = i % 90;
    if ((person == 1 && own >= 24) || (person == 2 && own >= 24 && own < 80)) continue;
    rows.person.push_back(person);
    rows.time.push_back(recording_.time[i]);
    rows.valid.push_back(person != 0 || own < 36 ? 1 : 0);
    rows.origins.push_back(recording_.origins[i]);
    rows.directions.push_back(recording_.directions[i]);
  }
  const GroundTruth whole = truth();
  recording_ = rows;
  const GazePeople people = hits().people;
  EXPECT_THAT(people.recorded, Pointwise(DoubleNear(1e-9), {1500.0, 400.0, 1500.0, 1500.0}));
  EXPECT_THAT(people.tracked, Pointwise(DoubleNear(1e-9), {600.0, 400.0, 34000.0 / 60, 1500.0}));
  EXPECT_THAT(left_out_people(people, {}), ElementsAre("lost 60 %", "tracked for 0.4 s", "lost 62 %", ""));
  EXPECT_THAT(remark_on_left_out(people, {}), StartsWith("3 of 4 people are left out: P1 (lost 60 %), P2"));
  const GroundTruth one = truth();
  ASSERT_THAT(one.viewers, SizeIs(1));
  EXPECT_EQ(one.saliency, whole.viewers[3]);
  EXPECT_THAT(truth({.people = {.most_lost = 1}, .picks = GazePicks::fixations}).picks, SizeIs(3));
  EXPECT_THAT(truth({.people = {.most_lost = 1, .least_seconds = 0}}).viewers, SizeIs(4));
  EXPECT_THAT([&] { truth({.people = {.most_lost = 0, .least_seconds = 2}}); },
              ThrowsMessage<InputError>(HasSubstr("write gaze: {most_lost: 1, least_seconds: 0}")));
}

TEST_F(GazeTruth, PeopleWhoseFixationsHoldLittleOfTheirTimeAreNamed) {
  Rng rng(3, "noise", "item");
  for (std::size_t i = 0; i < 90; ++i)
    recording_.directions[i] =
        (recording_.directions[i] + 0.02 * Vec3(rng.normal(), rng.normal(), rng.normal())).normalized();
  EXPECT_THAT(remark_on_people(hits(), mesh_),
              testing::MatchesRegex(
                  "1 of 4 people have fixations in less than half of the time .*: P1 .*velocity.*"));
}

TEST_F(GazeTruth, TimesOfNoEyeTrackerLeaveThePersonWithoutAFixation) {
  for (std::size_t i = 0; i < 90; ++i) recording_.time[i] *= 1000;
  const GazeFixations found = fixations_of(recording_, mesh_, {});
  EXPECT_EQ(std::ranges::count(found.person, 0), 0);
  EXPECT_THAT(truth().viewers, SizeIs(3));
  for (std::size_t i = 90; i < recording_.time.size(); ++i) recording_.time[i] *= 1000;
  EXPECT_THAT([&] { hits(); }, ThrowsMessage<InputError>(StartsWith("P1: samples are 16666.7 ms")));
}

TEST_F(GazeTruth, AnotherUnitLeavesNobodyOnTheShape) {
  for (Vec3& eye : recording_.origins) eye *= 1000;
  EXPECT_THAT(remark_on_people(hits(), mesh_), StartsWith("4 of 4 people have no fixation on the shape"));
  EXPECT_THAT([&] { truth(); }, Refuses("4 people", "unit"));
}

TEST_F(GazeTruth, AnotherUnitMayPutTheEyesIntoTheShape) {
  EXPECT_EQ(remark_on_people(hits(), mesh_), "");
  for (Vec3& eye : recording_.origins) eye /= 1000;
  EXPECT_THAT(remark_on_people(hits(), mesh_),
              AllOf(StartsWith("4 of 4 people look from inside the shape"), HasSubstr("unit")));
  Mesh room = mesh_;  // faces inwards
  for (Triangle& face : room.faces) std::swap(face[0], face[1]);
  EXPECT_EQ(remark_on_people(hits_of(room, fixations_of(recording_, room, {}), {}), room), "");
}

TEST_F(GazeTruth, WithoutAFixationItSaysWhy) {
  std::ranges::fill(recording_.valid, std::uint8_t{0});
  EXPECT_THAT([&] { truth(); }, Refuses("4 of 4 people are left out: P1 (lost 100 %)"));
}

TEST_F(GazeTruth, FixationsMayBePicksOfTheNearestCorners) {
  const GroundTruth picked = truth({.picks = GazePicks::fixations});
  ASSERT_THAT(picked.picks, SizeIs(4));
  const GazeHits all = hits();
  std::size_t i = 0;
  for (const auto& own : picked.picks)
    for (const std::int32_t vertex : own) {
      while (all.face[i] < 0) ++i;
      const Triangle& face = mesh_.faces[index(all.face[i])];
      const FirstHit hit{static_cast<std::uint32_t>(all.face[i]), all.weights[i], all.depth[i]};
      const auto distance = [&](std::int32_t corner) {
        return (mesh_.vertices[index(corner)] - hit.point_in(mesh_)).norm();
      };
      EXPECT_EQ(std::ranges::count(face, vertex), 1);
      for (const std::int32_t corner : face) EXPECT_LE(distance(vertex), distance(corner));
      ++i;
    }
}

TEST_F(GazeTruth, AtVerticesWithoutAFaceItIsUnknown) {
  Mesh more = mesh_;
  more.vertices.emplace_back(0, 0, 0);
  const GroundTruth found = gaze_ground_truth(more, hits_of(more, fixations_of(recording_, more, {}), {}),
                                              nullptr, {.weight = GazeWeight::mass});
  EXPECT_THAT(found.saliency.back(), IsNan());
  for (const ScalarField& own : found.viewers) EXPECT_THAT(own.back(), IsNan());
  EXPECT_FALSE(std::isnan(found.saliency.front()));
}

TEST_F(GazeTruth, OfFacesIsTheMeanOfTheirCorners) {
  const GroundTruth of_faces = gaze_face_truth(mesh_, hits(), nullptr, {});
  const ScalarField areas = face_areas(mesh_.vertices, mesh_.faces);
  ASSERT_EQ(of_faces.saliency.size(), mesh_.faces.size());
  EXPECT_NEAR(std::inner_product(areas.begin(), areas.end(), of_faces.saliency.begin(), 0.0), 1, 1e-9);
}

TEST_F(GazeTruth, WhatCouldNotBeSeenIsNotCompared) {
  const GazeFixations found = fixations_of(recording_, mesh_, {});
  const VisibleShares visible = visible_shares(mesh_, found);
  const Vec3 centre = centroid(mesh_.vertices);
  for (std::size_t person = 0; person < 4; ++person) {
    const Vec3 towards = (recording_.origins[person * 90] - centre).normalized();
    for (std::size_t v = 0; v < visible.n; ++v) {  // away from the outline, where bumps decide
      const double facing = (mesh_.vertices[v] - centre).normalized().dot(towards);
      const float share = visible.shares[person * visible.n + v];
      EXPECT_TRUE(facing < 0.8 || share == 1) << v;
      EXPECT_TRUE(facing > -0.5 || share == 0) << v;
    }
  }
  const GroundTruth divided = gaze_ground_truth(mesh_, hits(), &visible, {});
  const GroundTruth plain = truth();
  for (std::size_t v = 0; v < visible.n; ++v)
    for (std::size_t person = 0; person < 4; ++person) {
      const float share = visible.shares[person * visible.n + v];
      const double value = divided.viewers[person][v];
      EXPECT_TRUE(share < 1 || value == plain.viewers[person][v]);
      EXPECT_EQ(share == 0, std::isnan(value));
    }
}

// A looks ten times as long as B, and each sees one of two equal faces: neither face is more interesting.
TEST(VisibleMass, IsDividedByAndNotTheNumberOfPeople) {
  const Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 0, 0}, {6, 0, 0}, {5, 1, 0}}, {{0, 1, 2}, {3, 4, 5}}};
  const GazeRecording recording{.people = {"A", "B"},
                                .person = {0, 1},
                                .time = {0, 0},
                                .valid = {1, 1},
                                .points = {{0.2, 0.3, 0}, {5.2, 0.3, 0}},
                                .durations = {1000, 100}};
  const GazeHits hits = hits_of(mesh, fixations_of(recording, mesh, {}), {});
  VisibleShares visible{.n = 6, .shares = {1, 1, 0.5, 0, 0, 0, 0, 0, 0, 1, 1, 0.5}};
  const GazeTruthOptions options{.density = {.radius = 0.3}, .weight = GazeWeight::mass};
  const GroundTruth truth = gaze_ground_truth(mesh, hits, &visible, options);
  for (std::size_t v = 0; v < 3; ++v) {
    EXPECT_NEAR(truth.saliency[v + 3] / truth.saliency[v], 1, 1e-9);
    EXPECT_NEAR(truth.viewers[1][v + 3] / truth.viewers[0][v], 1, 1e-9);
  }
  visible.shares.assign(12, 1);
  const ScalarField all_seen = gaze_ground_truth(mesh, hits, &visible, options).saliency;
  EXPECT_THAT(all_seen,
              Pointwise(DoubleNear(1e-9), gaze_ground_truth(mesh, hits, nullptr, options).saliency));
}

TEST_F(GazeTruth, EyesThatAreNearEachOtherCountAsOne) {
  GazeRecording moved = recording_;
  for (std::size_t i = 0; i < moved.origins.size(); ++i)
    moved.origins[i] *= 1 + 0.001 * static_cast<double>(i % 3);
  const VisibleShares a = visible_shares(mesh_, fixations_of(recording_, mesh_, {}));
  const VisibleShares b = visible_shares(mesh_, fixations_of(moved, mesh_, {}));
  std::size_t other = 0;
  for (std::size_t i = 0; i < a.shares.size(); ++i) other += a.shares[i] != b.shares[i];
  EXPECT_LT(other, a.shares.size() / 100);
}

TEST(NearestCorner, OfALongFaceIsNotTheOneOfTheLargestWeight) {
  const Mesh mesh{{{0, 0, 0}, {10, 0, 0}, {-1, 3, 0}}, {{0, 1, 2}}};
  const GazeRecording recording{.people = {"A"},
                                .person = {0},
                                .time = {0},
                                .valid = {1},
                                .points = {{4, 0.75, 0}},  // weights 0.325, 0.425, 0.25
                                .durations = {100}};
  const GazeHits hits = hits_of(mesh, fixations_of(recording, mesh, {}), {});
  EXPECT_GT(hits.weights[0][1], hits.weights[0][0]);
  const GazeTruthOptions options{.density = {.radius = 0.1}, .picks = GazePicks::fixations};
  EXPECT_THAT(gaze_ground_truth(mesh, hits, nullptr, options).picks, ElementsAre(ElementsAre(0)));
}

// --- places on the surface --------------------------------------------------------------------------------

TEST(RecordedHits, RecordedPlacesMoveToTheNearestPointOfTheSurface) {
  const Mesh mesh = shapes::grid(10);
  GazeRecording recording{.people = {"A", "B"},
                          .person = {0, 0, 1, 1},
                          .time = {0, 100, 0, 50},
                          .valid = {1, 1, 1, 0},
                          .points = {{0.31, 0.42, 0.01}, {0.5, 0.5, 3}, {0.77, 0.11, 0}, {9, 9, 9}},
                          .durations = {80, 90, 70, 0}};
  const GazeFixations found = fixations_of(recording, mesh, {});
  EXPECT_THAT(found.duration, ElementsAre(80, 90, 70));
  EXPECT_THAT(found.people.lost, ElementsAre(0, 1));
  const GazeHits hits = hits_of(mesh, found, {});
  const FirstHit first{static_cast<std::uint32_t>(hits.face[0]), hits.weights[0], 0};
  EXPECT_LT((first.point_in(mesh) - Vec3(0.31, 0.42, 0)).norm(), 1e-12);
  EXPECT_EQ(hits.face[1], -1);
  EXPECT_THAT(hits.depth, Each(IsNan()));
  EXPECT_THAT([&] { gaze_ground_truth(mesh, hits, nullptr, {}); }, Refuses("set `radius`"));
  const GroundTruth truth = gaze_ground_truth(mesh, hits, nullptr, {.density = {.radius = 0.1}});
  EXPECT_NEAR(integral(mesh, truth.saliency), 1, 1e-9);
  EXPECT_THROW(visible_shares(mesh, found), InputError);
}

TEST(RecordedHits, HitsWithoutADurationLastToTheNextSample) {
  const Mesh mesh = shapes::grid(10);
  const GazeRecording recording{.people = {"A"},
                                .person = {0, 0, 0, 0},
                                .time = {0, 10, 25, 500},
                                .valid = {1, 0, 1, 1},
                                .points = std::vector<Vec3>(4, Vec3::Zero())};
  EXPECT_THAT(fixations_of(recording, mesh, {}).duration, ElementsAre(10, 15, 15));
  FixationOptions later;
  later.skip_ms = 20;
  later.skip_first = true;
  EXPECT_THAT(fixations_of(recording, mesh, later).start, ElementsAre(500));
}

TEST(RecordedHits, WithAnEyeBecomeFixations) {
  const Mesh mesh = shapes::grid(10);
  GazeRecording recording{.people = {"A"}};
  for (int i = 0; i < 40; ++i) {
    recording.person.push_back(0);
    recording.time.push_back(i * 10);
    recording.valid.push_back(1);
    recording.origins.emplace_back(0.5, 0.5, 1);
    recording.points.emplace_back(i < 20 ? 0.3 : 0.8, 0.5, 0);
  }
  const GazeFixations found = fixations_of(recording, mesh, {});
  EXPECT_THAT(found.duration, ElementsAre(190, 190));
  ASSERT_THAT(found.points, SizeIs(2));
  EXPECT_LT((found.points[1] - Vec3(0.8, 0.5, 0)).norm(), 1e-12);
  EXPECT_TRUE(found.directions.empty());
  const GazeHits hits = hits_of(mesh, found, {});
  EXPECT_THAT(hits.depth, Pointwise(DoubleNear(1e-9), {std::hypot(0.2, 1), std::hypot(0.3, 1)}));
}

TEST(RecordedHits, LooksWithoutADurationAreSaidToHaveNone) {
  const Mesh mesh = shapes::grid(10);
  GazeRecording recording{.people = {"A", "B", "C"},
                          .person = {0, 1, 2},
                          .time = {0, 0, 0},
                          .valid = {1, 1, 1},
                          .points = std::vector<Vec3>(3, mesh.vertices[5])};
  const auto remark = [&] {
    return remark_on_people(hits_of(mesh, fixations_of(recording, mesh, {}), {}), mesh);
  };
  EXPECT_THAT(remark(), StartsWith("3 of 3 people have only fixations of 0 ms on the shape: A (0 ms), B"));
  const GazeHits hits = hits_of(mesh, fixations_of(recording, mesh, {}), {});
  GazeTruthOptions options{.density = {.radius = 0.1}};
  EXPECT_THAT([&] { gaze_ground_truth(mesh, hits, nullptr, options); }, Refuses("gaze: {mass: one}"));
  options.mass = GazeMass::one;
  EXPECT_NEAR(integral(mesh, gaze_ground_truth(mesh, hits, nullptr, options).saliency), 1, 1e-9);
  recording.durations = {0, 50, 50};
  recording.points[2] = {0, 0, 99};
  EXPECT_THAT(remark(),
              AllOf(HasSubstr("no fixation on the shape: C (0 of 1)"), HasSubstr("0 ms on the shape: A")));
}

TEST(RecordedHits, BadSamplesAreNamedWithTheirPerson) {
  GazeRecording recording{.people = {"A", "B"},
                          .person = {0, 1, 1},
                          .time = {0, 20, 10},
                          .valid = {1, 1, 1},
                          .origins = std::vector<Vec3>(3, Vec3::Zero()),
                          .directions = std::vector<Vec3>(3, Vec3::UnitX())};
  EXPECT_THAT([&] { fixations_of(recording, shapes::grid(2), {}); }, Refuses("B, sample 2: "));
}

}  // namespace
}  // namespace salbench
