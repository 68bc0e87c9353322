// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/core/options.h"

#include <charconv>
#include <cmath>

#include "stages/core/errors.h"

namespace salbench {
namespace {

std::string shortest(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

// Text to follow "must be".
std::string in_words(const Range& range) {
  const bool has_low = std::isfinite(range.low), has_high = std::isfinite(range.high);
  if (has_low && has_high)
    return range.low_included
               ? "between " + shortest(range.low) + " and " + shortest(range.high)
               : "a number above " + shortest(range.low) + " and at most " + shortest(range.high);
  if (has_high) return "at most " + shortest(range.high);
  if (has_low) return (range.low_included ? "at least " : "a number above ") + shortest(range.low);
  return "a finite number";
}

}  // namespace

bool Range::contains(double value) const {
  return std::isfinite(value) && (low_included ? value >= low : value > low) && value <= high;
}

std::string Range::text() const {
  const bool has_low = std::isfinite(low), has_high = std::isfinite(high);
  if (has_low && has_high) return shortest(low) + (low_included ? " <= x <= " : " < x <= ") + shortest(high);
  if (has_high) return "<= " + shortest(high);
  if (has_low) return (low_included ? ">= " : "> ") + shortest(low);
  return "";
}

void check_range(std::string_view key, double value, const Range& range) {
  if (range.contains(value)) return;
  throw OptionError(std::string(key), "must be " + in_words(std::isfinite(value) ? range : Range{}) +
                                          ", not " + shortest(value));
}

}  // namespace salbench
