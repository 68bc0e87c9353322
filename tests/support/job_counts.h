// SPDX-License-Identifier: GPL-3.0-or-later
// How many jobs a first run has, counted in the catalog: a new model or stage changes no number in a test.
#pragma once

#include <algorithm>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/catalog/catalog.h"
#include "stages/scan/scan.h"
#include "tests/support/toy_data.h"

namespace salbench {

// Of so many meshes, all of them with ground truth, and their scans.
class JobCounts {
 public:
  JobCounts(const Config& config, std::size_t meshes) : catalog_(make_catalog(config)), meshes_(meshes) {}
  explicit JobCounts(const std::string& yaml = kToyConfig, std::size_t meshes = 2)
      : JobCounts(toy_config(yaml), meshes) {}

  std::size_t meshes() const { return meshes_; }
  std::size_t scans() const { return has(Scope::scan) ? meshes_ * kViews : 0; }
  std::size_t shapes() const { return meshes() + scans(); }

  template <class Predicate>  // of a Row
  std::size_t where(const Predicate& wanted) const {
    std::size_t sum = 0;
    for (const Row& row : catalog_.rows)
      if (wanted(row)) sum += jobs_of(row);
    return sum;
  }

  std::size_t of_shapes() const {
    return where([](const Row& row) { return !row.gathers; });
  }
  std::size_t of_the_data_set() const { return all() - of_shapes(); }
  std::size_t all() const {
    return where([](const Row&) { return true; });
  }

  // What can be had without the rest of the data set: nothing that reads a mean, and no means.
  std::size_t before_reference() const {
    std::vector<bool> after(catalog_.rows.size(), false);
    std::size_t sum = 0;
    for (std::size_t r = 0; r < catalog_.rows.size(); ++r) {
      const Row& row = catalog_.rows[r];
      after[r] = row.gathers;
      for (const std::size_t input : row.inputs) after[r] = after[r] || after[input];
      if (!after[r]) sum += jobs_of(row);
    }
    return sum;
  }

  // Of one row name. A name that the catalog does not have is a mistake of the test.
  std::size_t of(std::string_view name) const {
    return expect_some(where([&](const Row& row) { return row.name == name; }), name);
  }

  // Map, matched map, scores, their table and mean histogram, as far as the model has them.
  std::size_t of_model(std::string_view model) const {
    return expect_some(
        where([end = "." + std::string(model)](const Row& row) { return row.name.ends_with(end); }), model);
  }

  // Of one layout, such as "scores"; for scores, the rows of results.csv.
  std::size_t of_kind(std::string_view kind) const {
    return expect_some(where([&](const Row& row) { return row.kind == kind; }), kind);
  }

 private:
  bool has(Scope scope) const {
    return std::any_of(catalog_.rows.begin(), catalog_.rows.end(),
                       [&](const Row& row) { return row.scope() == scope; });
  }
  std::size_t jobs_of(const Row& row) const {
    if (row.gathers) return 1;
    return row.shapes == Shapes::meshes ? meshes_ : meshes_ * kViews;
  }
  static std::size_t expect_some(std::size_t count, std::string_view name) {
    if (count == 0) throw std::out_of_range("no job of " + std::string(name));
    return count;
  }

  Catalog catalog_;
  std::size_t meshes_;
};

}  // namespace salbench
