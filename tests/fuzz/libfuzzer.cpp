// SPDX-License-Identifier: GPL-3.0-or-later
// Entry point of libFuzzer, which calls the target named by the build.
#include <cstddef>
#include <cstdint>

#include "tests/fuzz/targets.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  salbench::SALBENCH_FUZZ_TARGET({reinterpret_cast<const char*>(data), size});
  return 0;
}
