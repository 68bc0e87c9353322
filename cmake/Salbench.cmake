# SPDX-License-Identifier: GPL-3.0-or-later
# Compiler settings, and the functions that declare a folder's library and its tests.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR})
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)

# Of a release each target says itself how far it is optimised: the default of CMake would stand before it. Stages compute for long,
# the rest does not, and tests less than what they test.
string(REPLACE "-O3" "" CMAKE_CXX_FLAGS_RELEASE "${CMAKE_CXX_FLAGS_RELEASE}")
set(SALBENCH_OPTIMISATION 2)
define_property(TARGET PROPERTY SALBENCH_OPTIMISATION INITIALIZE_FROM_VARIABLE SALBENCH_OPTIMISATION)

# No contraction and no -march: the same operations on every x86-64. Bytes are the same but for the C library's exp() and
# others, of which it has one for processors with FMA: docs/releases.md. And PCL's and Eigen's alignment must agree with
# Debian's binaries (PCL issue 5806). Kernels choose their instructions at run time.
add_library(salbench_settings INTERFACE)
target_include_directories(salbench_settings INTERFACE ${PROJECT_SOURCE_DIR})
target_compile_options(salbench_settings INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Wconversion -ffp-contract=off
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>  # GCC 12 sees overlaps in std::string that are not there (PR 105651)
  $<$<CONFIG:Release>:-O$<TARGET_PROPERTY:SALBENCH_OPTIMISATION>>
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

# Debian's Python, which sees Debian's packages. It has no sanitizer of its own: that of our module has to be there from the start, before
# all that it replaces, and what Python keeps until its end is no leak.
set(SALBENCH_TEST_PYTHON /usr/bin/python3)
if(SALBENCH_SANITIZE)
  string(SUBSTRING ${SALBENCH_SANITIZE} 0 1 letter)
  foreach(name IN ITEMS ${letter}san stdc++)
    execute_process(COMMAND ${CMAKE_CXX_COMPILER} -print-file-name=lib${name}.so OUTPUT_VARIABLE file OUTPUT_STRIP_TRAILING_WHITESPACE)
    list(APPEND preloaded ${file})
  endforeach()
  list(JOIN preloaded ":" preloaded)
  set(SALBENCH_TEST_PYTHON ${PROJECT_BINARY_DIR}/python3)
  file(WRITE ${SALBENCH_TEST_PYTHON} "#!/bin/sh\nexec env LD_PRELOAD=\"${preloaded}\${LD_PRELOAD:+:$LD_PRELOAD}\" \\
  ASAN_OPTIONS=detect_leaks=0:allocator_may_return_null=1:verify_asan_link_order=0 /usr/bin/python3 \"$@\"\n")
  file(CHMOD ${SALBENCH_TEST_PYTHON} FILE_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE)
endif()

if(SALBENCH_FUZZ)
  add_compile_options(-fsanitize=fuzzer-no-link)  # what leads libFuzzer: which branches were taken
endif()

if(NOT DEFINED CACHE{CCACHE})  # later a build folder stays without: commands that change compile all of it again
  find_program(CCACHE ccache)
endif()
if(CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE})
endif()

# Two thirds of the time of a file go into headers that its neighbours include as well, so a few files are compiled as
# one. Those who change one file again and again wait less without (preset dev).
option(SALBENCH_UNITY "Compile several files of a folder at a time" ON)
function(salbench_compile_together target files alone)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${SALBENCH_UNITY} UNITY_BUILD_BATCH_SIZE ${files})
  set_source_files_properties(${alone} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()

# salbench_library(name SOURCES ... ALONE ... PUBLIC ... PRIVATE ...): target salbench_<name>. Heavy libraries go to
# PRIVATE and are system headers: their warnings are not ours. ALONE: sources that are not compiled with others, since
# they take long, or have flags or a heavy library of their own.
function(salbench_library name)
  cmake_parse_arguments(arg "" "" "SOURCES;ALONE;PUBLIC;PRIVATE" ${ARGN})
  add_library(salbench_${name} STATIC ${arg_SOURCES} ${arg_ALONE})
  salbench_compile_together(salbench_${name} 8 "${arg_ALONE}")
  cmake_path(GET CMAKE_CURRENT_SOURCE_DIR PARENT_PATH parent)
  if(parent STREQUAL ${PROJECT_SOURCE_DIR}/stages)
    set_target_properties(salbench_${name} PROPERTIES SALBENCH_OPTIMISATION 3)
  endif()
  target_link_libraries(salbench_${name} PUBLIC salbench_settings ${arg_PUBLIC} PRIVATE ${arg_PRIVATE})
endfunction()

# salbench_test(name SOURCES ... ALONE ... LIBS ...): executable test_<name>, one ctest per TEST. ALONE: sources with names
# that their neighbours have as well.
function(salbench_test name)
  cmake_parse_arguments(arg "" "LABEL" "SOURCES;ALONE;LIBS" ${ARGN})
  if(NOT arg_LABEL)
    set(arg_LABEL unit)
  endif()
  add_executable(test_${name} ${arg_SOURCES} ${arg_ALONE})
  salbench_compile_together(test_${name} 6 "${arg_ALONE}")
  set_target_properties(test_${name} PROPERTIES SALBENCH_OPTIMISATION 1)
  target_link_libraries(test_${name} PRIVATE salbench_settings ${arg_LIBS} GTest::gmock GTest::gtest_main)
  gtest_discover_tests(test_${name} DISCOVERY_TIMEOUT 60 PROPERTIES TIMEOUT 1200 LABELS ${arg_LABEL})
endfunction()

# salbench_python_tests(name TIMEOUT s [LABEL label] [MODULES ... | BUT ...]): test NAME.MODULE for each module named, or for all of this folder
# but some. Their bytecode is kept in the build folder, never beside the sources.
function(salbench_python_tests name)
  cmake_parse_arguments(arg "" "TIMEOUT;LABEL" "MODULES;BUT" ${ARGN})
  if(NOT arg_LABEL)
    set(arg_LABEL python)
  endif()
  if(NOT arg_MODULES)
    file(GLOB arg_MODULES CONFIGURE_DEPENDS RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} *_test.py)
    list(TRANSFORM arg_MODULES REPLACE "\\.py$" "")
    list(REMOVE_ITEM arg_MODULES ${arg_BUT})
  endif()
  # The dearest begin first, also in a first run, and the short tests of C++ fill the end.
  set(cost 1)
  if(arg_LABEL MATCHES "^(browser|docs|scripts)$")
    set(cost 2)
  endif()
  foreach(module IN LISTS arg_MODULES)
    add_test(NAME ${name}.${module} COMMAND ${SALBENCH_TEST_PYTHON} -m unittest -v ${module}
      WORKING_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR})
    set_tests_properties(${name}.${module} PROPERTIES TIMEOUT ${arg_TIMEOUT} LABELS ${arg_LABEL} COST ${cost} ENVIRONMENT
      "PYTHONPATH=${PROJECT_BINARY_DIR}/python:${PROJECT_SOURCE_DIR};SALBENCH_PROGRAM=${PROJECT_BINARY_DIR}/salbench;\
PYTHONPYCACHEPREFIX=${PROJECT_BINARY_DIR}/bytecode;PYTHONDONTWRITEBYTECODE=")
  endforeach()
endfunction()
