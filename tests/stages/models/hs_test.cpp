// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/models/hs.h"

#include "stages/core/field.h"
#include "stages/geometry/smoothing.h"
#include "stages/ground_truth/simulation.h"
#include "stages/matching/matching.h"
#include "stages/metrics/score.h"
#include "tests/support/shapes.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

using testing::_;

using PicksOfAll = std::vector<std::vector<std::int32_t>>;

constexpr double kUndefined = kNan;

Rng draws(std::uint64_t seed = 1) { return Rng(seed, "HS", "x"); }

GroundTruth truth_of(PicksOfAll picks) { return {{}, std::move(picks), false}; }

// As in a run: both maps matched to one reference, then scored.
GroupScorer matching_scorer(const Histogram& reference) {
  return {chosen_metrics({}).size(), [=](const ScalarField& map, const GroundTruth& others) {
            return score(matched(map, reference), {matched(others.saliency, reference), others.picks, false},
                         {}, Rng(1, "scores", "x"));
          }};
}

GroupScorer matching_scorer(const Mesh& mesh, const GroundTruth& truth) {
  return matching_scorer(normalised_histogram(smoothed_picks(mesh, truth.picks)));
}

GroundTruth simulated(const Mesh& mesh, int participants) {
  SimulationOptions options;
  options.participants = participants;
  return simulated_ground_truth(mesh, options, 3, "x");
}

// Participant k picks point k of a cloud without a surface, where a pick stays at its vertex: a group's map
// shows its members.
constexpr std::size_t kCloudSize = 23;
const Mesh kCloud{shapes::random_cloud(kCloudSize, 1), {}};

GroundTruth one_pick_each(std::size_t participants) {
  GroundTruth truth;
  for (std::size_t k = 0; k < participants; ++k) truth.picks.push_back({static_cast<std::int32_t>(k)});
  return truth;
}

struct Comparison {
  std::vector<std::size_t> group, others;
  bool operator==(const Comparison&) const = default;
};

std::vector<std::size_t> points_of(const ScalarField& map) {
  std::vector<std::size_t> points;
  for (std::size_t v = 0; v < map.size(); ++v)
    if (map[v] != 0) points.push_back(v);
  return points;
}

GroupScorer recorder(std::vector<Comparison>& comparisons) {
  return {0, [&](const ScalarField& map, const GroundTruth& others) {
            comparisons.push_back({points_of(map), points_of(others.saliency)});
            std::vector<std::size_t> picked;
            for (const std::int32_t v : picked_points(others)) picked.push_back(index(v));
            EXPECT_EQ(picked, comparisons.back().others);
            return Scores{};
          }};
}

std::vector<Comparison> comparisons_of_curve(std::size_t participants, const HsOptions& options, Rng rng) {
  std::vector<Comparison> comparisons;
  human_curve(kCloud, one_pick_each(participants), options, recorder(comparisons), rng);
  return comparisons;
}

TEST(OneAgainstRest, EqualsItsDefinition) {
  const Mesh mesh = shapes::bumpy_sphere(4);
  const GroundTruth truth = simulated(mesh, 6);
  const GroupScorer scorer = matching_scorer(mesh, truth);
  SmoothingOptions sum;
  sum.per_participant = false;
  Scores expected{.values = std::vector<double>(scorer.n_metrics),
                  .n_points = 2562,
                  .n_picks = static_cast<std::int64_t>(picked_points(truth).size())};
  for (std::size_t k = 0; k < 6; ++k) {
    GroundTruth others{{}, truth.picks, false};
    others.picks.erase(others.picks.begin() + static_cast<std::ptrdiff_t>(k));
    others.saliency = smoothed_picks(mesh, others.picks, sum);
    const Scores scores = scorer.score(smoothed_picks(mesh, PicksOfAll{truth.picks[k]}, sum), others);
    for (std::size_t m = 0; m < scorer.n_metrics; ++m) expected.values[m] += scores.values[m] / 6;
  }
  const Scores found = leave_one_out(mesh, truth, scorer);
  EXPECT_THAT(found.values, Pointwise(DoubleNear(1e-12), expected.values));
  EXPECT_EQ(found.n_points, expected.n_points);
  EXPECT_EQ(found.n_picks, expected.n_picks);
}

