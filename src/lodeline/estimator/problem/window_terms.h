#pragma once

#include <vector>

#include "lodeline/estimator/problem/factor_builder.h"
#include "lodeline/estimator/problem/normal_equations.h"

namespace lodeline {

/// Every term of the window's cost.
struct WindowTerms {
  std::vector<Factor> dense;  ///< prior, inertial, magnetometer and depth terms
  std::vector<LandmarkFactors> landmarks;
};

/// What is known of parameter blocks beside all measurements and the prior, whose shape a prior cannot hold
/// or which may change: axes of the gyroscope, places of secondary cameras, priors.
std::vector<Factor> collectGlobalTerms(Window& window, const FactorBuilder& factors);

/// Those of them that are no landmarks', without the prior. Inertial terms whose biases moved too far are
/// integrated again first.
std::vector<Factor> collectMotionTerms(Window& window, const FactorBuilder& factors);

/// In a fixed order: prior, inertial terms by time, magnetometer and depth terms by time, landmarks by
/// track. Inertial terms whose biases moved too far are integrated again first.
WindowTerms collectTerms(Window& window, const Prior& prior, const FactorBuilder& factors);

/// The linear system of all terms at the window's present values, landmarks eliminated.
NormalEquations linearize(const WindowTerms& terms);

}  // namespace lodeline
