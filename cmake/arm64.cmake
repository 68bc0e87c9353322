# SPDX-License-Identifier: GPL-3.0-or-later
# Toolchain of scripts/check arm64: Debian's cross compiler, and SALBENCH_SYSROOT with Debian's packages for arm64.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_TRY_COMPILE_PLATFORM_VARIABLES SALBENCH_SYSROOT)
set(CMAKE_SYSROOT ${SALBENCH_SYSROOT})
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
foreach(kind IN ITEMS LIBRARY INCLUDE PACKAGE)
  set(CMAKE_FIND_ROOT_PATH_MODE_${kind} ONLY)
endforeach()
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(ENV{PKG_CONFIG_SYSROOT_DIR} ${SALBENCH_SYSROOT})
set(ENV{PKG_CONFIG_LIBDIR} ${SALBENCH_SYSROOT}/usr/lib/aarch64-linux-gnu/pkgconfig:${SALBENCH_SYSROOT}/usr/share/pkgconfig)
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64 -L ${SALBENCH_SYSROOT})
# FindHDF5 asks the wrapper compiler of this machine, whose folder is another one.
list(APPEND CMAKE_LIBRARY_PATH /usr/lib/aarch64-linux-gnu/hdf5/serial)
list(APPEND CMAKE_INCLUDE_PATH /usr/include/hdf5/serial)
# What a pair is passed in changed with C++17: nothing here is linked with older code that passes any.
set(CMAKE_CXX_FLAGS_INIT -Wno-psabi)