TEST(OneAgainstRest, OfTwoWhoPickTheSameIsPerfect) {
  const Mesh mesh = shapes::bumpy_sphere(4);
  const GroundTruth truth = truth_of({{0, 1, 2, 3}, {3, 2, 1, 0}});  // far apart: corners of the icosahedron
  const Scores scores = leave_one_out(mesh, truth, matching_scorer(mesh, truth));
  EXPECT_DOUBLE_EQ(value_of(scores, "auc_exact"), 1);
  EXPECT_NEAR(value_of(scores, "cc"), 1, 1e-12);
  EXPECT_GT(value_of(scores, "nss"), 5);
}

TEST(OneAgainstRest, AParticipantWithoutPicksScoresAsAConstantMapAndIsNotPredicted) {
  const Mesh mesh = shapes::bumpy_sphere(3);
  const GroundTruth truth = truth_of({{0, 1}, {}});
  const Scores scores = leave_one_out(mesh, truth, matching_scorer(mesh, truth));
  EXPECT_DOUBLE_EQ(value_of(scores, "auc"), 0.5);
  EXPECT_DOUBLE_EQ(value_of(scores, "auc_exact"), 0.5);
  EXPECT_EQ(value_of(scores, "nss"), 0);
  EXPECT_EQ(value_of(scores, "cc"), 0);
  EXPECT_EQ(scores.n_picks, 2);
}

TEST(OneAgainstRest, WhereNobodyPickedIsUndefined) {
  const GroundTruth truth = truth_of({{}, {}, {}});
  const GroupScorer never{3, [](const ScalarField&, const GroundTruth&) -> Scores {
                            ADD_FAILURE() << "there is nothing to predict";
                            return {};
                          }};
  const Scores scores = leave_one_out(shapes::tetrahedron(), truth, never);
  EXPECT_THAT(scores.values, AllOf(SizeIs(3), Each(IsNan())));
  const HumanCurve curve = human_curve(shapes::tetrahedron(), truth, {}, never, draws());
  ASSERT_THAT(curve, SizeIs(1));
  EXPECT_THAT(curve[0].values, AllOf(SizeIs(3), Each(IsNan())));
  EXPECT_EQ(scores.n_points, 4);
  EXPECT_EQ(scores.n_picks, 0);
}

TEST(OneAgainstRest, IsTheMeanOfEachMetricOverWhereItIsDefined) {
  int call = 0;
  const GroupScorer scorer{5, [&](const ScalarField&, const GroundTruth&) {
                             ++call;
                             return Scores{.values = {call == 2 ? kUndefined : call, kUndefined, -1.0 * call,
                                                      call == 1 ? 0.5 : kUndefined, 0}};
                           }};
  const Scores scores = leave_one_out(kCloud, one_pick_each(3), scorer);
  EXPECT_THAT(scores.values, ElementsAre(2 /* of 1 and 3 */, IsNan(), -2, 0.5, 0));
}

TEST(HumanCurve, SetsGroupsOfEverySizeAgainstEachOther) {
  const auto comparisons = comparisons_of_curve(23, {.draws = 5, .largest_group = 11}, draws());
  ASSERT_THAT(comparisons, SizeIs(5 * 11));
  for (std::size_t c = 0; c < comparisons.size(); ++c) {
    const auto& [group, others] = comparisons[c];
    EXPECT_THAT(group, SizeIs(c / 5 + 1));
    EXPECT_THAT(others, SizeIs(c / 5 + 1));
    std::set<std::size_t> both(group.begin(), group.end());
    both.insert(others.begin(), others.end());
    EXPECT_THAT(both, SizeIs(2 * (c / 5 + 1))) << "somebody is in both groups of comparison " << c;
  }
}

