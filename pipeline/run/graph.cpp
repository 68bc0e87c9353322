// SPDX-License-Identifier: GPL-3.0-or-later
//   families --+
//              +--> gate --> entrance --> mesh --> scan --> scan_normals --> fpfh --> map.LS --> ...
//   tokens ----+                            |                                            |
//     ^                                     +--> normals --> fpfh --> ...                |
//     +-- from whichever row settles the last job of its family -------------------------+
// A family enters only with a token. The arity of a row is known at run time only, so no join_node counts its
// inputs: each job has a counter, and the arrival that takes it to zero settles the job in its row's node.
// Later rows have priority: shapes leave before new ones enter.
#include "pipeline/run/graph.h"

#include <algorithm>
#include <deque>
#include <exception>
#include <mutex>

#include <tbb/flow_graph.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include "stages/scan/scan.h"

namespace salbench {
namespace {

namespace flow = tbb::flow;

using Token = flow::continue_msg;
using Ticket = Item;  // a result of this item is there
enum Port : std::size_t { kItem, kScans, kToken };
using RowNode = flow::multifunction_node<Ticket, std::tuple<Ticket, Ticket, Token>>;

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
  Stream(const Context& context, int tokens, const std::atomic<bool>& stop, const GraphBodies& bodies)
      : context_(context), stop_(stop), bodies_(bodies), families_(context.workload.families.size()) {
    count_inputs();
    build();
    for (int i = 0; i < tokens; ++i) tokens_.try_put(Token());
  }

  void run() {
    for (std::size_t row = 0; row < node_of_.size(); ++row)
      if (context_.catalog.rows[row].gathers) start({row, Item::set()});
    source_.activate();
    graph_.wait_for_all();
    for (std::size_t f = 0; f < families_.size(); ++f)
      if (families_[f].entered) error_.guard([&] { bodies_.leave(f); });
    error_.rethrow();
  }

 private:
  static constexpr int kNotOpen = -1;

  struct Family {
    std::atomic<std::size_t> open_jobs = 0;
    bool entered = false;
  };

  bool ended() const { return stop_ || error_.failed(); }

  std::atomic<int>& missing(const JobRef& job) { return missing_[job.row][job.item.index()]; }

  // A job without open inputs waits for the ticket that its family's entrance sends.
  void count_inputs() {
    for (std::size_t row = 0; row < context_.catalog.rows.size(); ++row) {
      std::vector<std::atomic<int>>& missing = missing_.emplace_back(slot_count(context_, row));
      for (const Item& item : items_of(context_, row)) {
        const JobRef job{row, item};
        missing[item.index()] = bodies_.open(job) ? std::max(1, open_inputs(job)) : kNotOpen;
        if (missing[item.index()] != kNotOpen && !item.is_set()) ++families_[item.family].open_jobs;
      }
    }
  }

  int open_inputs(const JobRef& job) {
    int open = 0;
    for (std::size_t i = 0; i < context_.row(job).inputs.size(); ++i)
      for (const JobRef& input : input_jobs(context_, job, i)) open += missing(input) == kNotOpen ? 0 : 1;
    return open;
  }

  void build() {
    const std::vector<Row>& rows = context_.catalog.rows;
    for (std::size_t row = 0; row < rows.size(); ++row) node_of_.push_back(shared_node(row));
    for (const Edge& edge : edges(context_.catalog)) {
      const bool to_scans = rows[edge.from].scope() == Scope::mesh && rows[edge.to].scope() == Scope::scan;
      if (to_scans)
        flow::make_edge(flow::output_port<kScans>(*node_of_[edge.from]), *node_of_[edge.to]);
      else
        flow::make_edge(flow::output_port<kItem>(*node_of_[edge.from]), *node_of_[edge.to]);
    }
    for (RowNode& node : nodes_) flow::make_edge(flow::output_port<kToken>(node), tokens_);
    flow::make_edge(source_, flow::input_port<0>(gate_));
    flow::make_edge(tokens_, flow::input_port<1>(gate_));
    flow::make_edge(gate_, entrance_);
    flow::make_edge(entrance_, tokens_);
  }

