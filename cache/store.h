// SPDX-License-Identifier: GPL-3.0-or-later
// Content-addressed artefacts. An artefact is found by its key, in which its stage is, and known by the
// digest of its content; what depends on it is keyed by that digest, so a recomputation with an equal result
// changes nothing downstream.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cache/artefact.h"
#include "cache/claim.h"
#include "cache/key.h"
#include "io/arrays.h"
#include "io/digest.h"

namespace salbench {

// Queries of `plan`, from several threads at once: they never touch the artefacts.
class Index {
 public:
  virtual ~Index() = default;
  // Content digest of the artefact, if there is one.
  virtual std::optional<Digest> find(const Digest& key) const = 0;
  // True if the stage has been computed for this item under any key: a changed artefact, not a new one.
  virtual bool has_item(std::string_view stage, std::string_view item) const = 0;
  virtual std::vector<std::string> stages() const = 0;  // that have been computed, sorted by name
};

// A family, here, is a name under which artefacts are stored together; empty: what is made of all families.
class Store : public Index {
 public:
  // Sees what other processes have stored of a family in the meantime.
  virtual void refresh(std::string_view family) { static_cast<void>(family); }
  // Nothing if the artefact is missing, or fails its checksum: then a warning names it, and it is a miss from
  // then on. Throws StorageError if the system does not let us read it, which says nothing about the
  // artefact.
  virtual std::optional<Arrays> load(const Digest& key) = 0;
  // That was made with it; empty if there is none, or the artefact cannot be had.
  virtual std::string remark(const Digest& key) = 0;
  // Throws StorageError if nothing can be saved: for the moment before the first computation.
  virtual void prepare() {}
  // The artefact can be found and loaded from now on. It is in a file once its family has been flushed, which
  // happens by itself where much is unsaved. Throws StorageError.
  virtual void save(std::string_view family, Artefact artefact) = 0;
  virtual void flush(std::string_view family) { static_cast<void>(family); }
  // The same of all families. A crash of the machine may lose or damage what the system has not brought to
  // the disk yet; `load` takes that for misses, so that nobody waits for the disk. Throws StorageError.
  virtual void flush_all() {}
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
};

}  // namespace salbench
