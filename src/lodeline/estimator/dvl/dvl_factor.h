#pragma once

#include <ceres/cost_function.h>

#include "lodeline/estimator/dvl/ping_motion.h"
#include "lodeline/factors/parameters.h"
#include "lodeline/rig.h"

namespace lodeline {

constexpr int kMisalignmentSize = 3;
constexpr int kWaterCurrentSize = 3;

/// Linearization points of the blocks (factors/parameters.h); null: the Jacobian is taken at the current
/// value.
struct DvlLinearizationPoints {
  const double* pose = nullptr;
  const double* motion = nullptr;
  const double* scale = nullptr;
  const double* misalignment = nullptr;
  const double* current = nullptr;
};

/// What is constant in the rows of a ping.
struct DvlGeometry {
  Rigid3 body_from_dvl;
  Vec3 gravity_W = Vec3::Zero();  ///< m/s^2
  PingMotion motion;
  DvlTrack track = DvlTrack::Bottom;
};

/// Velocity of a Doppler velocity log along one direction d of its frame D, a beam or an axis: 1 residual on
/// the blocks pose (7, world_from_body) and motion (9) of the frame, scale s (1) and misalignment m (3, rad).
/// A velocity through the water has one block more, the current c_W of the water (3, m/s):
///
///   u   = gamma R^T (v_W - c_W - g elapsed) - beta      body at the time of the ping (PingMotion), m/s
///   v_D = (1 + s) exp(m)^T R_BD^T (u + (w - b_g) x p_BD)        velocity that the instrument shows, m/s
///   e   = (d . v_D - velocity) / sigma
///
/// c_W is zero for a velocity over the bottom. w is the gyroscope's reading at the ping, p_BD the lever arm.
/// s is the error of the speed of sound that the instrument assumes. R_BD exp(m) is the true attitude of the
/// instrument in the body. Derivation: docs/theory/dvl.md.
class DvlFactor final : public ceres::CostFunction {
 public:
  /// Throws InputError for a velocity or a direction that is not finite and a sigma that is not positive.
  DvlFactor(const Vec3& direction_D, double velocity_m_per_s, double sigma_m_per_s,
            const DvlGeometry& geometry, const DvlLinearizationPoints& linearization_points = {});

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  bool isThroughWater() const { return geometry_.track == DvlTrack::Water; }

  Vec3 direction_D_;
  double velocity_;
  double sigma_;
  DvlGeometry geometry_;
  DvlLinearizationPoints first_;
};

}  // namespace lodeline
