#include "lodeline/estimator/dvl/dvl_innovation.h"

#include <Eigen/Cholesky>
#include <array>
#include <cmath>
#include <iterator>

#include "lodeline/estimator/dvl/dvl_states.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

constexpr int kMotionStart = kPoseTangentSize, kScaleStart = kMotionStart + kMotionSize,
              kMisalignmentStart = kScaleStart + 1;
constexpr int kRowSize = kMisalignmentStart + kMisalignmentSize;
using RowJacobians = Eigen::Matrix<double, Eigen::Dynamic, kRowSize>;

/// Derivative of [pose, motion] of the newest frame by those of the frame before; positions do not matter.
Eigen::Matrix<double, 15, 15> transition(const Frame& before, const Preintegration& interval) {
  using namespace inertial_error;
  const Mat3 world_from_before = before.worldFromBody().rotation.toRotationMatrix();
  const Preintegration::Mat96& by_bias = interval.biasJacobian();
  Eigen::Matrix<double, 15, 15> by = Eigen::Matrix<double, 15, 15>::Identity();
  by.block<3, 3>(3, 9) = world_from_before * by_bias.block<3, 3>(kTheta, 0);
  by.block<3, 3>(6, 3) = -so3::skew(world_from_before * interval.motion().beta);
  by.block<3, 6>(6, 9) = world_from_before * by_bias.block<3, 6>(kBeta, 0);
  return by;
}

/// Covariance of the blocks, stacked; empty where one of them is not known.
Eigen::MatrixXd stackedCovariance(const JointCovariance& known, const std::array<const double*, 4>& blocks) {
  constexpr std::array<int, 4> kStarts = {0, kMotionStart, kScaleStart, kMisalignmentStart};
  Eigen::MatrixXd covariance(kRowSize, kRowSize);
  for (const double* block : blocks) {
    if (!known.knows(block)) return {};
  }
  for (size_t i = 0; i < blocks.size(); ++i) {
    for (size_t j = 0; j < blocks.size(); ++j) {
      const Eigen::MatrixXd part = known.between(blocks[i], blocks[j]);
      covariance.block(kStarts[i], kStarts[j], part.rows(), part.cols()) = part;
    }
  }
  return covariance;
}

}  // namespace

bool DvlInnovation::agrees(const std::vector<int>& rows, double max_sigmas) const {
  if (covariance.size() == 0) return true;
  const Eigen::VectorXd value = value_m_per_s(rows);
  const Eigen::MatrixXd of_rows = covariance(rows, rows);
  return value.dot(of_rows.ldlt().solve(value)) <=
         chiSquareQuantile(static_cast<int>(rows.size()), max_sigmas);
}

bool DvlInnovation::isTest(double max_sigmas) const {
  if (covariance.size() == 0) return false;
  return 4.0 * measured_m_per_s.squaredNorm() > max_sigmas * max_sigmas * covariance.trace();
}

DvlInnovation innovate(const DvlPing& ping, const Window& window, const JointCovariance& known,
                       double speed_sigma) {
  const DvlStates states(window);
  const Frame& newest = window.newest();
  const Frame& before = **std::prev(window.frames().end(), 2);
  const double* values[] = {newest.pose.data(), newest.motion.data(), states.scale->value.data(),
                            states.misalignment->value.data()};
  const auto rows = static_cast<Eigen::Index>(ping.rows.size());
  RowJacobians by = RowJacobians::Zero(rows, kRowSize);
  DvlInnovation innovation;
  innovation.value_m_per_s.resize(rows);
  innovation.measured_m_per_s.resize(rows);
  Eigen::VectorXd predicted(rows);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const DvlRow& row = ping.rows[static_cast<size_t>(i)];
    Eigen::Matrix<double, 1, kPoseSize> by_pose;
    Eigen::Matrix<double, 1, kMotionSize> by_motion;
    Eigen::RowVector3d by_misalignment;
    double by_scale = 0.0;
    double* jacobians[] = {by_pose.data(), by_motion.data(), &by_scale, by_misalignment.data()};
    DvlFactor(row.direction_D, row.velocity_m_per_s, 1.0, ping.geometry)
        .Evaluate(values, &innovation.value_m_per_s[i], jacobians);
    by.row(i) << by_pose.head<kPoseTangentSize>(), by_motion, by_scale, by_misalignment;
    innovation.measured_m_per_s[i] = row.velocity_m_per_s;
    predicted[i] = innovation.value_m_per_s[i] + row.velocity_m_per_s;
  }
  const Eigen::MatrixXd blocks =
      stackedCovariance(known, {before.pose.data(), before.motion.data(), values[2], values[3]});
  if (blocks.size() == 0 || !newest.from_previous) return innovation;
  const Eigen::MatrixX3d by_change =
      by.middleCols<3>(kMotionStart) * before.worldFromBody().rotation.toRotationMatrix();
  using inertial_error::kBeta;
  const Mat3 of_change = newest.from_previous->covariance().block<3, 3>(kBeta, kBeta);
  by.leftCols<15>() = (by.leftCols<15>() * transition(before, *newest.from_previous)).eval();
  innovation.covariance = by * blocks * by.transpose() + by_change * of_change * by_change.transpose() +
                          speed_sigma * speed_sigma * predicted * predicted.transpose();
  innovation.covariance.diagonal().array() += ping.sigma_m_per_s * ping.sigma_m_per_s;
  return innovation;
}

double chiSquareQuantile(int dof, double sigmas) {
  const double spread = 2.0 / (9.0 * dof);
  return dof * std::pow(1.0 - spread + sigmas * std::sqrt(spread), 3);
}

}  // namespace lodeline
