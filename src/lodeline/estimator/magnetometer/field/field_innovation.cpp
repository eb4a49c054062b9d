#include "lodeline/estimator/magnetometer/field/field_innovation.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "lodeline/ahrs/field_gate.h"
#include "lodeline/estimator/magnetometer/currents/current_states.h"
#include "lodeline/estimator/magnetometer/field/magnetometer_states.h"
#include "lodeline/factors/sensors/magnetometer_field_factor.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

constexpr double kLongestGap_s = 2.0;  // longest gap over which an average continues

}  // namespace

void FieldInnovation::add(const MagnetometerMean& mean, double white_variance_T2, const Window& window,
                          const std::vector<double>& currents_A) {
  const Quat world_from_body = window.newest().worldFromBody().rotation;
  const Vec3 measured_W =
      world_from_body * (mean.field_B - mean.carried * MagnetometerStates(window).offset_B());
  const bool is_continued = measured_W_ && (mean.time - newest_.time).seconds() < kLongestGap_s;
  newest_ = mean;
  currents_A_ = currents_A;
  if (!is_continued) {
    measured_W_ = measured_W;
    white_variance_T2_ = white_variance_T2;
    return;
  }
  // An exponential average of gain g has the variance g / (2 - g) of its terms.
  const double wanted_T2 = options_.gate.field_sigma_T * options_.gate.field_sigma_T;
  const double terms = std::max(1.0, white_variance_T2 / wanted_T2);
  const double gain = 2.0 / (terms + 1.0);
  *measured_W_ += gain * (measured_W - *measured_W_);
  white_variance_T2_ = gain * gain * white_variance_T2 + (1.0 - gain) * (1.0 - gain) * white_variance_T2_;
}

FieldCheck FieldInnovation::check(const Window& window, const JointCovariance& known,
                                  double correlated_noise_sigma_T, bool disturbed) const {
  const MagnetometerStates states(window);
  const Vec3 expected_W = states.field_W() + (disturbed ? states.disturbance_W() : Vec3::Zero());
  const Vec3& measured_W = *measured_W_;
  const Mat3 covariance = differenceCovariance(window, known, disturbed);
  const FieldShape expected = FieldShape::of(expected_W), measured = FieldShape::of(measured_W);
  const double norm_T = expected.norm_T, horizontal_T = expected.horizontal_T();
  const auto sigmaAlong = [&](const Vec3& direction) {
    return std::sqrt(direction.dot(covariance * direction));
  };
  const Vec3 along = expected_W / norm_T;
  const Vec3 across = Vec3::UnitZ().cross(expected_W) / horizontal_T;
  FieldCheck result;
  result.norm_error = measured.norm_T / norm_T - 1.0;
  result.norm_sigma = sigmaAlong(along) / norm_T;
  result.dip_error_rad = measured.dip_rad - expected.dip_rad;
  result.dip_sigma_rad = sigmaAlong(along.cross(across)) / norm_T;
  result.heading_error_rad =
      std::atan2(across.dot(measured_W), measured_W.head<2>().dot(expected_W.head<2>()) / horizontal_T);
  result.heading_sigma_rad = sigmaAlong(across) / horizontal_T;
  result.correlated_sigma_rad = correlated_noise_sigma_T / horizontal_T;
  return result;
}

Mat3 FieldInnovation::differenceCovariance(const Window& window, const JointCovariance& known,
                                           bool disturbed) const {
  const MagnetometerStates states(window);
  const Mat3 world_from_body = window.newest().worldFromBody().rotation.toRotationMatrix();
  FieldNoise noise;
  noise.sigma_T = std::hypot(options_.gate.field_sigma_T, std::sqrt(white_variance_T2_));
  noise.rotation_sigma_rad = newest_.rotation_sigma_rad;
  Mat3 covariance = fieldCovariance_W(states.field_W(), noise);

  // Covariances of the frame before; the gyroscope's error since then is negligible.
  const double* pose = window.frames()[window.frames().size() - 2]->pose.data();
  std::vector<std::pair<const double*, Mat3>> derivatives = {
      {pose, -so3::skew(world_from_body * newest_.field_B)},
      {states.field->value.data(), -Mat3::Identity()},
      {states.offset->value.data(), -world_from_body * newest_.carried}};
  if (disturbed) derivatives.emplace_back(states.disturbance->value.data(), -Mat3::Identity());
  const CurrentStates currents(window, currents_A_.size());
  for (size_t i = 0; i < currents.blocks.size(); ++i) {
    derivatives.emplace_back(currents.blocks[i]->value.data(),
                             -currents_A_[i] * world_from_body * newest_.carried);
  }
  for (const auto& [row, by_row] : derivatives) {
    for (const auto& [column, by_column] : derivatives) {
      if (!known.knows(row) || !known.knows(column)) continue;
      // The rotation is the last half of a pose's perturbation.
      covariance += by_row * known.between(row, column).bottomRightCorner<3, 3>() * by_column.transpose();
    }
  }
  return covariance;
}

}  // namespace lodeline
