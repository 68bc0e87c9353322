// SPDX-License-Identifier: GPL-3.0-or-later
//   families --+
//              +--> gate --> entrance --> mesh --> scan --> scan_normals --> fpfh --> map.LS --> ...
//   tokens ----+                            |                                            |
//     ^                                     +--> normals --> fpfh --> ...                |
//     +-- from whichever node finishes the last job of its family -----------------------+
// A family enters only with a token. The arity of a rule is known at run time only, so no join_node counts
// its inputs: each job has a counter, and the arrival that takes it to zero finishes the job in its rule's
// node. Later rules have priority: units leave before new ones enter.
#include "pipeline/engine/graph.h"

#include <algorithm>
#include <deque>
#include <exception>
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
using Ticket = Job;  // is finished; at the node of its own rule: may begin
enum Port : std::size_t { kTicket, kToken };
using RuleNode = flow::multifunction_node<Ticket, std::tuple<Ticket, Token>>;

// An exception that leaves a body would lose the tickets in flight, so it is kept and the stream runs dry.
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
    build();
    for (int i = 0; i < tokens; ++i) tokens_.try_put(Token());
  }

  void run() {
    for (const Job& job : project_.jobs_of(Unit{})) begin(job);
    source_.activate();
    graph_.wait_for_all();
    for (std::size_t f = 0; f < families_.size(); ++f)
      if (families_[f].entered) error_.guard([&] { bodies_.leave(f); });
    error_.rethrow();
  }

 private:
  static constexpr int kNotOpen = -1;

  struct OfFamily {
    std::atomic<std::size_t> open_jobs = 0;
    bool entered = false;
  };
  struct Node {
    std::vector<std::size_t> rules;  // several where they share a limit
    RuleNode* node = nullptr;
  };

  bool ended() const { return stop_ || error_.failed(); }
  OfFamily& family(Unit unit) { return families_[project_.units.family_of(unit)]; }
  std::atomic<int>& missing(const Job& job) { return missing_[job.rule][job.unit.index]; }
  bool reads(std::size_t rule, std::size_t input) const {
    return std::ranges::find(project_.rules[rule].inputs, input) != project_.rules[rule].inputs.end();
  }

  // A job without open inputs waits for the ticket that its family's entrance sends.
  void count_inputs() {
    for (std::size_t rule = 0; rule < project_.rules.size(); ++rule) {
      auto& missing = missing_.emplace_back(project_.units.slots(project_.rules[rule].level()));
      std::fill(missing.begin(), missing.end(), kNotOpen);
      for (const Unit unit : project_.units_of(rule)) {
        const Job job{rule, unit};
        if (!bodies_.open(job)) continue;
        missing[unit.index] = std::max(1, open_inputs(job));
        if (unit.level != kRoot) ++family(unit).open_jobs;
      }
    }
  }

  // An input that is read twice sends one ticket.
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

  // Edges between rules that have jobs to do: what was finished earlier sends no tickets.
  void build() {
    for (std::size_t rule = 0; rule < project_.rules.size(); ++rule) add_node(rule);
    std::set<std::pair<std::size_t, std::size_t>> edges;
    const auto any_open = [&](std::size_t rule) {
      return std::ranges::any_of(missing_[rule], [](const auto& inputs) { return inputs != kNotOpen; });
    };
    for (std::size_t rule = 0; rule < node_of_.size(); ++rule)
      for (const std::size_t input :
           any_open(rule) ? project_.rules[rule].inputs : std::vector<std::size_t>())
        if (any_open(input)) edges.emplace(node_of_[input], node_of_[rule]);
    for (const auto& [from, to] : edges)
      flow::make_edge(flow::output_port<kTicket>(*nodes_[from].node), *nodes_[to].node);
    for (const Node& node : nodes_) flow::make_edge(flow::output_port<kToken>(*node.node), tokens_);
    flow::make_edge(source_, flow::input_port<0>(gate_));
    flow::make_edge(tokens_, flow::input_port<1>(gate_));
    flow::make_edge(gate_, entrance_);
    flow::make_edge(entrance_, tokens_);
  }

  // A limit holds for all levels together: rules of one stage with a limit share a node.
  void add_node(std::size_t rule) {
    const Rule& added = project_.rules[rule];
    const auto shared = std::ranges::find_if(nodes_, [&](const Node& node) {
      const Rule& other = project_.rules[node.rules[0]];
      return added.limit > 0 && other.limit == added.limit && other.stage == added.stage;
    });
    node_of_.push_back(static_cast<std::size_t>(shared - nodes_.begin()));
    if (shared != nodes_.end()) return shared->rules.push_back(rule);
    const std::size_t number = nodes_.size();
    flow_nodes_.emplace_back(
        graph_, added.limit == 0 ? std::size_t{flow::unlimited} : added.limit,
        [this, number](const Ticket& ticket, RuleNode::output_ports_type& out) {
          arrive(number, ticket, out);
        },
        static_cast<flow::node_priority_t>(rule + 1));
    nodes_.push_back({{rule}, &flow_nodes_.back()});
  }

  std::size_t next_family(tbb::flow_control& control) {
    while (next_ < families_.size() && families_[next_].open_jobs == 0) ++next_;
    if (next_ < families_.size() && !ended()) return next_++;
    control.stop();
    return 0;
  }

  // False: the token goes back at once.
  bool enter(std::size_t number) {
    bool entered = false;
    error_.guard([&] { entered = bodies_.enter(number); });
    families_[number].entered = entered;
    if (!entered) return false;
    for (const Unit unit : project_.units.of_family(number))
      for (const Job& job : project_.jobs_of(unit)) begin(job);
    return true;
  }

  void put(const Ticket& ticket) { nodes_[node_of_[ticket.rule]].node->try_put(ticket); }

  void begin(const Job& job) {
    if (missing(job) != kNotOpen && open_inputs(job) == 0) put(job);
  }

  void arrive(std::size_t number, const Ticket& ticket, RuleNode::output_ports_type& out) {
    for (const std::size_t rule : nodes_[number].rules) {
      const Level level = project_.rules[rule].level();
      if (rule == ticket.rule) {
        if (missing(ticket) != kNotOpen) finish(ticket, out);
      } else if (!reads(rule, ticket.rule)) {
        continue;  // it is for another rule of the node
      } else if (project_.units.is_above(ticket.unit.level, level) && ticket.unit.level != level) {
        for (const Unit unit : project_.units.below(ticket.unit, level))
          if (takes_last_input({rule, unit})) put({rule, unit});
      } else if (const Job job{rule, project_.units.above(ticket.unit, level)}; takes_last_input(job)) {
        finish(job, out);
      }
    }
  }

  bool takes_last_input(const Job& job) { return missing(job) != kNotOpen && --missing(job) == 0; }

  void finish(const Job& job, RuleNode::output_ports_type& out) {
    if (ended()) return;
    bool finished = false;
    error_.guard([&] { finished = bodies_.finish(job); });
    if (!finished || error_.failed()) return;
    std::get<kTicket>(out).try_put(job);
    if (job.unit.level == kRoot || --family(job.unit).open_jobs > 0) return;
    family(job.unit).entered = false;
    error_.guard([&] { bodies_.leave(project_.units.family_of(job.unit)); });
    std::get<kToken>(out).try_put(Token());
  }

  const Project& project_;
  const std::atomic<bool>& stop_;
  const GraphBodies& bodies_;
  std::deque<std::vector<std::atomic<int>>> missing_;  // [rule][unit]: inputs to arrive, or kNotOpen
  std::vector<OfFamily> families_;
  std::size_t next_ = 0;
  FirstError error_;

  tbb::task_group_context task_context_;
  flow::graph graph_{task_context_};
  flow::input_node<std::size_t> source_{graph_, [this](tbb::flow_control& c) { return next_family(c); }};
  flow::buffer_node<Token> tokens_{graph_};
  flow::join_node<std::tuple<std::size_t, Token>, flow::reserving> gate_{graph_};
  using Entrance = flow::multifunction_node<std::tuple<std::size_t, Token>, std::tuple<Token>>;
  Entrance entrance_{graph_, flow::unlimited,
                     [this](const std::tuple<std::size_t, Token>& entered, Entrance::output_ports_type& out) {
                       if (!enter(std::get<0>(entered))) std::get<0>(out).try_put(Token());
                     }};
  std::deque<RuleNode> flow_nodes_;
  std::vector<Node> nodes_;
  std::vector<std::size_t> node_of_;  // [rule]
};

}  // namespace

void stream(const Project& project, const GraphLimits& limits, const std::atomic<bool>& stop,
            const GraphBodies& bodies) {
  // The arena holds the threads at work; the global control keeps libraries from adding their own.
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(limits.threads));
  tbb::task_arena arena(limits.threads);
  arena.execute([&] { Stream(project, limits.families, stop, bodies).run(); });
}

}  // namespace salbench
