//   source --+
//            +--> gate --> open ==> part ==> close --+
//   tokens --+                                       |
//     ^----------------------------------------------+
// A family enters only with a token, and its token comes back when it is closed. The bodies know nothing of
// this.
#include "pipeline/flow.h"

#include <exception>
#include <mutex>
#include <vector>

#include <tbb/flow_graph.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

namespace salbench {
namespace {

namespace flow = tbb::flow;

using Token = flow::continue_msg;
struct Part {
  int family;
  int part;
};

// An exception that leaves a body would lose the items in flight, so it is kept and the stream runs dry.
class FirstError {
 public:
  template <class Body>
  void guard(const Body& body) {
    if (failed_) return;
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

void run_graph(int families, int tokens_alive, const std::atomic<bool>& stop, const FlowBodies& bodies) {
  FirstError error;
  std::vector<std::atomic<int>> parts_left(static_cast<std::size_t>(families));
  int next = 0;

  tbb::task_group_context context;
  flow::graph graph(context);
  flow::input_node<int> source(graph, [&](tbb::flow_control& control) {
    if (next < families && !stop && !error.failed()) return next++;
    control.stop();
    return 0;
  });
  flow::buffer_node<Token> tokens(graph);
  flow::join_node<std::tuple<int, Token>, flow::reserving> gate(graph);

  using Open = flow::multifunction_node<std::tuple<int, Token>, std::tuple<Part, int>>;
  Open open(graph, flow::unlimited, [&](const std::tuple<int, Token>& entered, Open::output_ports_type& out) {
    const int family = std::get<0>(entered);
    int parts = 0;
    error.guard([&] { parts = bodies.open(family); });
    parts_left[static_cast<std::size_t>(family)] = parts;
    if (parts == 0) std::get<1>(out).try_put(family);
    for (int part = 0; part < parts; ++part) std::get<0>(out).try_put({family, part});
  });
  using Work = flow::multifunction_node<Part, std::tuple<int>>;
  Work work(graph, flow::unlimited, [&](const Part& p, Work::output_ports_type& out) {
    error.guard([&] { bodies.part(p.family, p.part); });
    if (--parts_left[static_cast<std::size_t>(p.family)] == 0) std::get<0>(out).try_put(p.family);
  });
  flow::function_node<int, Token> close(graph, flow::serial, [&](int family) {
    error.guard([&] { bodies.close(family); });
    return Token();
  });

  flow::make_edge(source, flow::input_port<0>(gate));
  flow::make_edge(tokens, flow::input_port<1>(gate));
  flow::make_edge(gate, open);
  flow::make_edge(flow::output_port<0>(open), work);
  flow::make_edge(flow::output_port<1>(open), close);
  flow::make_edge(flow::output_port<0>(work), close);
  flow::make_edge(close, tokens);

  for (int i = 0; i < tokens_alive; ++i) tokens.try_put(Token());
  source.activate();
  graph.wait_for_all();
  error.rethrow();
}

}  // namespace

void stream_families(int families, const FlowLimits& limits, const std::atomic<bool>& stop,
                     const FlowBodies& bodies) {
  // The arena holds the threads at work; the global control keeps libraries from adding their own.
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(limits.threads));
  tbb::task_arena arena(limits.threads);
  arena.execute([&] { run_graph(families, limits.families_alive, stop, bodies); });
}

}  // namespace salbench