  // A limit holds for all kinds of shapes together: rows of one name with a limit share a node, where the
  // ticket tells the row.
  RowNode* shared_node(std::size_t row) {
    const std::vector<Row>& rows = context_.catalog.rows;
    const std::size_t limit = rows[row].limit;
    for (std::size_t earlier = 0; limit > 0 && earlier < row; ++earlier)
      if (rows[earlier].limit == limit && rows[earlier].name == rows[row].name) return node_of_[earlier];
    return &nodes_.emplace_back(
        graph_, limit == 0 ? std::size_t{flow::unlimited} : limit,
        [this, row](const Ticket& ticket, RowNode::output_ports_type& out) {
          if (context_.catalog.rows[row].limit == 0) return arrive(row, ticket, out);
          for (std::size_t other = row; other < node_of_.size(); ++other)
            if (node_of_[other] == node_of_[row]) arrive(other, ticket, out);
        },
        static_cast<flow::node_priority_t>(row + 1));
  }

  std::size_t next_family(tbb::flow_control& control) {
    while (next_ < families_.size() && families_[next_].open_jobs == 0) ++next_;
    if (next_ < families_.size() && !ended()) return next_++;
    control.stop();
    return 0;
  }

  // False: the token goes back at once.
  bool enter(std::size_t family) {
    bool entered = false;
    error_.guard([&] { entered = bodies_.enter(family); });
    families_[family].entered = entered;
    if (!entered) return false;
    for (const Item& item : family_items(context_, family))
      for (const JobRef& job : jobs_of(context_.catalog, item)) start(job);
    return true;
  }

  void start(const JobRef& job) {
    if (missing(job) != kNotOpen && open_inputs(job) == 0) node_of_[job.row]->try_put(job.item);
  }

  // A ticket of a mesh stands for the mesh, or at a row of scans for the scan that it was sent for; at a row
  // of the data set every ticket stands for the set. Sets finish before any shape that reads them enters.
  void arrive(std::size_t row, const Ticket& ticket, RowNode::output_ports_type& out) {
    const Row& of = context_.catalog.rows[row];
    if (ticket.is_set() && !of.gathers) return;
    // A node that rows for several kinds of shapes share sends on the tickets of all.
    if (!ticket.is_set() && ticket.shapes() != of.shapes) return;
    const JobRef job{row, of.gathers ? Item::set() : ticket};
    if (missing(job) == kNotOpen || --missing(job) > 0 || ended()) return;
    bool settled = false;
    error_.guard([&] { settled = bodies_.settle(job); });
    if (!settled || error_.failed()) return;
    std::get<kItem>(out).try_put(job.item);
    if (job.item.is_mesh())
      for (int view = 0; view < kViews; ++view) std::get<kScans>(out).try_put({job.item.family, view});
    if (!job.item.is_set() && --families_[job.item.family].open_jobs == 0) {
      families_[job.item.family].entered = false;
      error_.guard([&] { bodies_.leave(job.item.family); });
      std::get<kToken>(out).try_put(Token());
    }
  }

  const Context& context_;
  const std::atomic<bool>& stop_;
  const GraphBodies& bodies_;
  std::deque<std::vector<std::atomic<int>>> missing_;  // [row][item]: inputs to arrive, or kNotOpen
  std::vector<Family> families_;
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
  std::deque<RowNode> nodes_;
  std::vector<RowNode*> node_of_;  // [row]
};

}  // namespace

std::vector<Edge> edges(const Catalog& catalog) {
  std::vector<Edge> all;
  for (std::size_t row = 0; row < catalog.rows.size(); ++row)
    for (const std::size_t input : catalog.rows[row].inputs) all.push_back({input, row});
  return all;
}

void stream(const Context& context, const GraphLimits& limits, const std::atomic<bool>& stop,
            const GraphBodies& bodies) {
  // The arena holds the threads at work; the global control keeps libraries from adding their own.
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(limits.threads));
  tbb::task_arena arena(limits.threads);
  arena.execute([&] { Stream(context, limits.families, stop, bodies).run(); });
}

}  // namespace salbench
