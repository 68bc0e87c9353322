// Decides, without computing anything, what there is to do: catalog + items + what the cache has -> jobs.
//
// Keys are made of the content digests of what a stage reads. Where an input still has to be computed, the
// key is not known yet: such a job waits, and may yet turn out to be in the cache when the input comes out as
// before.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "cache/store.h"
#include "pipeline/catalog.h"
#include "pipeline/workload.h"

namespace salbench {

enum class Verdict : std::uint8_t {
  wait,            // an input is not known yet
  compute,         // all inputs are known, the result is not in the cache
  cached,          // in the cache
  done,            // computed by this run
  not_applicable,  // does not apply: no ground truth, or no reference histogram
  failed,          // this stage failed
  blocked,         // something it reads failed
};

enum class Reason : std::uint8_t {
  none,
  never_computed,  // nothing in the cache for this stage and item
  changed,         // the cache has this stage of the item for other inputs, options, seed or version
  input_pending,   // waits for the blocking input
  input_failed,    // the blocking input failed
  no_ground_truth,
  unreadable,    // a source file cannot be read
  damaged,       // the artefact is truncated or fails its checksum
  inapplicable,  // the stage has nothing to say of the item
  not_given,     // a map of such items is not among those given
  needs_all,     // the mean over the whole data set, of which this is a share
};
std::string_view text_of(Reason reason);

struct Job {
  Verdict verdict = Verdict::wait;
  Reason reason = Reason::none;
  std::uint8_t blocking_input = 0;  // index among the stage's inputs
  Digest key, content;              // known where cached or done

  bool known() const { return verdict == Verdict::cached || verdict == Verdict::done; }
  bool open() const { return verdict == Verdict::wait || verdict == Verdict::compute; }
  bool computed() const { return verdict == Verdict::done || reason == Reason::damaged; }  // after a run
};

// One mesh (view = -1) or one scan of it.
struct ItemRef {
  std::size_t family = 0;
  int view = -1;

  bool is_mesh() const { return view < 0; }
};

struct Plan {
  struct FamilyJobs {
    std::vector<Job> mesh;                // [row of Catalog::mesh]
    std::vector<std::vector<Job>> scans;  // [view][row of Catalog::scan]
  };
  std::vector<FamilyJobs> families;
  std::vector<std::array<Job, 2>> means;  // as Catalog::means; of the meshes, of the scans

  std::vector<Job>& jobs(const ItemRef& item);
  const std::vector<Job>& jobs(const ItemRef& item) const;
};

// Everything that planning and running share and that is fixed before the first job.
struct Context {
  const Catalog& catalog;
  Workload& workload;  // its digests follow files that change during a run
  std::uint64_t seed = 0;
  std::optional<Histogram> given_reference = {};  // in place of the data set's own mean
  Attributes attributes = {};                     // written to every artefact
  std::optional<Shard> shard = {};                // the workload is a share: no mean is taken over it

  const Chain& chain(const ItemRef& item) const { return item.is_mesh() ? catalog.mesh : catalog.scan; }
  const DatasetItem& source(const ItemRef& item) const { return workload.families[item.family].source; }
  std::string name(const ItemRef& item) const;       // "52", "52_3"
  std::vector<ItemRef> items(bool meshes) const;     // of one kind, in order
  std::vector<ItemRef> family(std::size_t f) const;  // the mesh, then its scans
  std::vector<ItemRef> items() const;                // all, family by family
};

// The files that a stage reads of an item; empty where there are none of their kind.
SourceFiles& sources_of(const Context& context, const ItemRef& item, Source source);

using Lookup = std::function<std::optional<Digest>(std::string_view stage, const Digest& key)>;

// Decides one job from the verdicts of its inputs. The recipe is complete where the verdict is cached or
// compute.
struct Decision {
  Job job;
  Recipe recipe;
};
Decision decide(const Context& context, const Plan& plan, const ItemRef& item, std::size_t stage,
                const Lookup& lookup);
Decision decide_mean(const Context& context, const Plan& plan, std::size_t mean, bool meshes,
                     const Lookup& lookup);

// Name of an input as it appears in a key: the stage that produces it.
const std::string& input_name(const Context& context, const ItemRef& item, const Input& input);

Plan make_plan(const Context& context, const Index& index);

// Job counts per stage, for `salbench plan` and `status`. Means come last.
struct StageCount {
  std::string stage;  // or mean
  std::int32_t version = 0;
  std::size_t cached = 0, compute = 0, wait = 0, absent = 0, failed = 0;
  std::vector<std::pair<std::string, std::size_t>> reasons;  // most frequent first
};
// Words for the reason of one job, the same for all that are to be counted together; empty: not counted.
struct Why {
  std::function<std::string(const ItemRef& item, std::size_t stage)> of_stage;
  std::function<std::string(std::size_t mean, bool meshes)> of_mean;
};
std::vector<StageCount> count_by_stage(const Context& context, const Plan& plan, const Why& why = {});

}  // namespace salbench
