// SPDX-License-Identifier: GPL-3.0-or-later
// PCL's triangulation compares angles from atan2f exactly, so that its faces depend on that function's
// rounding. glibc rounds correctly since 2.41 (Debian 13), and differently before. surface.cpp replaces it by
// this function, which makes surfaces equal for all versions.
#include "stages/surface/atan2f.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

namespace {

constexpr float kPi = 3.14159274F, kPiRest = -8.74227766e-8F;  // pi is their sum
constexpr float kHalfPi = 1.57079637F;

constexpr std::uint32_t magnitude(float x) { return std::bit_cast<std::uint32_t>(x) & 0x7fffffffU; }
constexpr std::int32_t exponent(float x) { return static_cast<std::int32_t>(magnitude(x) >> 23U); }

// Angles about which the arc tangent is expanded, each as a sum of two parts.
struct Angle {
  float value, rest;
};
constexpr std::array<Angle, 4> kAbout = {{{4.6364760399e-01F, 5.0121582440e-09F},
                                          {7.8539812565e-01F, 3.7748947079e-08F},
                                          {9.8279368877e-01F, 3.4473217170e-08F},
                                          {1.5707962513e+00F, 7.5497894159e-08F}}};

// x - atan(x), for |x| < 7/16.
float excess(float x) {
  constexpr std::array<float, 11> c = {3.3333334327e-01F,  -2.0000000298e-01F, 1.4285714924e-01F,
                                       -1.1111110449e-01F, 9.0908870101e-02F,  -7.6918758452e-02F,
                                       6.6610731184e-02F,  -5.8335702866e-02F, 4.9768779427e-02F,
                                       -3.6531571299e-02F, 1.6285819933e-02F};
  const float z = x * x, w = z * z;
  const float even = z * (c[0] + w * (c[2] + w * (c[4] + w * (c[6] + w * (c[8] + w * c[10])))));
  const float odd = w * (c[1] + w * (c[3] + w * (c[5] + w * (c[7] + w * c[9]))));
  return x * (even + odd);
}

// atan(x) for x >= 0, infinity included.
float arcus_tangent(float x) {
  if (x >= 0x1p25F) return kAbout[3].value + kAbout[3].rest;
  if (x < 0x1p-29F) return x;
  if (x < 0.4375F) return x - excess(x);
  std::size_t about = 3;
  float offset = -1 / x;
  if (x < 0.6875F) {
    about = 0;
    offset = (2 * x - 1) / (2 + x);
  } else if (x < 1.1875F) {
    about = 1;
    offset = (x - 1) / (x + 1);
  } else if (x < 2.4375F) {
    about = 2;
    offset = (x - 1.5F) / (1 + 1.5F * x);
  }
  return kAbout[about].value - ((excess(offset) - kAbout[about].rest) - offset);
}

// Angle of a direction in the upper half plane.
float upper_angle(float y, float x) {
  const bool left = std::signbit(x);
  if (y == 0) return left ? kPi : 0;
  if (x == 0) return kHalfPi;
  if (std::isinf(x) && std::isinf(y)) return left ? 3 * (kPi / 4) : kPi / 4;
  if (std::isinf(x)) return left ? kPi : 0;
  if (std::isinf(y)) return kHalfPi;
  const std::int32_t steepness = exponent(y) - exponent(x);
  float angle = 0;
  if (steepness > 60)
    angle = kHalfPi + 0.5F * kPiRest;
  else if (!left || steepness >= -60)
    angle = arcus_tangent(std::fabs(y / x));
  return left ? kPi - (angle - kPiRest) : angle;
}

}  // namespace

float salbench_atan2f(float y, float x) noexcept {
  if (std::isnan(x) || std::isnan(y)) return x + y;
  return std::copysign(upper_angle(std::fabs(y), x), y);
}
