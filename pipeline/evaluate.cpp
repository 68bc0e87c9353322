#include "pipeline/evaluate.h"

#include "pipeline/given_maps.h"

namespace salbench {

ExitStatus evaluate_command(const Arguments& arguments, const EvaluateOptions& options,
                            const std::atomic<bool>& stop) {
  Session session(arguments, stop, given_model(options.name, find_given_maps(options.maps, options.matched)));
  return run_session(session, arguments, stop);
}

}  // namespace salbench
