// SPDX-License-Identifier: GPL-3.0-or-later
// Statements of a text about pairs of models, beside what scores say.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/results/conclusions.h"

namespace salbench {

enum class Relation { above, same, differ };  // a is better than b; the two do not differ; they differ

template <>
struct EnumNames<Relation> {
  static constexpr std::array<std::string_view, 3> names = {"above", "same", "differ"};
};

// A statement about every model of `a` against every one of `b`.
struct Statement {
  std::string section, text, word;  // word: how the text puts it
  std::string dataset, metric;
  Relation relation = Relation::above;
  std::vector<std::string> a, b;
  double margin = 0;  // differences below it count as none; NaN: no margin is given
};

// The statements about pairs in a CSV file like configs/paper/claims.csv: columns section, claim, word,
// dataset, metric, check, a, b, margin; rows with another check, and those without a word, are left out.
// Throws InputError with the line of a data set that there is none of, or of a margin that is not above 0.
std::vector<Statement> read_statements(const std::filesystem::path& path);

// statements.csv (docs/data_dictionary.md): a row per pair, twice judged: by the paper's test over shapes and
// by intervals over units. Empty where a model has no scores; no row without conclusions on data set and
// metric. [schuirmann1987] [lakens2017]
Table statements_table(const Conclusions& conclusions, const std::vector<Statement>& statements);

}  // namespace salbench
