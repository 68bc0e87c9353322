// SPDX-License-Identifier: GPL-3.0-or-later
// Claims: processes that share a cache divide the work, so that each piece is done by one of them.
#pragma once

#include <filesystem>
#include <memory>
#include <string_view>

namespace salbench {

// Held as long as the object lives, and no longer than the process.
class Claim {
 public:
  Claim() = default;
  Claim(const Claim&) = delete;
  Claim& operator=(const Claim&) = delete;
  virtual ~Claim() = default;
};

// Nothing if a living process (this one included) holds it. Claims save work and protect nothing: a file
// system without locks grants everything. `work` identifies the work by its name.
std::unique_ptr<Claim> claim_in(const std::filesystem::path& cache, std::string_view work);

// True if a living process (this one included) holds it; takes nothing. False where locks cannot tell.
bool is_claimed_in(const std::filesystem::path& cache, std::string_view work);

}  // namespace salbench
