// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/rules/variants.h"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>

#include "stages/core/errors.h"

namespace salbench {
namespace {

constexpr std::size_t kMostVariants = 1000;  // per grid
constexpr std::string_view kNote = "# the model that this is a variant of\n";

// Reference models such as HS and chance have no map to tune.
const ModelRow& row_of(const Section& variant) {
  std::vector<std::string_view> known;
  for (const ModelRow& row : model_rows())
    if (!row.about.is_reference) known.push_back(row.name);
  const std::string wanted = variant.text(kModelOfVariant).value_or("");
  const auto row = std::ranges::find(model_rows(), wanted, &ModelRow::name);
  if (row == model_rows().end() || row->about.is_reference)
    variant.fail(kModelOfVariant, fmt::format("is '{}', not one of {}", wanted, fmt::join(known, ", ")));
  return *row;
}

// The value as parsed, so that 0.50 becomes 0.5.
std::string value_in_name(const Model& model, const std::string& option) {
  const std::string lines = "\n" + model.options, line = fmt::format("\n{}: ", option);
  const std::size_t begin = lines.find(line) + line.size();
  std::string value = lines.substr(begin, lines.find('\n', begin) - begin);
  for (char& c : value)
    if (!wrong_with_model_name({&c, 1}).empty()) c = '_';
  return value;
}

Model variant(const ModelRow& row, const std::string& name, const Section& of_model, const Section& written,
              Protocol protocol) {
  Model model = row.bind_as(name, std::array{of_model, written}, protocol);
  const std::string line = fmt::format("{}: {}\n", kModelOfVariant, row.name);
  model.options = line + model.options;
  model.annotated_options = std::string(kNote) + line + model.annotated_options;
  return model;
}

}  // namespace

std::vector<std::string> variant_sections(const Section& models) {
  std::vector<std::string> names;
  for (const std::string& name : models.keys()) {
    if (is_built_in_model(name) || !models.has_mapping(name)) continue;
    const Section model = models.child(name);
    if (model.has(kModelOfVariant) && !model.has("command") && !model.has("function")) names.push_back(name);
  }
  return names;
}

std::vector<Model> variants_of(const std::string& name, const Section& models, Protocol protocol) {
  const Section written = models.child(name);
  const ModelRow& row = row_of(written);
  const Section of_model = models.child(row.name);
  if (!written.has(kGridOfVariants)) {
    if (const std::string wrong = wrong_with_model_name(name); !wrong.empty()) models.fail(name, wrong);
    return {variant(row, name, of_model, written, protocol)};
  }
  std::vector<Model> made;
  for (const Section& chosen : written.combinations(kGridOfVariants, kMostVariants)) {
    Model model = variant(row, name, of_model, chosen, protocol);
    std::string own = name;
    for (const std::string& option : written.child(kGridOfVariants).keys())
      own += "-" + value_in_name(model, option);
    if (const std::string wrong = wrong_with_model_name(own); !wrong.empty())
      written.fail(kGridOfVariants, fmt::format("makes a model called '{}', which {}", own, wrong));
    if (std::ranges::find(made, own, &Model::name) != made.end())
      written.fail(kGridOfVariants, fmt::format("makes two models called '{}'", own));
    made.push_back(variant(row, own, of_model, chosen, protocol));
  }
  return made;
}

}  // namespace salbench
