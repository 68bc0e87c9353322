// SPDX-License-Identifier: GPL-3.0-or-later
//   families --+
//              +--> gate --> entrance --> node of each rule: mesh, scan, normals, fpfh, map.LS ...
//   tokens ----+                            |  ^
//     ^                                     |  +-- from the node that finishes the last input of a job
//     +-- from the node that finishes the last job of the family
// A family enters only with a token. The inputs of a rule are known at run time only, and a gathering rule
// reads all families, so each job counts its open inputs. Nodes implement the limits, and priorities: later
// rules go first, so that units leave before new ones enter.
#include "pipeline/engine/graph.h"

#include <algorithm>
#include <deque>
#include <exception>
#include <memory>
#include <mutex>
#include <set>
#include <utility>

#include <tbb/flow_graph.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

namespace salbench {
namespace {

namespace flow = tbb::flow;

using Token = flow::continue_msg;
using RuleNode = flow::function_node<Job>;  // runs jobs that may begin

// Keeps the first exception: leaving a node's body, it would lose the jobs in flight. The stream then drains.
class FirstError {
 public:
  template <class Body>
  void guard(const Body& body) {
    try {
      body();
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!error_) error_ = std::current_exception();
      failed_ = true;
    }
  }
  bool failed() const { return failed_; }
  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  std::atomic<bool> failed_ = false;
  std::mutex mutex_;
  std::exception_ptr error_;
};

class Stream {
 public:
  Stream(const Project& project, int tokens, const std::atomic<bool>& stop, const GraphBodies& bodies)
      : project_(project), stop_(stop), bodies_(bodies), families_(project.units.families().size()) {
    count_inputs();
    build_graph();
    for (int i = 0; i < tokens; ++i) tokens_.try_put(Token());
  }

  void run_dry() {
    for (const Job& job : project_.jobs_of(Unit{})) begin(job);
    source_.activate();
    graph_.wait_for_all();
    for (std::size_t f = 0; f < families_.size(); ++f)
      if (families_[f].entered) error_.guard([&] { bodies_.leave_family(f); });
    error_.rethrow();
  }

 private:
  static constexpr int kNotOpen = -1;

  struct OfFamily {
    std::atomic<std::size_t> open_jobs = 0;
    bool entered = false;
  };

  bool ended() const { return stop_ || error_.failed(); }
  OfFamily& family(Unit unit) { return families_[project_.units.family_of(unit)]; }
  std::atomic<int>& missing(const Job& job) { return missing_[job.rule][job.unit.index]; }

  // Counts the open inputs of each job; a job without any begins when its family enters.
  void count_inputs() {
    for (std::size_t rule = 0; rule < project_.rules.size(); ++rule) {
      auto& missing = missing_.emplace_back(project_.units.slots(project_.rules[rule].level()));
      std::ranges::fill(missing, kNotOpen);
      for (const Unit unit : project_.units_of(rule)) {
        const Job job{rule, unit};
        if (!bodies_.is_open(job)) continue;
        missing[unit.index] = std::max(1, open_inputs(job));
        if (unit.level != kRoot) ++family(unit).open_jobs;
      }
    }
  }

  // Duplicate inputs count once.
  int open_inputs(const Job& job) {
    const std::vector<std::size_t>& inputs = project_.rule(job).inputs;
    int open = 0;
    for (auto input = inputs.begin(); input != inputs.end(); ++input) {
      if (std::find(inputs.begin(), input, *input) != input) continue;
      for (const Job& read : project_.input_jobs(job, static_cast<std::size_t>(input - inputs.begin())))
        open += missing(read) == kNotOpen ? 0 : 1;
    }
    return open;
  }

  void build_graph() {
    for (std::size_t rule = 0; rule < project_.rules.size(); ++rule) {
      node_of_.push_back(&node_for(rule));
      for (const std::size_t input : project_.rules[rule].inputs) readers_[input].insert(rule);
    }
    flow::make_edge(source_, flow::input_port<0>(gate_));
    flow::make_edge(tokens_, flow::input_port<1>(gate_));
    flow::make_edge(gate_, entrance_);
  }

