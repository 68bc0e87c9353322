// SPDX-License-Identifier: GPL-3.0-or-later
// Content-addressed artefacts. A key, which includes the stage, locates an artefact; the digest of its
// content identifies the result and enters the keys of dependent artefacts. If a recomputation gives an equal
// result, nothing downstream changes.
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

// Queries used by planning; thread-safe, and without access to the artefacts themselves.
class Index {
 public:
  virtual ~Index() = default;
  // Content digest of the artefact; nullopt if there is none.
  virtual std::optional<Digest> find(const Digest& key) const = 0;
  // True if the stage has an artefact of this item under any key: the artefact changed, it is not new.
  virtual bool has_item(std::string_view stage, std::string_view item) const = 0;
  virtual std::vector<std::string> stages() const = 0;  // stages with artefacts, sorted by name
};

// family: name shared by the artefacts of a mesh and its scans; empty for results over all families.
class Store : public Index {
 public:
  // Takes notice of what other processes have stored for a family.
  virtual void refresh(std::string_view family) { static_cast<void>(family); }
  // nullopt if the artefact is missing or damaged; damage is reported by a warning that names it, and the
  // artefact then counts as missing. Throws StorageError if the system refuses to read it, which says nothing
  // about the artefact.
  virtual std::optional<Arrays> load(const Digest& key) = 0;
  // Remark stored with the artefact; empty if none or unreadable.
  virtual std::string remark(const Digest& key) = 0;
  // Called before the first computation. Throws StorageError if nothing can be saved.
  virtual void prepare() {}
  // Makes the artefact available to find and load. Written to a file when its family is flushed, which also
  // happens automatically once much is unsaved. Throws StorageError.
  virtual void save(std::string_view family, Artefact artefact) = 0;
  virtual void flush(std::string_view family) { static_cast<void>(family); }
  // Flushes all families, without waiting for the disk: after a crash of the machine, artefacts that were
  // lost or damaged count as missing. Throws StorageError.
  virtual void flush_all() {}
  // A claim that one process holds at a time; nullptr if another holds it. Single-process stores grant all.
  virtual std::unique_ptr<Claim> claim(std::string_view work) {
    static_cast<void>(work);
    return std::make_unique<Claim>();
  }
  // True if the work is claimed; acquires nothing.
  virtual bool is_claimed(std::string_view work) const {
    static_cast<void>(work);
    return false;
  }
};

}  // namespace salbench
