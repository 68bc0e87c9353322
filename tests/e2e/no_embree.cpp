// SPDX-License-Identifier: GPL-3.0-or-later
// Loaded into the program by LD_PRELOAD: Embree cannot be started, through no fault of data or user.
extern "C" void* rtcNewDevice(const char* /*configuration*/) { return nullptr; }
