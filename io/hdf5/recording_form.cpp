// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/hdf5/recording_form.h"

#include <cmath>
#include <set>
#include <string_view>

namespace salbench {
namespace {

// Reason why no stage can process a row; empty if one can.
std::string wrong_with(const GazeRecording& recording, std::size_t i) {
  const auto number = static_cast<std::int32_t>(recording.people.size());
  if (recording.person[i] < 0 || recording.person[i] >= number)
    return fmt::format("is of person {}, and there are {}", recording.person[i], number);
  if (!std::isfinite(recording.time[i])) return "has no time";
  const bool goes_on = i > 0 && recording.person[i] == recording.person[i - 1];
  if (i > 0 && recording.person[i] < recording.person[i - 1])
    return "is of an earlier person than the one before";
  if (goes_on && !(recording.time[i] > recording.time[i - 1]))
    return fmt::format("has the time {} ms, which is not after {} ms", recording.time[i],
                       recording.time[i - 1]);
  if (recording.valid[i] > 1) return fmt::format("has {} as `valid`, expected 0 or 1", recording.valid[i]);
  if (recording.valid[i] == 0) return {};
  if (!recording.origins.empty() && !recording.origins[i].allFinite())
    return "has an origin that is not finite";
  if (!recording.points.empty() && !recording.points[i].allFinite()) return "has a point that is not finite";
  if (recording.has_rays())
    if (const double length = recording.directions[i].norm(); !(std::abs(length - 1) <= 1e-3))
      return fmt::format("has a direction that is {} long, expected 1", length);
  if (!recording.durations.empty() && !(recording.durations[i] >= 0 && std::isfinite(recording.durations[i])))
    return fmt::format("has the duration {}", recording.durations[i]);
  return {};
}

// Names of people appear unchanged in tables and pages.
void check_names(const FormReader& in, const std::vector<std::string>& names) {
  std::set<std::string_view> known;
  for (const std::string& name : names) {
    if (const auto wrong = wrong_with_line(name); !wrong.empty())
      in.fail(fmt::format("data set 'recording/people': {} has {}, which tables cannot have", in_quotes(name),
                          wrong));
    if (name.empty() || !known.insert(name).second)
      in.fail(fmt::format("data set 'recording/people': {} is {}", in_quotes(name),
                          name.empty() ? "no name" : "there twice"));
  }
}

// Triples; those that are not `valid` may be non-finite.
std::vector<Vec3> rows_of_three(const FormReader& in, const char* name, std::size_t rows) {
  const std::vector<double>& flat = in.read<double>(name, rows, 3);
  std::vector<Vec3> all;
  for (std::size_t i = 0; i < flat.size(); i += 3) all.emplace_back(flat[i], flat[i + 1], flat[i + 2]);
  return all;
}

}  // namespace

std::vector<std::uint8_t> bytes_of_lines(const std::vector<std::string>& lines) {
  std::vector<std::uint8_t> bytes;
  for (const std::string& line : lines) {
    bytes.insert(bytes.end(), line.begin(), line.end());
    bytes.push_back('\n');
  }
  return bytes;
}

std::vector<std::string> lines_in_bytes(const std::vector<std::uint8_t>& bytes) {
  std::vector<std::string> lines;
  auto begin = bytes.begin();
  for (auto end = begin; end != bytes.end(); ++end)
    if (*end == '\n') {
      lines.emplace_back(begin, end);
      begin = end + 1;
    }
  if (begin != bytes.end()) lines.emplace_back(begin, bytes.end());
  return lines;
}

void add_recording(Arrays& arrays, const GazeRecording& recording) {
  arrays.push_back(column("recording/people", bytes_of_lines(recording.people), "1",
                          "names of the people in UTF-8, each with a line feed behind it"));
  arrays.push_back(
      column("recording/person", recording.person, "number", "0-based, ascending: whose row it is"));
  arrays.push_back(column("recording/time", recording.time, "ms", "ascending within each person"));
  arrays.push_back(column("recording/valid", recording.valid, "1", "0: the eye or its place was lost"));
  if (!recording.origins.empty())
    arrays.push_back(
        triples("recording/origins", recording.origins, kSourceLength, "the eye, in the frame of the shape"));
  if (recording.has_rays())
    arrays.push_back(triples("recording/directions", recording.directions, "1",
                             "unit vectors of gaze, in the frame of the shape"));
  else
    arrays.push_back(triples("recording/points", recording.points, kSourceLength,
                             "places looked at, in the frame of the shape"));
  if (!recording.durations.empty())
    arrays.push_back(column("recording/durations", recording.durations, "ms",
                            "of the fixations; not there where rows are samples"));
}

GazeRecording recording_in(const FormReader& in) {
  GazeRecording recording;
  if (!in.has("recording/person")) return recording;
  recording.person = in.read<std::int32_t>("recording/person", 0);
  const std::size_t m = recording.person.size();
  if (m == 0) in.fail("data set 'recording/person': there are no rows");
  recording.people = lines_in_bytes(in.read<std::uint8_t>("recording/people", 0));
  check_names(in, recording.people);
  recording.time = in.read<double>("recording/time", m);
  recording.valid = in.read<std::uint8_t>("recording/valid", m);
  if (in.has("recording/origins")) recording.origins = rows_of_three(in, "recording/origins", m);
  if (in.has("recording/directions")) recording.directions = rows_of_three(in, "recording/directions", m);
  if (in.has("recording/points")) recording.points = rows_of_three(in, "recording/points", m);
  if (in.has("recording/durations")) recording.durations = in.read<double>("recording/durations", m);
  if (recording.directions.empty() == recording.points.empty())
    in.fail("expected one of 'recording/directions' and 'recording/points'");
  if (recording.has_rays() && recording.origins.empty())
    in.fail("has 'recording/directions' without 'recording/origins'");
  for (std::size_t i = 0; i < m; ++i)
    if (const std::string wrong = wrong_with(recording, i); !wrong.empty())
      in.fail(fmt::format("group 'recording': row {} (0-based) {}", i, wrong));
  return recording;
}

}  // namespace salbench
