// SPDX-License-Identifier: GPL-3.0-or-later
// Texts of the help beside its subcommands: --help and the manual page print the same ones.
#pragma once

#include <array>
#include <string>

namespace salbench {

inline constexpr const char* kDescription =
    "Benchmark of 3D saliency models on meshes, simulated range scans and point clouds.";

struct Example {
  const char* line;
  const char* remark = "";
};

inline constexpr std::array kExamples = {
    Example{"salbench run configs/shrec07.yaml --data SchellingData",
            "the whole benchmark; run it again to resume"},
    Example{"salbench run configs/shrec07.yaml --data SchellingData --items 1-20,52,125"},
    Example{"salbench maps configs/shrec07.yaml --data SchellingData --items 52 --models LS,PS --to maps"},
    Example{"salbench pictures configs/shrec07.yaml --data SchellingData --items 52"},
    Example{"salbench export configs/shrec07.yaml --data SchellingData --items 52 --to 52.h5"},
    Example{"salbench plan configs/shrec07.yaml --data SchellingData", "what a run would compute, and why"},
    Example{"salbench graph configs/shrec07.yaml --format dot | dot -Tsvg",
            "the flow graph of a run, as a picture"},
    Example{"salbench explain configs/shrec07.yaml 52_3 --data SchellingData",
            "what differs from what the cache has"},
    Example{"salbench status configs/shrec07.yaml --data SchellingData", "what is there already"},
    Example{"salbench config", "every option, its default, unit and range"},
};

struct StatusMeaning {
  int status;  // ExitStatus
  const char* meaning;
};

inline constexpr std::array kStatusMeanings = {
    StatusMeaning{0, "all done"},
    StatusMeaning{1, "some items failed, each was named"},
    StatusMeaning{2, "unusable arguments or configuration"},
    StatusMeaning{3, "cache, output folder or standard output unusable"},
    StatusMeaning{70, "a defect of the program, or memory ran out"},
    StatusMeaning{130, "interrupted, the line that resumes was printed"},
};

std::string help_footer();  // examples and exit statuses, below the help of every subcommand

}  // namespace salbench
