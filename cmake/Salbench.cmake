# SPDX-License-Identifier: GPL-3.0-or-later
# Compiler settings, and the functions that declare a folder's library and its tests.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR})
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)

# No contraction and no -march: the same operations on every x86-64. Bytes are the same but for the C library's exp() and
# others, of which it has one for processors with FMA: docs/releases.md. And PCL's and Eigen's alignment must agree with
# Debian's binaries (PCL issue 5806). Kernels choose their instructions at run time.
add_library(salbench_settings INTERFACE)
target_include_directories(salbench_settings INTERFACE ${PROJECT_SOURCE_DIR})
target_compile_options(salbench_settings INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Wconversion -ffp-contract=off
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>  # GCC 12 sees overlaps in std::string that are not there (PR 105651)
  $<$<BOOL:${SALBENCH_WERROR}>:-Werror>)
# Kernels keep several vectors in arrays, which those of a length that is known at run time cannot be in.
target_compile_definitions(salbench_settings INTERFACE
  "HWY_DISABLED_TARGETS=(HWY_SVE|HWY_SVE2|HWY_SVE_256|HWY_SVE2_128)")
if(SALBENCH_SANITIZE)
  add_compile_options(-fsanitize=${SALBENCH_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${SALBENCH_SANITIZE})
  # Under a sanitizer Eigen would take its own aligned malloc, while Debian's PCL takes the system's: what one
  # allocates the other frees.
  add_compile_definitions(EIGEN_MALLOC_ALREADY_ALIGNED=1)
endif()

if(SALBENCH_FUZZ)
  add_compile_options(-fsanitize=fuzzer-no-link)  # what leads libFuzzer: which branches were taken
endif()

find_program(CCACHE ccache)
if(CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE})
endif()

# salbench_library(name SOURCES ... PUBLIC ... PRIVATE ...): target salbench_<name>. Heavy libraries go to PRIVATE
# and are system headers: their warnings are not ours.
function(salbench_library name)
  cmake_parse_arguments(arg "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  add_library(salbench_${name} STATIC ${arg_SOURCES})
  target_link_libraries(salbench_${name} PUBLIC salbench_settings ${arg_PUBLIC} PRIVATE ${arg_PRIVATE})
endfunction()

# salbench_test(name SOURCES ... LIBS ...): executable test_<name>, one ctest per TEST.
function(salbench_test name)
  cmake_parse_arguments(arg "" "" "SOURCES;LIBS" ${ARGN})
  add_executable(test_${name} ${arg_SOURCES})
  target_link_libraries(test_${name} PRIVATE salbench_settings ${arg_LIBS} GTest::gmock GTest::gtest_main)
  gtest_discover_tests(test_${name} DISCOVERY_TIMEOUT 60 PROPERTIES TIMEOUT 1200)
endfunction()
