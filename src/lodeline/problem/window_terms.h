#pragma once

#include <vector>

#include "lodeline/problem/factor_builder.h"
#include "lodeline/problem/normal_equations.h"

namespace lodeline {

/// Every term of the window's cost.
struct WindowTerms {
  std::vector<Factor> dense;  ///< prior, inertial terms and those of the sensors
  std::vector<LandmarkFactors> landmarks;
};

/// Priors of parameter blocks that are not part of the marginalization prior, because it cannot represent
/// their shape or because they may change: axes of the IMU, positions of secondary cameras,
/// ParameterBlock::priors.
std::vector<Factor> collectGlobalTerms(Window& window, const FactorBuilder& factors);

/// All terms without landmarks, except the prior. First, inertial terms whose biases have changed too much
/// are integrated again.
std::vector<Factor> collectMotionTerms(Window& window, const FactorBuilder& factors);

/// All terms in a fixed order: prior, inertial terms by time, those of the sensors by time, landmarks by
/// track. First, inertial terms whose biases have changed too much are integrated again.
WindowTerms collectTerms(Window& window, const Prior& prior, const FactorBuilder& factors);

/// The linear system of all terms at the window's present values, landmarks eliminated.
NormalEquations linearize(const WindowTerms& terms);

}  // namespace lodeline
