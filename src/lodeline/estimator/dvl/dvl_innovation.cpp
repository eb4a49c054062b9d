#include "lodeline/estimator/dvl/dvl_innovation.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <iterator>
#include <vector>

#include "lodeline/estimator/dvl/dvl_states.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

constexpr int kMotionStart = kPoseTangentSize, kScaleStart = kMotionStart + kMotionSize,
              kMisalignmentStart = kScaleStart + 1, kCurrentStart = kMisalignmentStart + kMisalignmentSize;
constexpr int kRowSize = kCurrentStart + kWaterCurrentSize;
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

/// A parameter block and its place in a row of RowJacobians.
struct RowBlock {
  const double* value;
  int start;
};

/// Covariance of the blocks, stacked, and zero elsewhere; empty where one of them is not known.
Eigen::MatrixXd stackedCovariance(const JointCovariance& known, const std::vector<RowBlock>& blocks) {
  for (const RowBlock& block : blocks) {
    if (!known.knows(block.value)) return {};
  }
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(kRowSize, kRowSize);
  for (const RowBlock& row : blocks) {
    for (const RowBlock& column : blocks) {
      const Eigen::MatrixXd part = known.between(row.value, column.value);
      covariance.block(row.start, column.start, part.rows(), part.cols()) = part;
    }
  }
  return covariance;
}

/// Covariance of the states of a row of the newest frame, with pose and motion of the frame before; empty
/// where one of them is not known.
Eigen::MatrixXd covarianceBefore(const Frame& before, const DvlStates& states, bool is_through_water,
                                 const JointCovariance& known) {
  std::vector<RowBlock> blocks = {{before.pose.data(), 0},
                                  {before.motion.data(), kMotionStart},
                                  {states.scale->value.data(), kScaleStart},
                                  {states.misalignment->value.data(), kMisalignmentStart}};
  if (!is_through_water) return stackedCovariance(known, blocks);
  const double* current = states.current->value.data();
  const bool is_current_known = known.knows(current);
  if (is_current_known) blocks.push_back({current, kCurrentStart});
  Eigen::MatrixXd covariance = stackedCovariance(known, blocks);
  if (!is_current_known && covariance.size() > 0)
    covariance.diagonal().tail<kWaterCurrentSize>().setConstant(
        std::pow(DvlStates::kCurrentSigma_m_per_s, 2));
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
  const bool is_through_water = ping.isThroughWater();
  const Frame& newest = window.newest();
  const Frame& before = **std::prev(window.frames().end(), 2);
  const double* values[] = {newest.pose.data(), newest.motion.data(), states.scale->value.data(),
                            states.misalignment->value.data(),
                            is_through_water ? states.current->value.data() : nullptr};
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
    Eigen::RowVector3d by_misalignment, by_current = Eigen::RowVector3d::Zero();
    double by_scale = 0.0;
    double* jacobians[] = {by_pose.data(), by_motion.data(), &by_scale, by_misalignment.data(),
                           by_current.data()};
    DvlFactor(row.direction_D, row.velocity_m_per_s, 1.0, ping.geometry)
        .Evaluate(values, &innovation.value_m_per_s[i], jacobians);
    by.row(i) << by_pose.head<kPoseTangentSize>(), by_motion, by_scale, by_misalignment, by_current;
    innovation.measured_m_per_s[i] = row.velocity_m_per_s;
    predicted[i] = innovation.value_m_per_s[i] + row.velocity_m_per_s;
  }
  const Eigen::MatrixXd blocks = covarianceBefore(before, states, is_through_water, known);
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
