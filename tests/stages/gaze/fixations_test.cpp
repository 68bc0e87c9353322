// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/gaze/fixations.h"

#include "stages/core/rng.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

// Direction at these degrees to the right and upwards.
Vec3 looking(double right, double up = 0) {
  return Vec3(std::tan(right * kRadiansPerDegree), std::tan(up * kRadiansPerDegree), 1).normalized();
}

struct Signal {
  double hertz, noise = 0;  // degrees, root mean square
  std::vector<GazeSample> samples = {};
  std::vector<std::array<double, 2>> fixations = {};  // first and last time, ms
  Vec3 at = Vec3::UnitZ();
  double right = 0;
  Rng rng{5, "signal", "item"};

  void add(double angle) {
    const double each = noise / std::sqrt(2.0);
    const double time = 1000 * static_cast<double>(samples.size()) / hertz;
    samples.push_back({time, Vec3::Zero(), looking(angle + each * rng.normal(), each * rng.normal())});
  }
  void fixate(double ms) {
    const double start = 1000 * static_cast<double>(samples.size()) / hertz;
    for (double time = 0; time <= ms; time += 1000 / hertz) add(right);
    fixations.push_back({start, samples.back().time});
  }
  void saccade(double degrees) {  // 200 degrees/s
    for (double moved = 200 / hertz; moved < degrees; moved += 200 / hertz) add(right + moved);
    right += degrees;
  }
};

Signal signal_of(double hertz, double noise) {
  Signal signal{hertz, noise};
  for (const double degrees : {7.0, 12.0, 5.0, 20.0, 9.0, 6.0}) {
    signal.fixate(180 + 20 * degrees);
    signal.saccade(degrees);
  }
  signal.fixate(300);
  return signal;
}

TEST(Fixations, ThoseOfASignalAreFoundToOneSample) {
  for (const double hertz : {60.0, 120.0})
    for (const double noise : {0.0, 0.2})
      for (const auto method : {FixationMethod::ivt, FixationMethod::idt}) {
        SCOPED_TRACE(testing::Message() << hertz << " Hz, noise " << noise << ", " << name_of(method));
        const Signal signal = signal_of(hertz, noise);
        const auto found = fixations(signal.samples, {.method = method});
        ASSERT_THAT(found, SizeIs(signal.fixations.size()));
        double angle = 0;
        for (std::size_t i = 0; i < found.size(); ++i) {
          const double sample = 1000 / hertz + 1e-6;
          EXPECT_NEAR(found[i].start, signal.fixations[i][0], sample);
          EXPECT_NEAR(found[i].start + found[i].duration, signal.fixations[i][1], sample);
          EXPECT_LT((found[i].direction - looking(angle)).norm(),
                    (0.1 + noise / 2) * kRadiansPerDegree + (method == FixationMethod::idt ? 0.05 : 0));
          angle += std::array{7.0, 12.0, 5.0, 20.0, 9.0, 6.0, 0.0}[i];
        }
      }
}

// Reference for I-VT: runs of slow samples that last long enough.
TEST(Fixations, WithoutMergingAreTheRunsOfSlowSamples) {
  const Signal signal = signal_of(120, 0.1);
  const auto& samples = signal.samples;
  const FixationOptions options{.min_ms = 50, .merge_ms = 0};
  std::vector<std::array<double, 2>> expected;
  for (std::size_t first = 0, last = 0; first < samples.size(); first = last + 1) {
    const auto velocity = [&](std::size_t i) {
      return std::acos(std::min(1.0, samples[i].direction.dot(samples[i + 1].direction))) /
             kRadiansPerDegree / (samples[i + 1].time - samples[i].time) * 1000;
    };
    for (last = first; last + 1 < samples.size() && velocity(last) <= options.velocity;) ++last;
    if (samples[last].time - samples[first].time >= options.min_ms)
      expected.push_back({samples[first].time, samples[last].time});
  }
  std::vector<std::array<double, 2>> found;
  for (const Fixation& fixation : fixations(samples, options))
    found.push_back({fixation.start, fixation.start + fixation.duration});
  EXPECT_GT(found.size(), 5U);
  EXPECT_EQ(found, expected);
}

