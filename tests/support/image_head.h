// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstring>
#include <span>

#include "io/digest.h"
#include "io/file.h"

namespace salbench {

// Deliberately damaged image with a valid checksum.
inline Bytes vouched_for(Bytes image) {
  constexpr std::size_t kChecksumAt = 16, kSummedFrom = 24;
  if (image.size() < kSummedFrom) return image;
  const std::uint64_t sum = checksum(std::span(image).subspan(kSummedFrom));
  std::memcpy(image.data() + kChecksumAt, &sum, sizeof sum);
  return image;
}

}  // namespace salbench
