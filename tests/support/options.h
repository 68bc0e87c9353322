// SPDX-License-Identifier: GPL-3.0-or-later
// Name of the field that check() rejects in an options struct; empty if there is none.
#pragma once

#include <string>

#include "stages/core/errors.h"
#include "stages/core/options.h"

namespace salbench {

template <class Options>
std::string wrong_field(const Options& options) {
  try {
    check(options);
  } catch (const OptionError& error) {
    return error.key;
  }
  return "";
}

}  // namespace salbench
