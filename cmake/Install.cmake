# SPDX-License-Identifier: GPL-3.0-or-later
# What `cmake --install` and `cpack -G DEB` put where beside the Python package (python/CMakeLists.txt), and the manual page, made from help
# texts. Below another prefix than /usr, PYTHONPATH has to name lib/python3/dist-packages.

include(GNUInstallDirs)
set(CMAKE_SKIP_INSTALL_ALL_DEPENDENCY ON)  # cpack would otherwise build every test first
set(documents ${PROJECT_BINARY_DIR}/documents)

install(TARGETS salbench-engine)
install(FILES README.md CHANGELOG.md LICENSE CITATION.cff DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DOCDIR}
  FILES_MATCHING PATTERN *.md PATTERN *.bib PATTERN *.png PATTERN *.svg PATTERN *.csv PATTERN own_model.py PATTERN simulated_gaze.py)
install(FILES docs/examples/read_export.py DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples)
if(NOT SALBENCH_PYTHON)  # the rest is the command salbench and its package
  return()
endif()
install(FILES cmake/completion.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME salbench)

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
  file(GLOB commands CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/python/salbench/commands/*.py)
  add_custom_command(
    OUTPUT ${documents}/salbench.1
    COMMAND ${CMAKE_COMMAND} -E env LC_ALL=C SOURCE_DATE_EPOCH=${epoch} ${HELP2MAN} --no-info
      --include=${PROJECT_SOURCE_DIR}/cmake/manual.include --output=${documents}/salbench.1
      "${PROJECT_SOURCE_DIR}/cmake/manual.sh ${PROJECT_BINARY_DIR}/salbench"
    DEPENDS salbench_python ${commands} cmake/manual.sh cmake/manual.include VERBATIM)
  if(NOT SALBENCH_SANITIZE)  # a build that nobody installs
    set(all ALL)
  endif()
  add_custom_target(salbench_manual ${all} DEPENDS ${documents}/salbench.1)
  file(CREATE_LINK salbench.1 ${documents}/salbench-engine.1 SYMBOLIC)
  install(FILES ${documents}/salbench.1 ${documents}/salbench-engine.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
else()
  message(WARNING "help2man is missing: no manual page will be installed. scripts/setup installs it.")
endif()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME salbench)
set(CPACK_PACKAGE_VENDOR "The salbench maintainers")
set(CPACK_PACKAGE_CONTACT "The salbench maintainers <maintainers@salbench.invalid>")
# Packages of several Debian releases differ in their libraries, and an upgrade of Debian is one of the package.
cmake_host_system_information(RESULT distribution QUERY DISTRIB_INFO)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1~deb${distribution_VERSION_ID})
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "benchmark of 3D saliency models")
set(CPACK_PACKAGE_DESCRIPTION
"How well does a program predict which points of a shape people find important?
salbench takes meshes, simulated range scans of them and point clouds through
normals, descriptors, saliency models, histogram matching and metrics, scores
models against the published ones, and keeps every intermediate in a cache.
.
It is a command and a Python package: metrics, models, descriptors, scans and
data sets as functions on NumPy arrays, and models that are functions of
Python. The recommended packages draw conclusions from the scores, and make the
report: figures and tables as pages that open from disk.")
set(CPACK_DEBIAN_PACKAGE_SECTION science)
# The module is compiled for one version of Python. Scores, metrics and models need no more; conclusions, pages and other people's files need what
# is recommended.
math(EXPR next "${Python_VERSION_MINOR} + 1")
set(CPACK_DEBIAN_PACKAGE_DEPENDS
  "python3 (>= 3.${Python_VERSION_MINOR}), python3 (<< 3.${next}), python3-numpy, python3-yaml")
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS
  "libjs-three, python3-cloudpickle, python3-h5py, python3-jinja2, python3-matplotlib, python3-pandas, python3-pil, python3-scipy")
# The Python package of 1.x, which is a part of this one.
set(CPACK_DEBIAN_PACKAGE_CONFLICTS python3-salbench)
set(CPACK_DEBIAN_PACKAGE_REPLACES python3-salbench)
set(CPACK_DEBIAN_PACKAGE_PROVIDES "python3-salbench (= ${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE})")
# The modules are byte-compiled on installation, and the compiled files go with the package, as Debian's own Python packages do it.
file(WRITE ${documents}/postinst "#!/bin/sh\nset -e\npy3compile -p salbench\n")
file(WRITE ${documents}/prerm "#!/bin/sh\nset -e\npy3clean -p salbench\n")
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${documents}/postinst ${documents}/prerm)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/cmake/DebianForm.cmake)
set(CPACK_SALBENCH_DATE ${SALBENCH_DATE})
include(CPack)
