// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/pipeline/golden_table.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "tests/support/text_column.h"

namespace salbench {
namespace {

constexpr double kTolerance = 1e-6;

bool near(double a, double b, double size) { return std::abs(a - b) <= kTolerance * size; }

std::string stage_of(const GoldenRow& row) { return row.protocol + "/" + row.stage; }

// Stages that have a reason to come out otherwise: a version or options of their own, or an input that has.
std::set<std::string> excused_stages(std::span<const GoldenRow> now,
                                     const std::map<std::string, GoldenRow>& golden,
                                     std::span<const std::pair<std::string, std::string>> inputs) {
  std::set<std::string> excused;
  for (const GoldenRow& row : now) {
    const auto before = golden.find(row.subject());
    if (before == golden.end() || before->second.version != row.version ||
        before->second.options != row.options)
      excused.insert(stage_of(row));
  }
  for (std::size_t known = 0; known != excused.size();) {
    known = excused.size();
    for (const auto& [stage, input] : inputs)
      if (excused.contains(input)) excused.insert(stage);
  }
  return excused;
}

}  // namespace

void FingerprintMaker::add(const ArrayValues& values) {
  std::visit([&](const auto& v) { values_.insert(values_.end(), v.begin(), v.end()); }, values);
}

Fingerprint FingerprintMaker::result() const {
  Fingerprint result{.count = std::ssize(values_)};
  double sum = 0, weighted = 0, weights = 0;
  for (std::size_t i = 0; i < values_.size(); ++i) {
    if (!std::isfinite(values_[i])) continue;
    // The fractional parts of multiples of the golden ratio: no two positions near each other weigh the same.
    const double weight = std::fmod(static_cast<double>(i) * 0.6180339887498949, 1.0);
    ++result.finite;
    sum += values_[i];
    weighted += weight * values_[i];
    weights += weight;
  }
  if (result.finite == 0) return result;
  result.mean = sum / static_cast<double>(result.finite);
  result.weighted_mean = weights > 0 ? weighted / weights : 0;
  double squares = 0;
  for (const double value : values_)
    if (std::isfinite(value)) squares += (value - result.mean) * (value - result.mean);
  result.sd = std::sqrt(squares / static_cast<double>(result.finite));
  return result;
}

bool agree(const Fingerprint& a, const Fingerprint& b) {
  const double size = std::hypot(b.mean, b.sd);
  return a.count == b.count && a.finite == b.finite && near(a.mean, b.mean, size) && near(a.sd, b.sd, size) &&
         near(a.weighted_mean, b.weighted_mean, size);
}

Table golden_table(std::span<const GoldenRow> rows) {
  Table table{.columns = {"protocol", "stage", "version", "shape", "array", "options", "count", "finite",
                          "mean", "sd", "weighted_mean"},
              .rows = {}};
  for (const GoldenRow& row : rows) {
    const Fingerprint& f = row.fingerprint;
    table.rows.push_back({row.protocol, row.stage, std::int64_t{row.version}, row.shape, row.array,
                          row.options, f.count, f.finite, f.mean, f.sd, f.weighted_mean});
  }
  return table;
}

std::vector<GoldenRow> golden_rows(const Table& table) {
  std::vector<GoldenRow> rows(table.rows.size());
  const auto fill_text = [&](const char* column, std::string GoldenRow::*field) {
    const std::vector<std::string> values = text_column(table, column);
    for (std::size_t i = 0; i < rows.size(); ++i) rows[i].*field = values[i];
  };
  const auto fill_number = [&](const char* column, const auto& assign) {
    const std::vector<double> values = number_column(table, column);
    for (std::size_t i = 0; i < rows.size(); ++i) assign(rows[i], values[i]);
  };
  fill_text("protocol", &GoldenRow::protocol);
  fill_text("stage", &GoldenRow::stage);
  fill_text("shape", &GoldenRow::shape);
  fill_text("array", &GoldenRow::array);
  fill_text("options", &GoldenRow::options);
  fill_number("version", [](GoldenRow& row, double v) { row.version = static_cast<std::int32_t>(v); });
  fill_number("count",
              [](GoldenRow& row, double v) { row.fingerprint.count = static_cast<std::int64_t>(v); });
  fill_number("finite",
              [](GoldenRow& row, double v) { row.fingerprint.finite = static_cast<std::int64_t>(v); });
  fill_number("mean", [](GoldenRow& row, double v) { row.fingerprint.mean = v; });
  fill_number("sd", [](GoldenRow& row, double v) { row.fingerprint.sd = v; });
  fill_number("weighted_mean", [](GoldenRow& row, double v) { row.fingerprint.weighted_mean = v; });
  return rows;
}

std::vector<GoldenRow> updated(std::span<const GoldenRow> now, std::span<const GoldenRow> golden) {
  std::map<std::string, Fingerprint> before;
  for (const GoldenRow& row : golden) before.emplace(row.subject(), row.fingerprint);
  std::vector<GoldenRow> rows(now.begin(), now.end());
  for (GoldenRow& row : rows) {
    const auto found = before.find(row.subject());
    if (found != before.end() && agree(row.fingerprint, found->second)) row.fingerprint = found->second;
  }
  return rows;
}

std::vector<GoldenChange> golden_changes(std::span<const GoldenRow> now, std::span<const GoldenRow> golden,
                                         std::span<const std::pair<std::string, std::string>> inputs) {
  std::map<std::string, GoldenRow> before;
  for (const GoldenRow& row : golden) before.emplace(row.subject(), row);
  const std::set<std::string> excused = excused_stages(now, before, inputs);

  std::vector<GoldenChange> changes;
  std::set<std::string> present;
  for (const GoldenRow& row : now) {
    const std::string subject = row.subject();
    present.insert(subject);
    const auto found = before.find(subject);
    if (found == before.end()) {
      changes.push_back({subject + " is new"});
    } else if (found->second.version != row.version) {
      changes.push_back(
          {fmt::format("{} has version {}, the table {}", subject, row.version, found->second.version)});
    } else if (!agree(row.fingerprint, found->second.fingerprint)) {
      const bool forbidden = !excused.contains(stage_of(row));
      changes.push_back(
          {forbidden
               ? fmt::format("{} comes out otherwise under the same version {}: raise the "
                             "stage's version in the table of rules, or artefacts of before pass for new",
                             subject, row.version)
               : subject + " comes out otherwise, by its options or by what it reads",
           forbidden});
    }
  }
  for (const GoldenRow& row : golden)
    if (!present.contains(row.subject())) changes.push_back({row.subject() + " is no longer computed"});
  return changes;
}

}  // namespace salbench
