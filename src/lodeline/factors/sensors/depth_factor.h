#pragma once

#include <ceres/cost_function.h>

#include "lodeline/factors/parameters.h"
#include "lodeline/types.h"

namespace lodeline {

/// Depth readings of one frame, carried from their own times to the time of the frame by integrating the
/// vertical speed of the pressure port.
struct CarriedDepth {
  double depth_m = 0.0;  ///< mean of the readings, positive down
  /// Rise of the port from the height that the readings show (delayed by the lag `lag_s`) to its height at
  /// the frame; m.
  double rise_m = 0.0;
  double rise_by_lag_m_per_s = 0.0;  ///< derivative of rise_m with respect to the lag
  double lag_s = 0.0;                ///< lag for which rise_m was computed
  int readings = 0;
};

/// Depth measurement of a frame: 1 residual on the blocks pose (7, world_from_body), depth d_0 at the world's
/// origin (1, m), gauge scale k (1) and lag tau (1, s):
///
///   z = e_z . (p_W + R_W_B p_BP),   rise(tau) = rise_m + rise_by_lag (tau - lag)       m, up
///   e = (depth - d_0 + k (z - rise(tau))) / sigma
///
/// p_BP is the position of the pressure port in the body. A gauge measures pressure, so k is the density of
/// the water over the density that the gauge assumes. The residual does not depend on horizontal position or
/// heading; d_0 absorbs the pressure at the surface and the depth of the start. The pose and k have
/// linearization points as in factors/parameters.h; the residual is linear in d_0 and tau. Derivation:
/// docs/theory/pressure.md.
class DepthFactor final : public ceres::CostFunction {
 public:
  /// `sigma_m`: of the mean. `first_pose`, `first_scale`: linearization points; null for the current values.
  /// Throws InputError for readings that are not finite and for a sigma that is not positive.
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