TEST(HumanCurve, DrawsEveryPairAlikeOften) {
  std::map<std::pair<std::size_t, std::size_t>, int> count;
  constexpr int kDraws = 12000;
  for (const auto& [group, others] : comparisons_of_curve(4, {.draws = kDraws, .largest_group = 1}, draws()))
    ++count[{group.at(0), others.at(0)}];
  EXPECT_THAT(count, SizeIs(12));
  for (const auto& [pair, n] : count)  // 1000 expected, standard deviation 30
    EXPECT_NEAR(n, kDraws / 12.0, 150) << pair.first << " against " << pair.second;
}

TEST(HumanCurve, BeginsAlikeHoweverFarItGoes) {
  const auto shorter = comparisons_of_curve(23, {.draws = 5, .largest_group = 3}, draws());
  auto longer = comparisons_of_curve(23, {.draws = 5, .largest_group = 11}, draws());
  longer.resize(shorter.size());
  EXPECT_EQ(longer, shorter);
}

TEST(HumanCurve, EndsWhereThereAreNoTwoGroupsLeft) {
  const auto length = [](std::size_t participants, std::int32_t largest_group) {
    std::vector<Comparison> comparisons;
    return human_curve(kCloud, one_pick_each(participants), {.draws = 1, .largest_group = largest_group},
                       recorder(comparisons), draws())
        .size();
  };
  EXPECT_EQ(length(2, 11), 1U);
  EXPECT_EQ(length(3, 11), 1U);
  EXPECT_EQ(length(22, 11), 11U);
  EXPECT_EQ(length(23, 11), 11U);
  EXPECT_EQ(length(21, 11), 10U);
  EXPECT_EQ(length(23, 4), 4U);
}

TEST(HumanCurve, IsTheMeanOverTheDraws) {
  std::vector<double> drawn;
  const HumanCurve curve = human_curve(kCloud, one_pick_each(4), {.draws = 3, .largest_group = 11},
                                       {1,
                                        [&](const ScalarField&, const GroundTruth&) {
                                          drawn.push_back(std::exp2(drawn.size()));
                                          return Scores{.values = {drawn.back()}};
                                        }},
                                       draws());
  ASSERT_THAT(curve, SizeIs(2));
  EXPECT_DOUBLE_EQ(curve[0].values.at(0), (1 + 2 + 4) / 3.0);
  EXPECT_DOUBLE_EQ(curve[1].values.at(0), (8 + 16 + 32) / 3.0);
  EXPECT_EQ(curve[1].n_points, 23);
  EXPECT_EQ(curve[1].n_picks, 4);
}

TEST(HumanCurve, LeavesOutDrawsAgainstPeopleWithoutPicks) {
  GroundTruth truth = one_pick_each(2);
  truth.picks.push_back({});
  std::vector<Comparison> comparisons;
  human_curve(kCloud, truth, {.draws = 60, .largest_group = 1}, recorder(comparisons), draws());
  EXPECT_GT(comparisons.size(), 20U);
  EXPECT_LT(comparisons.size(), 60U);
  int without_picks = 0;
  for (const auto& [group, others] : comparisons) {
    EXPECT_THAT(others, SizeIs(1));
    without_picks += group.empty() ? 1 : 0;
  }
  EXPECT_GT(without_picks, 0);  // kept as predictors: their map is constant
}

TEST(HumanPerformance, DoesNotApplyToFewerThanTwoParticipants) {
  const GroupScorer scorer{0, [](const ScalarField&, const GroundTruth&) { return Scores{}; }};
  GroundTruth viewer;
  viewer.viewers = {{1, 2, 3, 4}};
  for (const GroundTruth& truth : {truth_of({}), truth_of({{0, 1, 2}}), viewer}) {
    EXPECT_THAT([&] { leave_one_out(shapes::tetrahedron(), truth, scorer); }, Refuses("HS does not apply"));
    EXPECT_THAT([&] { human_curve(shapes::tetrahedron(), truth, {}, scorer, draws()); },
                Refuses("HS does not apply"));
  }
}

// --- viewers with maps
// --------------------------------------------------------------------------------------

