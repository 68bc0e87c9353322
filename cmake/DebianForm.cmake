# SPDX-License-Identifier: GPL-3.0-or-later
# Brings the files of the package into the form that Debian's policy asks for (chapter 12): compressed manual pages and
# changelogs, and a copyright file in place of the licence, whose text every Debian system has. Run by cpack.

set(share ${CPACK_TEMPORARY_INSTALL_DIRECTORY}/usr/share)
set(documents ${share}/doc/salbench)
if(NOT IS_DIRECTORY ${documents})
  message(FATAL_ERROR "${documents} is not there: what is to be packaged?")
endif()
file(REMOVE ${documents}/LICENSE ${share}/man/man1/salbench-engine.1)
file(CREATE_LINK salbench.1.gz ${share}/man/man1/salbench-engine.1.gz SYMBOLIC)
file(RENAME ${documents}/CHANGELOG.md ${documents}/changelog)
file(WRITE ${documents}/copyright
"Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/
Upstream-Name: salbench

Files: *
Copyright: 2026 The salbench maintainers
License: GPL-3+

License: GPL-3+
 This program is free software: you can redistribute it and/or modify it under
 the terms of the GNU General Public License as published by the Free Software
 Foundation, either version 3 of the License, or (at your option) any later
 version.
 .
 This program is distributed in the hope that it will be useful, but WITHOUT
 ANY WARRANTY; without even the implied warranty of MERCHANTABILITY or FITNESS
 FOR A PARTICULAR PURPOSE. See the GNU General Public License for more details.
 .
 On Debian systems the full text of the GNU General Public License version 3 is
 in /usr/share/common-licenses/GPL-3.
")

execute_process(COMMAND date -R -u -d ${CPACK_SALBENCH_DATE} OUTPUT_VARIABLE date
  OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
file(WRITE ${documents}/changelog.Debian
"salbench (${CPACK_PACKAGE_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}) unstable; urgency=medium

  * Version ${CPACK_PACKAGE_VERSION}: see changelog.gz.

 -- ${CPACK_PACKAGE_CONTACT}  ${date}
")
execute_process(COMMAND gzip -9n man/man1/salbench.1 doc/salbench/changelog doc/salbench/changelog.Debian
  WORKING_DIRECTORY ${share} COMMAND_ERROR_IS_FATAL ANY)
