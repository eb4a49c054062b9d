#include "lodeline/mapping/graph/factors/height_factor.h"

#include <cmath>

#include "lodeline/diagnostics.h"
#include "lodeline/mapping/graph/factors/whitening.h"

namespace lodeline {

HeightFactor::HeightFactor(double height_m, double sigma_m) : height_m_(height_m), sigma_m_(sigma_m) {
  if (!std::isfinite(height_m)) throw InputError("height: the value is not finite");
  if (!(sigma_m > 0.0) || !std::isfinite(sigma_m)) throw InputError("height: sigma must be positive");
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

}  // namespace lodeline
