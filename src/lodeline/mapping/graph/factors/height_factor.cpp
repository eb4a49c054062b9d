#include "lodeline/mapping/graph/factors/height_factor.h"

#include <cmath>
#include <string>

#include "lodeline/diagnostics.h"
#include "lodeline/mapping/graph/factors/whitening.h"

namespace lodeline {

namespace {

void check(double value_m, double sigma_m, const std::string& what) {
  if (!std::isfinite(value_m)) throw InputError(what + ": the value is not finite");
  if (!(sigma_m > 0.0) || !std::isfinite(sigma_m)) throw InputError(what + ": sigma must be positive");
}

}  // namespace

HeightFactor::HeightFactor(double height_m, double sigma_m) : height_m_(height_m), sigma_m_(sigma_m) {
  check(height_m, sigma_m, "height");
}

bool HeightFactor::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  *residuals = (parameters[0][2] + *parameters[1] - height_m_) / sigma_m_;
  if (!jacobians) return true;
  if (jacobians[0]) {
    Eigen::Matrix<double, 1, 6> derivative = Eigen::Matrix<double, 1, 6>::Zero();
    derivative[2] = 1.0 / sigma_m_;
    writePoseJacobian<1>(derivative, jacobians[0]);
  }
  if (jacobians[1]) *jacobians[1] = 1.0 / sigma_m_;
  return true;
}

OriginDepthFactor::OriginDepthFactor(double depth_m, double sigma_m) { set(depth_m, sigma_m); }

void OriginDepthFactor::set(double depth_m, double sigma_m) {
  check(depth_m, sigma_m, "depth of the origin");
  depth_m_ = depth_m;
  sigma_m_ = sigma_m;
}

bool OriginDepthFactor::Evaluate(double const* const* parameters, double* residuals,
                                 double** jacobians) const {
  *residuals = (*parameters[0] + *parameters[1] - depth_m_) / sigma_m_;
  for (int i = 0; jacobians && i < 2; ++i) {
    if (jacobians[i]) *jacobians[i] = 1.0 / sigma_m_;
  }
  return true;
}

}  // namespace lodeline
