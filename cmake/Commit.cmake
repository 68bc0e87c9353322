# SPDX-License-Identifier: GPL-3.0-or-later
# Writes OUTPUT, a source file with the commit of the tree ROOT, when that is another than before; empty where neither an archive's
# cmake/commit.txt nor git says it. Run by each build.
cmake_minimum_required(VERSION 3.25)
file(STRINGS ${ROOT}/cmake/commit.txt commit)
if(commit MATCHES "Format")  # no archive
  set(commit "")
  if(EXISTS ${ROOT}/.git)  # a tree that lies in another project's has none of its own
    execute_process(COMMAND git rev-parse HEAD WORKING_DIRECTORY ${ROOT} OUTPUT_VARIABLE commit
      OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE status)
    execute_process(COMMAND git diff-index --quiet HEAD WORKING_DIRECTORY ${ROOT} ERROR_QUIET RESULT_VARIABLE changed)
    if(NOT status EQUAL 0)
      set(commit "")
    elseif(NOT changed EQUAL 0)
      string(APPEND commit " with changes")
    endif()
  endif()
endif()
file(CONFIGURE OUTPUT ${OUTPUT} @ONLY CONTENT
"// Made by cmake/Commit.cmake.
#include \"pipeline/run/commit.h\"

namespace salbench {

std::string_view commit() { return \"@commit@\"; }

}  // namespace salbench
")
