#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>

namespace lodeline {

/// 2^x for x <= 0 to 2e-5 relative, zero below -120: split into an exponent and a polynomial on [0, 1)
/// (Taylor's series of 2^x to fifth order about 1/2). Light transport needs millions of these a picture.
inline float fastExp2(float x) {
  if (x < -120.0f) return 0.0f;
  const int whole = static_cast<int>(x) - 1;  // x <= 0: one below the truncation, so that the rest is 0..1
  const float f = (x - static_cast<float>(whole) - 0.5f) * 0.6931472f;
  const float series =
      1.0f + f * (1.0f + f * (0.5f + f * (0.16666667f + f * (0.041666667f + f * 0.0083333333f))));
  return std::bit_cast<float>(static_cast<uint32_t>(whole + 127) << 23) * 1.4142136f * series;
}

/// e^x for x <= 0.
inline float fastExp(float x) { return fastExp2(x * 1.4426950f); }

}  // namespace lodeline
