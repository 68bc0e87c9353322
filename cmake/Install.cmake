# SPDX-License-Identifier: GPL-3.0-or-later
# What `cmake --install` and `cpack -G DEB` put where, and the manual page, made from the program's help texts.

include(GNUInstallDirs)
set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME program)
set(CMAKE_SKIP_INSTALL_ALL_DEPENDENCY ON)  # cpack would otherwise build every test first
set(share ${CMAKE_INSTALL_DATADIR}/salbench)
set(documents ${PROJECT_BINARY_DIR}/documents)

# The date of the version, from the changelog: the same tree gives the same package on any day.
string(REPLACE "." "\\." version_pattern ${PROJECT_VERSION})
file(STRINGS CHANGELOG.md heading REGEX "^## \\[${version_pattern}\\] - ")
string(REGEX MATCH "[0-9]+-[0-9]+-[0-9]+$" SALBENCH_DATE "${heading}")
if(NOT SALBENCH_DATE)
  message(FATAL_ERROR "CHANGELOG.md has no heading '## [${PROJECT_VERSION}] - DATE'")
endif()

find_program(HELP2MAN help2man)
if(HELP2MAN)
  file(MAKE_DIRECTORY ${documents})
  execute_process(COMMAND date -u -d ${SALBENCH_DATE} +%s OUTPUT_VARIABLE epoch
    OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
  add_custom_command(
    OUTPUT ${documents}/salbench.1
    COMMAND ${CMAKE_COMMAND} -E env LC_ALL=C SOURCE_DATE_EPOCH=${epoch} ${HELP2MAN} --no-info
      --include=${PROJECT_SOURCE_DIR}/cmake/manual.include --output=${documents}/salbench.1
      "${PROJECT_SOURCE_DIR}/cmake/manual.sh $<TARGET_FILE:salbench>"
    DEPENDS salbench cmake/manual.sh cmake/manual.include VERBATIM)
  if(NOT SALBENCH_SANITIZE)  # a build that nobody installs
    set(all ALL)
  endif()
  add_custom_target(salbench_manual ${all} DEPENDS ${documents}/salbench.1)
  install(FILES ${documents}/salbench.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
else()
  message(WARNING "help2man is missing: no manual page will be installed. scripts/setup installs it.")
endif()

install(TARGETS salbench)
install(DIRECTORY configs DESTINATION ${share})
install(FILES README.md CHANGELOG.md LICENSE CITATION.cff DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DOCDIR}
  FILES_MATCHING PATTERN *.md PATTERN *.bib PATTERN *.png PATTERN *.svg PATTERN *.csv PATTERN own_model.py PATTERN simulated_gaze.py)
install(FILES docs/examples/read_export.py DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples)
install(FILES cmake/completion.bash
  DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME salbench)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME salbench)
set(CPACK_PACKAGE_VENDOR "The salbench maintainers")
set(CPACK_PACKAGE_CONTACT "The salbench maintainers <maintainers@salbench.invalid>")
# Packages of several Debian releases differ in their libraries, and an upgrade of Debian is one of the package.
cmake_host_system_information(RESULT distribution QUERY DISTRIB_INFO)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1~deb${distribution_VERSION_ID})
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL program)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME salbench)
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION
"benchmark of 3D saliency models
How well does a program predict which points of a shape people find important?
salbench takes meshes, simulated range scans of them and point clouds through
normals, descriptors, saliency models, histogram matching and metrics, scores
models against the published ones, and keeps every intermediate in a cache.
.
The recommended package draws conclusions from the scores, and makes the
report: figures and tables as pages that open from disk.")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS python3-salbench)
if(SALBENCH_PYTHON)
  list(APPEND CPACK_COMPONENTS_ALL python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-salbench)
  set(CPACK_COMPONENT_PYTHON_DESCRIPTION
"benchmark of 3D saliency models (Python 3)
Metrics, saliency models, descriptors, simulated scans and data sets of
salbench as functions on NumPy arrays, and its whole benchmark as a function
call, with models that are functions of Python. Conclusions from scores, and
the report of a run.")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  # Compiled for one version of Python.
  math(EXPR next "${Python_VERSION_MINOR} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
    "python3 (>= 3.${Python_VERSION_MINOR}), python3 (<< 3.${next}), python3-numpy, salbench (= ${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE})")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS "libjs-three, python3-h5py, python3-jinja2, python3-matplotlib, python3-pandas, python3-pil, python3-scipy, python3-tqdm, python3-yaml")
endif()
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/cmake/DebianForm.cmake)
set(CPACK_SALBENCH_DATE ${SALBENCH_DATE})
include(CPack)