// Times are floating-point numbers: differences of some of these are less than 100 by 1e-11.
TEST(Fixations, OfTheLeastDurationAreFoundWhereverTheyBegin) {
  for (const auto method : {FixationMethod::ivt, FixationMethod::idt})
    for (const double min_ms : {100.0, 100.001}) {
      std::vector<GazeSample> samples;
      for (int i = 0; i < 200 * 7; ++i)  // 200 looks at 60 Hz
        samples.push_back({.time = 1000.0 * i / 60, .direction = looking(i / 7 % 2 * 20)});
      EXPECT_THAT(fixations(samples, {.method = method, .min_ms = min_ms}), SizeIs(min_ms > 100 ? 0 : 200));
    }
}

TEST(Fixations, GoOnOverABlinkThatIsShortEnough) {
  Signal signal{100};
  signal.fixate(500);
  for (std::size_t i = 20; i < 27; ++i) signal.samples[i].valid = false;  // 80 ms from 19 to 27
  EXPECT_THAT(fixations(signal.samples), SizeIs(2));
  for (const auto method : {FixationMethod::ivt, FixationMethod::idt}) {
    const auto found = fixations(signal.samples, {.method = method, .merge_ms = 80});
    ASSERT_THAT(found, SizeIs(1));
    EXPECT_EQ(found[0].samples, 44);
    EXPECT_EQ(found[0].duration, 500);
  }
  for (std::size_t i = 27; i < signal.samples.size(); ++i) signal.samples[i].direction = looking(0.6);
  EXPECT_THAT(fixations(signal.samples, {.merge_ms = 80}), SizeIs(2)) << "it came back elsewhere";
  EXPECT_THAT(fixations(signal.samples, {.merge_ms = 80, .merge_degrees = 0.7}), SizeIs(1));
}

// Rows that a tracker omits, and rows that it marks as lost.
TEST(Fixations, AreTheSameWhetherLostRowsAreMarkedOrMissing) {
  for (const auto method : {FixationMethod::ivt, FixationMethod::idt, FixationMethod::none})
    for (const std::size_t rows : {1U, 5U, 20U, 200U}) {
      SCOPED_TRACE(testing::Message() << name_of(method) << ", " << rows << " rows");
      Signal signal{120, 0.1};
      signal.fixate(1000);
      signal.right += 0.4;  // slow enough to continue over a long gap
      signal.fixate(3000);
      std::vector<GazeSample> missing = signal.samples;
      for (std::size_t i = 115; i < 115 + rows; ++i) signal.samples[i].valid = false;
      missing.erase(missing.begin() + 115, missing.begin() + 115 + static_cast<std::ptrdiff_t>(rows));
      const auto expected = fixations(signal.samples, {.method = method});
      const auto found = fixations(missing, {.method = method});
      ASSERT_EQ(found.size(), expected.size());
      for (std::size_t i = 0; i < found.size(); ++i) {
        EXPECT_EQ(found[i].start, expected[i].start);
        EXPECT_NEAR(found[i].duration, expected[i].duration, 1e-9);
        EXPECT_EQ(found[i].direction, expected[i].direction);
      }
    }
}

TEST(Fixations, EndWhereTheRecordingPauses) {
  Signal signal{120};
  signal.fixate(1000);
  signal.fixate(1000);
  for (std::size_t i = 121; i < signal.samples.size(); ++i) signal.samples[i].time += 600000;
  for (const auto method : {FixationMethod::ivt, FixationMethod::idt})
    EXPECT_THAT(fixations(signal.samples, {.method = method, .merge_ms = 0}), SizeIs(2));
}

TEST(Fixations, OfSamplesLastToTheNext) {
  std::vector<GazeSample> samples(5);
  for (std::size_t i = 0; i < 5; ++i) samples[i].time = std::array{0.0, 10.0, 24.0, 60.0, 70.0}[i];
  samples[1].valid = false;
  const auto lengths = [&](double most) {
    std::vector<double> found;
    for (const Fixation& one : fixations(samples, {.method = FixationMethod::none, .merge_ms = most}))
      found.push_back(one.duration);
    return found;
  };
  EXPECT_THAT(lengths(75), ElementsAre(10, 14, 10, 10)) << "the median step is 14 ms; 36 ms are a hole";
  EXPECT_THAT(lengths(12), ElementsAre(10, 12, 10, 10)) << "no more than a gap that may be";
  EXPECT_EQ(fixations(std::vector{samples[0]}, {.method = FixationMethod::none})[0].duration, 0);
}

