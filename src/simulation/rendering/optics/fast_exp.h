#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>

namespace lodeline {

/// 2^x for x <= 0 to 2e-5 relative, at least 2^-125. It splits x into an exponent and a polynomial on [0, 1)
/// (Taylor's series of 2^x to fifth order about 1/2). Light transport needs millions of these per image;
/// without branches, compilers compute four or more at once.
inline float fastExp2(float x) {
  const float bounded = std::max(x, -125.0f);
  const int whole = static_cast<int>(bounded) - 1;  // one below the truncation, so that the remainder is 0..1
  const float f = (bounded - static_cast<float>(whole) - 0.5f) * 0.6931472f;
  const float series =
      1.0f + f * (1.0f + f * (0.5f + f * (0.16666667f + f * (0.041666667f + f * 0.0083333333f))));
  return std::bit_cast<float>((whole + 127) << 23) * 1.4142136f * series;
}

/// e^x for x <= 0.
inline float fastExp(float x) { return fastExp2(x * 1.4426950f); }

/// Base-2 logarithm of a positive normal number to 0.01, from its exponent and a parabola over the mantissa.
inline float roughLog2(float x) {
  const int32_t bits = std::bit_cast<int32_t>(x);
  const float mantissa = std::bit_cast<float>((bits & 0x007FFFFF) | 0x3F800000);
  return static_cast<float>((bits >> 23) - 128) + mantissa * (2.0f - 0.33333333f * mantissa) - 0.66f;
}

}  // namespace lodeline
