// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Angle of (x, y), rad, equal to the bit to glibc up to 2.40, whose formulas are those of fdlibm [sun1993].
extern "C" float salbench_atan2f(float y, float x) noexcept;