// An eye that orbits a place, or a rotating shape in front of it: both are equal in the shape's frame.
TEST(Fixations, FollowAPlaceThatTurns) {
  for (const auto method : {FixationMethod::ivt, FixationMethod::idt}) {
    std::vector<GazeSample> samples;
    const Vec3 places[] = {{0.2, 0.1, 0.9}, {-0.3, 0, 0.8}};
    for (std::size_t i = 0; i < 120; ++i) {
      const double angle = 60 * kRadiansPerDegree * static_cast<double>(i) / 120;
      GazeSample& sample = samples.emplace_back(1000 * static_cast<double>(i) / 120);
      sample.origin = 4 * Vec3(std::sin(angle), 0, std::cos(angle));
      sample.place = places[i / 60];
      sample.direction = (sample.place - sample.origin).normalized();
    }
    const auto found = fixations(samples, {.method = method});
    ASSERT_THAT(found, SizeIs(2));
    for (std::size_t k = 0; k < 2; ++k) {
      EXPECT_EQ(found[k].samples, 60);
      EXPECT_LT((found[k].place - places[k]).norm(), 1e-12);
      EXPECT_LT(found[k].direction.cross(places[k] - found[k].origin).norm(), 1e-12);
    }
    for (GazeSample& sample : samples) sample.place.x() = NAN;
    EXPECT_THAT(fixations(samples, {.method = method}), Not(SizeIs(2))) << "by directions alone";
  }
}

TEST(Fixations, TimesOfNoEyeTrackerAreRefusedWithTheUnitThatWouldFit) {
  const auto with_step = [](double step, FixationMethod method) {
    std::vector<GazeSample> samples(5);
    for (std::size_t i = 0; i < 5; ++i) samples[i].time = step * static_cast<double>(i);
    return [=] { fixations(samples, {.method = method}); };
  };
  for (const auto method : {FixationMethod::ivt, FixationMethod::idt}) {
    for (const auto& [step, unit] : {std::pair(8333.0, " us"), {8.3e6, " ns"}, {0.0083, " s"}})
      EXPECT_THAT(with_step(step, method), ThrowsMessage<InputError>(testing::EndsWith(unit)));
    for (const double step : {0.3, 200.0}) EXPECT_NO_THROW(with_step(step, method)());
  }
  EXPECT_NO_THROW(with_step(8333, FixationMethod::none)());
}

TEST(Fixations, OfTheBeginningAreLeftOut) {
  const Signal signal = signal_of(120, 0);
  const auto all = fixations(signal.samples);
  auto later = fixations(signal.samples, {.skip_first = true});
  EXPECT_EQ(later.at(0).start, all[1].start);
  later = fixations(signal.samples, {.skip_ms = 200});
  EXPECT_NEAR(later[0].start, 200, 1000.0 / 120);
  EXPECT_EQ(later[1].start, all[1].start);
  EXPECT_THAT(fixations(signal.samples, {.skip_ms = 1e6}), IsEmpty());
}

TEST(Fixations, OfNothingAreNone) {
  for (const auto method : {FixationMethod::ivt, FixationMethod::idt, FixationMethod::none}) {
    EXPECT_THAT(fixations({}, {.method = method, .skip_first = true}), IsEmpty());
    std::vector<GazeSample> lost(9);
    for (std::size_t i = 0; i < 9; ++i) lost[i] = {static_cast<double>(i), Vec3::Zero(), Vec3::Zero(), false};
    EXPECT_THAT(fixations(lost, {.method = method}), IsEmpty());
  }
}

TEST(Fixations, SamplesThatAreNoneAreNamed) {
  for (const GazeSample& bad : {GazeSample{.time = 5},
                                {.time = 4},
                                {.time = kNan},
                                {.time = 6, .direction = {0, 0, 2}},
                                {.time = 6, .direction = {0, kNan, 1}},
                                {.time = 6, .origin = {0, kNan, 1}}})
    EXPECT_THAT([&] { fixations(std::vector{GazeSample{.time = 5}, bad}); }, Refuses("sample 2: "));
  const GazeSample lost{.time = 6, .origin = {0, kNan, 1}, .valid = false};
  EXPECT_NO_THROW(fixations(std::vector{GazeSample{.time = 5}, lost}));
}

}  // namespace
}  // namespace salbench
