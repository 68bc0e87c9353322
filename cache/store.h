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

// What `plan` may ask: it never touches the artefacts.
class Index {
 public:
  virtual ~Index() = default;
  // Content digest of the artefact, where there is one.
  virtual std::optional<Digest> find(std::string_view stage, const Digest& key) const = 0;
  // Whether the stage has been computed for this item under any key: tells a new artefact from a changed one.
  virtual bool has_item(std::string_view stage, std::string_view item) const = 0;
};

struct ArtefactNote {
  std::string item;       // a label for people; never looked up
  double seconds = 0;     // wall time of the computation
  Attributes attributes;  // further root attributes
};

class Store : public Index {
 public:
  // As find, but also sees what other processes have stored meanwhile.
  virtual std::optional<Digest> refresh_and_find(std::string_view stage, const Digest& key) = 0;
  // The arrays; nothing where the artefact is missing, short or fails its checksum. A bad file is moved aside
  // with a warning that names it, and is a miss from then on. Throws StorageError if the system does not let
  // it be read, which says nothing about the file.
  virtual std::optional<Arrays> load(std::string_view stage, const Digest& key) = 0;
  // Complete on return, or not there at all. Throws StorageError.
  virtual Digest save(const Recipe& recipe, std::string_view kind, const Arrays& arrays,
                      const ArtefactNote& note) = 0;
  // Of the processes that share the store, one at a time has a claim; nothing where another has it. A store
  // of one process alone grants them all.
  virtual std::unique_ptr<Claim> claim(std::string_view work) {
    static_cast<void>(work);
    return std::make_unique<Claim>();
  }
};

}  // namespace salbench
