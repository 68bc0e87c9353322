// SPDX-License-Identifier: GPL-3.0-or-later
// Content-addressed artefacts. An artefact is found by (stage, key) and known by the digest of its content;
// what depends on it is keyed by that digest, so a recomputation with an equal result changes nothing
// downstream.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "cache/claim.h"
#include "cache/digest.h"
#include "cache/key.h"
#include "io/arrays.h"

namespace salbench {

// Queries of `plan`, from several threads at once: they never touch the artefacts.
class Index {
 public:
  virtual ~Index() = default;
  // Content digest of the artefact, if there is one.
  virtual std::optional<Digest> find(std::string_view stage, const Digest& key) const = 0;
  // True if the stage has been computed for this item under any key: a changed artefact, not a new one.
  virtual bool has_item(std::string_view stage, std::string_view item) const = 0;
};

struct ArtefactNote {
  std::string item;       // a label for people; never looked up
  double seconds = 0;     // wall time of the computation
  Attributes attributes;  // further root attributes
};

class Store : public Index {
 public:
  // As find, but also sees what other processes have stored in the meantime.
  virtual std::optional<Digest> refresh_and_find(std::string_view stage, const Digest& key) = 0;
  // The arrays; nothing if the artefact is missing, truncated or fails its checksum. A bad file is
  // quarantined with a warning that names it, and is a miss from then on. Throws StorageError if the system
  // does not let us read it, which says nothing about the file.
  virtual std::optional<Arrays> load(std::string_view stage, const Digest& key) = 0;
  // Throws StorageError if nothing can be saved: for the moment before the first computation.
  virtual void prepare() {}
  // The artefact is complete on return, or does not exist. Throws StorageError.
  virtual Digest save(const Recipe& recipe, std::string_view kind, const Arrays& arrays,
                      const ArtefactNote& note) = 0;
  // Returns when everything that was saved is on the disk. Until then a crash of the machine may lose or
  // damage artefacts; `load` takes those for misses. Throws StorageError.
  virtual void sync() {}
  // One process at a time holds a claim; nothing if another holds it. A store of a single process grants all.
  virtual std::unique_ptr<Claim> claim(std::string_view work) {
    static_cast<void>(work);
    return std::make_unique<Claim>();
  }
  // True if somebody holds it; takes nothing.
  virtual bool is_claimed(std::string_view work) const {
    static_cast<void>(work);
    return false;
  }
  // Before what others hold is waited for. Throws ConfigError if it can never come.
  virtual void before_waiting() const {}
};

}  // namespace salbench
