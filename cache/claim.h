// Claims: of the processes that share a cache, one at a time does a piece of work.
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

// Nothing where a living process (this one included) holds it. Claims save work and protect nothing: where
// the file system has no locks, everything is granted. Two works are the same where their names are.
std::unique_ptr<Claim> claim_in(const std::filesystem::path& cache, std::string_view work);

}  // namespace salbench
