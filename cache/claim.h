// SPDX-License-Identifier: GPL-3.0-or-later
// Claims divide work between processes that share a cache: each piece is done by one of them.
#pragma once

#include <filesystem>
#include <memory>
#include <string_view>

namespace salbench {

// Held for the lifetime of the object, at most of the process.
class Claim {
 public:
  Claim() = default;
  Claim(const Claim&) = delete;
  Claim& operator=(const Claim&) = delete;
  virtual ~Claim() = default;
};

// nullptr if a living process (this one included) holds it. Claims save work and protect nothing: a file
// system without locks grants all of them. `work` is the name of the piece of work.
std::unique_ptr<Claim> claim_in(const std::filesystem::path& cache, std::string_view work);

// True if a living process (this one included) holds it; acquires nothing. False if locks cannot tell.
bool is_claimed_in(const std::filesystem::path& cache, std::string_view work);

}  // namespace salbench
