// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/models/simd_level.h"

#include "stages/models/chi2_kernel.h"

namespace salbench {

std::string_view simd_level() {
  switch (chi2_kernel::widest_supported()) {
    case chi2_kernel::Instructions::avx512:
      return "avx512";
    case chi2_kernel::Instructions::avx2:
      return "avx2";
    case chi2_kernel::Instructions::baseline:
      break;
  }
  return "baseline";
}

}  // namespace salbench
