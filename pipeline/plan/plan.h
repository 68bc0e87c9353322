// SPDX-License-Identifier: GPL-3.0-or-later
// Decides, without computing anything, what there is to do: catalog + items + what the cache has -> jobs.
//
// A job is one row of the catalog for one item: a shape or the data set. Keys are made of the content
// digests of what a row reads. Where an input still has to be computed, the key is not known yet: such a job
// waits, and may yet turn out to be in the cache when the input comes out as before.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "cache/store.h"
#include "pipeline/catalog/catalog.h"
#include "pipeline/plan/workload.h"

namespace salbench {

enum class Verdict : std::uint8_t {
  wait,            // an input is not known yet
  compute,         // all inputs are known, the result is not in the cache
  cached,          // in the cache
  done,            // computed by this run, or given
  not_applicable,  // does not apply: no ground truth, or no reference histogram
  failed,          // this row failed
  blocked,         // something it reads failed
};

enum class Reason : std::uint8_t {
  none,
  never_computed,  // nothing in the cache for this row and item
  changed,         // the cache has this row of the item for other inputs, options, seed or version
  input_pending,   // waits for the blocking input
  input_failed,    // the blocking input failed
  no_ground_truth,
  unreadable,    // a source file cannot be read
  damaged,       // the artefact is truncated or fails its checksum
  inapplicable,  // the row has nothing to say of the item
  not_given,     // a map of such items is not among those given
  only_cached,   // not in the cache, and not to be computed
  needs_all,     // the mean over the whole data set, of which this is a share
};
template <>
struct EnumNames<Reason> {  // for people
  static constexpr std::array<std::string_view, 12> names{"",
                                                          "not in the cache",
                                                          "options, inputs, seed or version changed",
                                                          "waits for",
                                                          "failed input:",
                                                          "no ground truth",
                                                          "a source file cannot be read",
                                                          "damaged",
                                                          "does not apply",
                                                          "not given",
                                                          "not asked for",
                                                          "needs the mean over all shards"};
};

struct Job {
  Verdict verdict = Verdict::wait;
  Reason reason = Reason::none;
  std::uint8_t blocking_input = 0;  // index among the row's inputs
  Digest key, content;              // known where cached or done

  bool known() const { return verdict == Verdict::cached || verdict == Verdict::done; }
  bool open() const { return verdict == Verdict::wait || verdict == Verdict::compute; }
  bool computed() const { return verdict == Verdict::done || reason == Reason::damaged; }  // after a run
};

struct JobRef {
  std::size_t row = 0;
  Item item;

  bool operator==(const JobRef&) const = default;
};

struct Plan {
  std::vector<std::vector<Job>> jobs;  // [row][Item::index()]; not_applicable for items of other kinds

  Job& operator[](const JobRef& job) { return jobs[job.row][job.item.index()]; }
  const Job& operator[](const JobRef& job) const { return jobs[job.row][job.item.index()]; }
};

// Everything that planning and running share and that is fixed before the first job.
struct Context {
  const Catalog& catalog;
  Workload& workload;  // its digests follow files that change during a run
  std::uint64_t seed = 0;
  Attributes attributes = {};       // written to every artefact
  std::optional<Shard> shard = {};  // the workload is a share: no mean is taken over it

  const Row& row(const JobRef& job) const { return catalog.rows[job.row]; }
  const DatasetItem& source(const Item& item) const { return workload.families[item.family].source; }
  std::string name(const Item& item) const;   // "52", "52_3"
  std::string name(const JobRef& job) const;  // that of its item; "meshes", "scans" or "clouds" for a set
};

// The mesh of a family, then its scans where the catalog has rows for them; or its point cloud.
std::vector<Item> family_items(const Context& context, std::size_t family);
std::vector<Item> all_items(const Context& context);                    // family by family
std::vector<Item> items_of(const Context& context, std::size_t row);    // that the row has jobs for, in order
std::size_t slot_count(const Context& context, std::size_t row);        // above Item::index() of all of these
std::vector<JobRef> jobs_of(const Catalog& catalog, const Item& item);  // in the order of the rows
std::optional<Item> find_item(const Context& context, const std::string& name);  // "52", "52_3"

// The jobs whose results a job reads through one of its inputs: one, or all members of a set.
std::vector<JobRef> input_jobs(const Context& context, const JobRef& job, std::size_t input);

// The files that a row reads of an item; empty where there are none of their kind.
SourceFiles& sources_of(const Context& context, const JobRef& job);

// Everything the job's result is a function of, as far as its inputs are known.
Recipe recipe_of(const Context& context, const Plan& plan, const JobRef& job);

// Decides one job from the verdicts of its inputs and what the cache has under its key.
using Lookup = std::function<std::optional<Digest>(std::string_view stage, const Digest& key)>;
Job decide(const Context& context, const Plan& plan, const JobRef& job, const Lookup& lookup);

Plan make_plan(const Context& context, const Index& index);

std::size_t count_open(const std::vector<Job>& jobs);

// Job counts per row name, for `salbench plan` and `status`; all kinds of shapes together.
struct RowCount {
  std::string stage;
  std::int32_t version = 0;
  std::size_t cached = 0, compute = 0, wait = 0, not_applicable = 0, failed = 0;
  std::vector<std::pair<std::string, std::size_t>> reasons;  // most frequent first
};
// Words for the reason of one job, the same for all that are to be counted together; empty: not counted.
using Why = std::function<std::string(const JobRef& job)>;
std::vector<RowCount> count_by_name(const Context& context, const Plan& plan, const Why& why = {});

}  // namespace salbench