// Records what is compared, without matching and picks.
GroupScorer recorder_of_maps(std::vector<std::pair<ScalarField, ScalarField>>& compared) {
  return {1, [&](const ScalarField& map, const GroundTruth& others) {
            compared.emplace_back(map, others.saliency);
            return Scores{.values = {map[0]}};
          }};
}

GroundTruth truth_of_viewers(std::vector<ScalarField> viewers) {
  GroundTruth truth;
  truth.saliency = viewers[0];
  truth.viewers = std::move(viewers);
  return truth;
}

TEST(Viewers, EachIsComparedWithTheMeanOfTheOthersWhereTheySaw) {
  const Mesh mesh = shapes::tetrahedron();
  const GroundTruth truth =
      truth_of_viewers({{1, 0, 4, 0}, {2, kUndefined, 6, 0}, {6, kUndefined, kUndefined, 9}});
  std::vector<std::pair<ScalarField, ScalarField>> compared;
  const Scores scores = leave_one_out(mesh, truth, recorder_of_maps(compared));
  ASSERT_THAT(compared, SizeIs(3));
  EXPECT_EQ(compared[0].first, truth.viewers[0]);
  EXPECT_THAT(compared[0].second, ElementsAre(4, IsNan(), 6, 4.5));
  EXPECT_THAT(compared[1].first, ElementsAre(2, IsNan(), 6, 0));
  EXPECT_THAT(compared[1].second, ElementsAre(3.5, 0, 4, 4.5));
  EXPECT_THAT(compared[2].second, ElementsAre(1.5, 0, 5, 0));
  EXPECT_THAT(scores.values, ElementsAre(3));
  EXPECT_EQ(scores.n_points, 4);
  EXPECT_EQ(scores.n_picks, 0);
}

TEST(Viewers, HaveAHumanCurve) {
  const Mesh mesh = shapes::tetrahedron();
  const GroundTruth truth = truth_of_viewers({{1, 0, 4, 0}, {2, 1, 6, 0}, {6, 1, 1, 9}, {0, 1, 2, 3}});
  std::vector<std::pair<ScalarField, ScalarField>> compared;
  EXPECT_THAT(human_curve(mesh, truth, {}, recorder_of_maps(compared), draws()), SizeIs(2));
}

TEST(Viewers, WithPicksAreComparedByTheirMapsAndScoredAtThePicksOfTheOthers) {
  const std::vector<ScalarField> maps = {{1, 0, 4, 0}, {2, 1, 6, 0}, {6, 1, 1, 9}};
  GroundTruth truth = truth_of_viewers(maps);
  truth.picks = {{0}, {}, {2, 3}};
  std::vector<std::pair<ScalarField, PicksOfAll>> compared;
  const GroupScorer scorer{1, [&](const ScalarField& map, const GroundTruth& others) {
                             compared.emplace_back(map, others.picks);
                             return Scores{.values = {map[0]}};
                           }};
  EXPECT_EQ(leave_one_out(shapes::tetrahedron(), truth, scorer).n_picks, 3);
  EXPECT_THAT(compared, ElementsAre(testing::Pair(maps[0], PicksOfAll{{}, {2, 3}}),
                                    testing::Pair(maps[1], PicksOfAll{{0}, {2, 3}}),
                                    testing::Pair(maps[2], PicksOfAll{{}, {0}})));

  truth.picks.emplace_back();  // other people than those with maps
  compared.clear();
  leave_one_out(shapes::tetrahedron(), truth, scorer);
  ASSERT_THAT(compared, SizeIs(4));
  EXPECT_NE(compared[0].first, maps[0]);
}

TEST(Participants, WhatNobodySawIsNotCompared) {
  const Mesh mesh = shapes::tetrahedron();
  GroundTruth truth = truth_of({{0}, {1}});
  truth.saliency = {1, 1, kUndefined, 0};
  std::vector<std::pair<ScalarField, ScalarField>> compared;
  leave_one_out(mesh, truth, recorder_of_maps(compared));
  ASSERT_THAT(compared, SizeIs(2));
  for (const auto& [map, others] : compared) EXPECT_THAT(others, ElementsAre(_, _, IsNan(), _));
}

}  // namespace
}  // namespace salbench
