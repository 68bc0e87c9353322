// SPDX-License-Identifier: GPL-3.0-or-later
// Loaded into the program by LD_PRELOAD: Embree cannot be started, which no data and no user is to blame for.
extern "C" void* rtcNewDevice(const char* /*configuration*/) { return nullptr; }
