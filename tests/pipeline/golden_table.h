// SPDX-License-Identifier: GPL-3.0-or-later
// Golden outputs: a few numbers for each array that a stage writes over the toy data, and the rules by which
// they may change. The table is tests/golden/stages.csv; golden_test.cpp says how it is brought up to date.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "io/arrays.h"
#include "io/table.h"

namespace salbench {

// Robust to the last digits of another machine's mathematics, sensitive to any value and to the order.
struct Fingerprint {
  std::int64_t count = 0;  // values; those that are not finite are counted here alone
  std::int64_t finite = 0;
  double mean = 0, sd = 0;   // of the finite values
  double weighted_mean = 0;  // with weights in [0, 1) that depend on the position
};

class FingerprintMaker {
 public:
  void add(const ArrayValues& values);
  Fingerprint result() const;

 private:
  std::vector<double> values_;
};

struct GoldenRow {
  std::string protocol, stage;
  std::int32_t version = 0;
  std::string shape;  // "mesh", "scan" or "cloud"
  std::string array;
  std::string options;  // digest of the stage's options and seed
  Fingerprint fingerprint;

  // What the row is about: a stage comes with all its arrays, for each kind of shapes, in each protocol.
  std::string subject() const { return protocol + "/" + stage + "/" + shape + "/" + array; }
};

bool agree(const Fingerprint& a, const Fingerprint& b);  // to 1e-6 of the values' size

Table golden_table(std::span<const GoldenRow> rows);
std::vector<GoldenRow> golden_rows(const Table& table);  // the inverse; throws InputError

// `now` with the fingerprints of `golden` where the two agree: the last digits of another machine are no
// news.
std::vector<GoldenRow> updated(std::span<const GoldenRow> now, std::span<const GoldenRow> golden);

struct GoldenChange {
  std::string what;        // one line
  bool forbidden = false;  // the output changed, and nothing says so: neither version, options nor an input
};

// `inputs` are the (protocol/stage, protocol/stage read by it) pairs of the run.
std::vector<GoldenChange> golden_changes(std::span<const GoldenRow> now, std::span<const GoldenRow> golden,
                                         std::span<const std::pair<std::string, std::string>> inputs);

}  // namespace salbench
