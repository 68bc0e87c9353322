// SPDX-License-Identifier: GPL-3.0-or-later
// The artefacts of a folder:
//   <folder>/<stage>/<2 digits>/<item>.<key>.<content>.<checksum>.<size>.h5
// The names carry everything that planning needs, so the index is one listing of the folder and there is no
// database to corrupt, lock or update: an artefact exists once its name does, by rename.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cache/name_index.h"
#include "cache/store.h"
#include "io/file.h"

namespace salbench {

enum class Access {
  read_only,
  on_demand,  // read_only, for a few keys: a folder of two digits is listed when one of its keys is asked for
  read_write,
};

class FolderStore final : public Store {
 public:
  // Lists the folder; a missing one is empty. read_write removes temporary files of killed processes, and
  // needs a folder that can be written to from `prepare` or the first `save` on: a complete cache may be
  // read-only. Throws StorageError: not a folder, or written by a newer program.
  FolderStore(std::filesystem::path folder, Access access);
  ~FolderStore() override;

  std::optional<Digest> find(std::string_view stage, const Digest& key) const override;
  bool has_item(std::string_view stage, std::string_view item) const override;
  std::optional<Digest> refresh_and_find(std::string_view stage, const Digest& key) override;
  std::optional<Arrays> load(std::string_view stage, const Digest& key) override;
  void prepare() override;  // creates the folder
  Digest save(const Recipe& recipe, std::string_view kind, const Arrays& arrays,
              const ArtefactNote& note) override;
  void sync() override;

  std::unique_ptr<Claim> claim(std::string_view work) override;
  bool is_claimed(std::string_view work) const override;
  void before_waiting() const override;

  // The stored bytes of an artefact, checked against their checksum; nothing in the same cases as load.
  std::optional<Bytes> image(std::string_view stage, const Digest& key);

  // File of an artefact, for links to it; nothing if there is none.
  std::optional<std::filesystem::path> path(std::string_view stage, const Digest& key) const;

  std::optional<std::uint64_t> bytes_of(std::string_view stage, const Digest& key) const;  // of that file

  using Usage = NameIndex::Usage;
  std::vector<Usage> usage() const;  // by stage name; on_demand: of what was listed

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace salbench