  // Limits apply across levels: rules of one stage with a limit share a node.
  RuleNode& node_for(std::size_t rule) {
    const Rule& added = project_.rules[rule];
    for (std::size_t earlier = 0; earlier < rule && added.limit > 0; ++earlier)
      if (project_.rules[earlier].limit == added.limit && project_.rules[earlier].stage == added.stage)
        return *node_of_[earlier];
    return nodes_.emplace_back(
        graph_, added.limit == 0 ? std::size_t{flow::unlimited} : added.limit,
        [this](const Job& job) {
          settle_and_release(job);
          return flow::continue_msg();
        },
        static_cast<flow::node_priority_t>(rule + 1));
  }

  std::size_t next_family(tbb::flow_control& control) {
    while (next_ < families_.size() && families_[next_].open_jobs == 0) ++next_;
    if (next_ < families_.size() && !ended()) return next_++;
    control.stop();
    return 0;
  }

  // Returns false if the family cannot begin; its token is returned at once.
  bool enter_family(std::size_t number) {
    bool entered = false;
    error_.guard([&] { entered = bodies_.enter_family(number); });
    families_[number].entered = entered;
    if (!entered) return false;
    for (const Unit unit : project_.units.of_family(number))
      for (const Job& job : project_.jobs_of(unit)) begin(job);
    return true;
  }

  void put(const Job& job) { node_of_[job.rule]->try_put(job); }

  void begin(const Job& job) {
    if (missing(job) != kNotOpen && open_inputs(job) == 0) put(job);
  }

  void settle_and_release(const Job& job) {
    if (ended()) return;
    bool settled = false;
    error_.guard([&] { settled = bodies_.settle_job(job); });
    if (!settled || error_.failed()) return;
    for (const std::size_t rule : readers_[job.rule])
      for (const Unit unit : units_reading(job.unit, project_.rules[rule].level()))
        if (const Job reader{rule, unit}; missing(reader) != kNotOpen && --missing(reader) == 0) put(reader);
    if (job.unit.level == kRoot || --family(job.unit).open_jobs > 0) return;
    family(job.unit).entered = false;
    error_.guard([&] { bodies_.leave_family(project_.units.family_of(job.unit)); });
    tokens_.try_put(Token());
  }

  std::vector<Unit> units_reading(Unit unit, Level level) const {
    const Units& units = project_.units;
    return units.is_above(unit.level, level) ? units.below(unit, level)
                                             : std::vector{units.above(unit, level)};
  }

  const Project& project_;
  const std::atomic<bool>& stop_;
  const GraphBodies& bodies_;
  std::deque<std::vector<std::atomic<int>>> missing_;  // [rule][unit]: inputs still open, or kNotOpen
  std::vector<OfFamily> families_;
  std::size_t next_ = 0;
  FirstError error_;

  tbb::task_group_context task_context_;
  flow::graph graph_{task_context_};
  flow::input_node<std::size_t> source_{graph_, [this](tbb::flow_control& c) { return next_family(c); }};
  flow::buffer_node<Token> tokens_{graph_};
  flow::join_node<std::tuple<std::size_t, Token>, flow::reserving> gate_{graph_};
  flow::function_node<std::tuple<std::size_t, Token>> entrance_{
      graph_, flow::unlimited, [this](const std::tuple<std::size_t, Token>& entered) {
        if (!enter_family(std::get<0>(entered))) tokens_.try_put(Token());
        return flow::continue_msg();
      }};
  std::deque<RuleNode> nodes_;
  std::vector<RuleNode*> node_of_;                                     // [rule]
  std::vector<std::set<std::size_t>> readers_{project_.rules.size()};  // [rule]: rules that read it
};

}  // namespace

void stream_jobs(const Project& project, const GraphLimits& limits, const std::atomic<bool>& stop,
                 const GraphBodies& bodies) {
  // The arena holds the worker threads; the global control keeps libraries from adding their own. The control
  // lives on the heap because after fork() the child may reuse the stacks of threads that it lacks, while TBB
  // still reads the control.
  const auto control = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                             static_cast<std::size_t>(limits.threads));
  tbb::task_arena arena(limits.threads);
  arena.execute([&] { Stream(project, limits.families, stop, bodies).run_dry(); });
}

}  // namespace salbench
