#include "lodeline/estimator/trials/consistency.h"

#include <Eigen/Cholesky>
#include <cmath>

namespace lodeline {
namespace {

template <int Size>
double nees(const Eigen::Matrix<double, Size, 1>& error,
            const Eigen::Matrix<double, Size, Size>& covariance) {
  return error.dot(covariance.ldlt().solve(error));
}

}  // namespace

NeesSample neesOf(const Comparison& c) {
  const Eigen::Matrix<double, 15, 15>& covariance = c.estimate.covariance;
  Eigen::Matrix<double, 9, 1> motion_error;
  motion_error << c.estimate.state.velocity_W - c.true_velocity_W,
      c.estimate.state.gyroscope_bias_B - c.true_gyroscope_bias_B,
      c.estimate.state.accelerometer_bias_B - c.true_accelerometer_bias_B;
  NeesSample sample;
  sample.pose = nees<6>(c.error, covariance.topLeftCorner<6, 6>());
  sample.position = nees<3>(c.error.head<3>(), covariance.topLeftCorner<3, 3>());
  sample.orientation = nees<3>(c.error.tail<3>(), covariance.block<3, 3>(3, 3));
  sample.yaw = c.error[5] * c.error[5] / covariance(5, 5);
  sample.motion = nees<9>(motion_error, covariance.bottomRightCorner<9, 9>());
  sample.velocity = nees<3>(motion_error.head<3>(), covariance.block<3, 3>(6, 6));
  sample.gyroscope_bias = nees<3>(motion_error.segment<3>(3), covariance.block<3, 3>(9, 9));
  sample.accelerometer_bias = nees<3>(motion_error.tail<3>(), covariance.block<3, 3>(12, 12));
  sample.position_error_m = c.positionError();
  sample.position_sigma_m = std::sqrt(covariance.topLeftCorner<3, 3>().trace());
  sample.yaw_error_rad = c.error[5];
  sample.yaw_sigma_rad = std::sqrt(covariance(5, 5));
  return sample;
}

double ConsistencyRow::mean(double NeesSample::*figure) const {
  double sum = 0.0;
  for (const NeesSample& sample : samples) sum += sample.*figure;
  return sum / static_cast<double>(samples.size());
}

double ConsistencyRow::rootMeanSquare(double NeesSample::*figure) const {
  double sum = 0.0;
  for (const NeesSample& sample : samples) sum += sample.*figure * (sample.*figure);
  return std::sqrt(sum / static_cast<double>(samples.size()));
}

Consistency measureConsistency(const ConsistencyOptions& options) {
  Consistency result;
  for (const double time_s : options.times_s) result.rows.push_back({time_s, {}});
  TestSceneOptions scene_options = options.scene;
  scene_options.duration_s = options.times_s.back() + 0.1;
  for (int seed = 1; seed <= options.seeds; ++seed) {
    scene_options.seed = static_cast<uint64_t>(seed);
    TestScene scene(scene_options);
    ComparedEstimator estimator(scene, options.estimator);
    size_t row = 0;
    while (const auto frame = scene.next()) {
      const Comparison comparison = estimator.add(*frame);
      if (row == result.rows.size() || comparison.time_s < result.rows[row].time_s - 1e-6) continue;
      if (!comparison.initialized()) {
        ++result.lost;
        break;
      }
      result.rows[row++].samples.push_back(neesOf(comparison));
    }
  }
  return result;
}

NeesBounds neesBounds(int coordinates, int count, double quantile) {
  const double n = static_cast<double>(coordinates) * count;
  const double spread = 2.0 / (9.0 * n);
  const auto at = [&](double z) { return coordinates * std::pow(1.0 - spread + z * std::sqrt(spread), 3); };
  return {at(-quantile), at(quantile)};
}

}  // namespace lodeline
