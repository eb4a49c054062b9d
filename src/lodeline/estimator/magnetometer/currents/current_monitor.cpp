#include "lodeline/estimator/magnetometer/currents/current_monitor.h"

#include <Eigen/Dense>
#include <cmath>

namespace lodeline {
namespace {

constexpr double kChange_s = 1.0;
constexpr double kLongestChange_s = 3.0;
constexpr double kFade_s = 300.0;
constexpr double kFewestChanges = 10.0;           // changes
constexpr double kUsualResidual_T = 0.2e-6;       // before there are residuals
constexpr double kUsualWeight = 5.0;              // changes that this counts for
constexpr double kGreatestField_T_per_A = 10e-6;  // prior, so that channels that never change stay defined
constexpr double kHarmful_T = 0.2e-6;             // half a degree in a horizontal field of 24 uT
constexpr double kCauchy = 2.385;

}  // namespace

CurrentMonitor::CurrentMonitor(size_t channels, double sigma_T_per_A)
    : sigma_T_per_A_(sigma_T_per_A),
      information_A2_(
          Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(channels), static_cast<Eigen::Index>(channels))),
      right_side_A_T_(Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(channels), 3)),
      residual_square_T2_(kUsualWeight * kUsualResidual_T * kUsualResidual_T),
      residual_weight_(kUsualWeight) {}

void CurrentMonitor::add(Time time, const Eigen::VectorXd& currents_A, const Vec3& difference_B,
                         double white_variance_T2) {
  const Sample now{time, currents_A, difference_B};
  const double since_s = last_ ? (time - last_->time).seconds() : 0.0;
  if (last_ && since_s < kChange_s) return;
  if (!last_ || since_s > kLongestChange_s) {
    last_ = now;
    return;
  }
  const Eigen::VectorXd change_A = currents_A - last_->currents_A;
  const Vec3 change_T = difference_B - last_->difference_B;
  last_ = now;
  const Vec3 residual_T = change_T - differences_T_per_A().transpose() * change_A;
  // Where the coefficients are unknown yet, so is the residual.
  const double known_T2 = variance_T2() * (1.0 + change_A.dot(inverse() * change_A));
  const double weight = 1.0 / (1.0 + residual_T.squaredNorm() / 3.0 / (kCauchy * kCauchy * known_T2));
  const double kept = std::exp(-since_s / kFade_s);
  information_A2_ = kept * information_A2_ + weight * change_A * change_A.transpose();
  right_side_A_T_ = kept * right_side_A_T_ + weight * change_A * change_T.transpose();
  // Residuals of changes whose coefficients are unknown yet say little about the noise.
  const double share = weight * variance_T2() / known_T2;
  residual_square_T2_ = kept * residual_square_T2_ + share * residual_T.squaredNorm() / 3.0;
  residual_weight_ = kept * residual_weight_ + share;
  white_square_T2_ = kept * white_square_T2_ + share * 2.0 * white_variance_T2;
}

Eigen::MatrixXd CurrentMonitor::inverse() const {
  Eigen::MatrixXd matrix = information_A2_;
  matrix.diagonal().array() += variance_T2() / (kGreatestField_T_per_A * kGreatestField_T_per_A);
  return matrix.ldlt().solve(Eigen::MatrixXd::Identity(matrix.rows(), matrix.cols()));
}

Eigen::MatrixXd CurrentMonitor::differences_T_per_A() const { return inverse() * right_side_A_T_; }

double CurrentMonitor::leftField_T() const {
  const Eigen::MatrixXd differences = differences_T_per_A();
  const double weight = residual_weight_ - kUsualWeight;
  if (!(weight > 0.0)) return 0.0;
  return std::sqrt((differences.transpose() * information_A2_ * differences).trace() / residual_weight_);
}

bool CurrentMonitor::isContradicted() const {
  if (residual_weight_ < kUsualWeight + kFewestChanges) return false;
  return contradictionOf(differences_T_per_A(), variance_T2() * inverse(), sigma_T_per_A_).isSignificant() &&
         leftField_T() > kHarmful_T;
}

}  // namespace lodeline
