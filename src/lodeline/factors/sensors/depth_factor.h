#pragma once

#include <ceres/cost_function.h>

#include "lodeline/factors/parameters.h"
#include "lodeline/geometry/rigid3.h"

namespace lodeline {

/// Depth readings of one frame, carried from their own times to that of the frame by the vertical speed of
/// the pressure port.
struct CarriedDepth {
  double depth_m = 0.0;  ///< mean of the readings, positive down
  /// How much higher the port is at the frame than where the readings, lagging by `lag_s`, saw it; m.
  double rise_m = 0.0;
  double rise_by_lag_m_per_s = 0.0;  ///< derivative of rise_m by the lag
  double lag_s = 0.0;                ///< at which rise_m was taken
  int readings = 0;
};

/// Depth read at a frame against the height of its port, 1 residual on the blocks pose (7), depth at the
/// world's origin d_0 (1, m), gauge scale k (1) and lag tau (1, s):
///
///   z = e_z . (p_W + R_W_B p_BP),   rise(tau) = rise_m + rise_by_lag (tau - lag)       m, up
///   e = (depth - d_0 + k (z - rise(tau))) / sigma
///
/// p_BP is the pressure port in the body, k the density of the water over that which the gauge assumes: a
/// gauge reads pressure. Position in the horizontal and heading do not enter; d_0 takes up the surface's
/// pressure and the depth of the start. First estimates as in factors/parameters.h, of the pose and of k;
/// the residual is linear in d_0 and tau. Derivation: docs/depth.md.
class DepthFactor final : public ceres::CostFunction {
 public:
  /// `sigma_m`: of the mean. `first_pose`, `first_scale`: where the Jacobian is taken; null for the current
  /// values. Throws InputError for readings that are not finite, or no positive sigma.
  DepthFactor(const CarriedDepth& depth, const Vec3& port_B_m, double sigma_m,
              const double* first_pose = nullptr, const double* first_scale = nullptr);

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  CarriedDepth depth_;
  Vec3 port_B_;
  double sigma_m_;
  const double* first_pose_;
  const double* first_scale_;
};

}  // namespace lodeline
