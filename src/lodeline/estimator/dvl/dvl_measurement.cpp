#include "lodeline/estimator/dvl/dvl_measurement.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "lodeline/estimator/dvl/dvl_states.h"

namespace lodeline {
namespace {

/// Velocity of the instrument by all rows of a ping; empty where they do not determine it, and where a wrong
/// beam would not show: three axes come from an instrument that has compared its beams, three beams do not.
std::optional<Vec3> velocityOf(const DvlPing& ping) {
  constexpr double kWorstCondition = 1e-2, kGreatestResidual_sigmas = 5.0;
  const auto rows = static_cast<Eigen::Index>(ping.rows.size());
  if (rows < 3) return std::nullopt;
  Eigen::MatrixX3d directions(rows, 3);
  Eigen::VectorXd velocities(rows);
  for (Eigen::Index i = 0; i < rows; ++i) {
    directions.row(i) = ping.rows[static_cast<size_t>(i)].direction_D.transpose();
    velocities[i] = ping.rows[static_cast<size_t>(i)].velocity_m_per_s;
  }
  Eigen::ColPivHouseholderQR<Eigen::MatrixX3d> qr(directions);
  qr.setThreshold(kWorstCondition);
  if (qr.rank() < 3) return std::nullopt;
  const Vec3 velocity_D = qr.solve(velocities);
  const double residual = (directions * velocity_D - velocities).norm();
  const bool is_certain = ping.is_velocity || rows > 3;
  if (!is_certain || residual > kGreatestResidual_sigmas * ping.sigma_m_per_s) return std::nullopt;
  return velocity_D;
}

}  // namespace

std::vector<Factor> DvlMeasurement::factors(const MeasurementContext& context) const {
  const DvlStates states(context.window);
  std::vector<Factor> factors;
  Frame& frame = context.frame;
  if (!states || !frame.has_motion) return factors;
  const DvlLinearizationPoints points{frame.firstPose(), frame.firstMotion(),
                                      states.scale->linearizationPoint(),
                                      states.misalignment->linearizationPoint(),
                                      states.current ? states.current->linearizationPoint() : nullptr};
  const auto loss = std::make_shared<ceres::CauchyLoss>(robust_scale_sigmas);
  for (const DvlPing& ping : pings) {
    if (ping.isThroughWater() && !states.current) continue;
    for (const DvlRow& row : ping.rows) {
      Factor& factor = factors.emplace_back();
      factor.function = std::make_unique<DvlFactor>(row.direction_D, row.velocity_m_per_s, ping.sigma_m_per_s,
                                                    ping.geometry, points);
      factor.loss = loss;
      factor.blocks = {frame.pose.data(), frame.motion.data(), states.scale->value.data(),
                       states.misalignment->value.data()};
      if (ping.isThroughWater()) factor.blocks.push_back(states.current->value.data());
    }
  }
  return factors;
}

double DvlMeasurement::speedInformation() const {
  double information = 0.0;
  for (const DvlPing& ping : pings) {
    if (ping.isThroughWater()) continue;
    // Noise alone has a mean square of 1 for each row.
    double squares = -static_cast<double>(ping.rows.size());
    for (const DvlRow& row : ping.rows) squares += std::pow(row.velocity_m_per_s / ping.sigma_m_per_s, 2);
    information += std::max(0.0, squares);
  }
  return information;
}

std::optional<CarriedVelocity> DvlMeasurement::velocity() const {
  for (auto ping = pings.rbegin(); ping != pings.rend(); ++ping) {
    const std::optional<Vec3> velocity_D = ping->isThroughWater() ? std::nullopt : velocityOf(*ping);
    if (!velocity_D) continue;
    const Rigid3& body_from_dvl = ping->geometry.body_from_dvl;
    const PingMotion& motion = ping->geometry.motion;
    const Vec3 body_B = body_from_dvl.rotation * *velocity_D -
                        (motion.rate_B - motion.gyroscope_bias_B).cross(body_from_dvl.translation);
    CarriedVelocity carried;
    carried.velocity_B = motion.rotation.conjugate() * (body_B + motion.velocity_change);
    carried.elapsed_s = motion.elapsed_s;
    constexpr double kAcross = 2.0;  // sigma of the velocity across the axis of the beams over that of a beam
    carried.sigma_m_per_s = std::hypot(kAcross * ping->sigma_m_per_s, calibration_sigma * velocity_D->norm());
    return carried;
  }
  return std::nullopt;
}

}  // namespace lodeline
