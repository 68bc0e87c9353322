// SPDX-License-Identifier: GPL-3.0-or-later
// Artefacts of a folder, in segments (cache/segment.h). Segment heads contain everything that planning needs:
// the index is read from them once, and there is no database to corrupt, lock or update. A segment is created
// by an atomic rename, and never changes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cache/entry_table.h"
#include "cache/store.h"

namespace salbench {

enum class Access { read_only, read_write };

class FolderStore final : public Store {
 public:
  // Reads the heads in the folder; a missing folder is empty. read_write removes temporary files of killed
  // processes, and needs a writable folder only from `prepare` or the first `save` on: a complete cache may
  // be read-only. With `families`, reads only these and results over all families, since a share of a large
  // data set need not open the files of others. Throws StorageError: not a folder, or written by a newer
  // program.
  FolderStore(std::filesystem::path folder, Access access,
              const std::optional<std::vector<std::string>>& families = {});
  ~FolderStore() override;

  std::optional<Digest> find(const Digest& key) const override;
  bool has_item(std::string_view stage, std::string_view item) const override;
  std::vector<std::string> stages() const override;
  void refresh(std::string_view family) override;
  std::optional<Arrays> load(const Digest& key) override;
  std::string remark(const Digest& key) override;
  void prepare() override;  // creates the folder
  void save(std::string_view family, Artefact artefact) override;
  void flush(std::string_view family) override;
  void flush_all() override;

  std::unique_ptr<Claim> claim(std::string_view work) override;
  bool is_claimed(std::string_view work) const override;

  // As load, but with arrays as stored.
  std::optional<Artefact> artefact(const Digest& key);

  // File and group of an artefact, for links to it; nullopt if there is none.
  struct Location {
    std::filesystem::path file;
    std::string group;
  };
  std::optional<Location> location(const Digest& key) const;

  std::optional<std::filesystem::path> file_of(const Digest& key) const;

  std::optional<std::uint64_t> bytes_of(const Digest& key) const;  // stored size of its arrays

  // Visits the note of each artefact, once per file that contains it; skips damaged ones.
  using VisitNote = std::function<void(const Digest& key, const ArtefactNote& note)>;
  void visit_notes(const std::vector<Digest>& keys, const VisitNote& visit) const;

  using Usage = EntryTable::Usage;
  std::vector<Usage> usage() const;  // by stage name

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace salbench
