// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

namespace salbench {

// Name of the widest instructions that the kernels use on this machine: "baseline", "avx2" or "avx512".
std::string_view simd_level();

}  // namespace salbench
