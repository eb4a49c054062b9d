#pragma once

#include <numbers>

namespace lodeline {

inline constexpr double kDegree = std::numbers::pi / 180.0;            ///< rad
inline constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;  ///< deg

}  // namespace lodeline
