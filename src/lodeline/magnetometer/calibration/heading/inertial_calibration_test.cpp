#include "lodeline/magnetometer/calibration/heading/inertial_calibration.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "lodeline/diagnostics.h"
#include "lodeline/magnetometer/calibration/heading/test_turning_sensor.h"

namespace lodeline {
namespace {

using namespace inertial_parameter;

/// Initial values with small errors, as from the ellipsoid and the alignment.
InertialParameters startFor(const test::TurningSensor& sensor) {
  InertialParameters start = sensor.truth;
  start.soft_iron += 0.005 * Mat3::Identity();
  start.hard_iron += Vec3(0.004, -0.003, 0.002);
  start.body_from_magnetometer = so3::exp(Vec3(0.01, 0.005, -0.01)) * sensor.truth.body_from_magnetometer;
  start.time_offset_s += 1e-3;
  start.dip_rad = 0.0;
  return start;
}

ImuNoise noiseOf(const test::TurningSensor& sensor) {
  ImuNoise noise;
  noise.gyroscope_density_rad_per_s_sqrtHz = sensor.gyroscope_density;
  return noise;
}

InertialCalibration calibrated(const test::TurningSensor& sensor,
                               const InertialCalibrationOptions& options = {}) {
  return calibrateWithInertialSensors(sensor.field(), sensor.imu(), noiseOf(sensor), startFor(sensor),
                                      options);
}

Eigen::Matrix<double, 12, 1> errorOf(const InertialParameters& p, const InertialParameters& truth) {
  Eigen::Matrix<double, 12, 1> error;
  error << symmetricEntries(p.soft_iron - truth.soft_iron), p.hard_iron - truth.hard_iron,
      so3::log(p.body_from_magnetometer * truth.body_from_magnetometer.conjugate());
  return error;
}

TEST(InertialCalibration, ErrorsAgreeWithTheirCovarianceAndNoiseIsFound) {
  constexpr int kRuns = 8;
  double sum = 0.0;
  for (unsigned seed = 1; seed <= kRuns; ++seed) {
    test::TurningSensor sensor;
    sensor.seed = seed;
    const InertialCalibration result = calibrated(sensor);
    const auto error = errorOf(result.parameters, sensor.truth);
    sum += error.dot(result.covariance.topLeftCorner<12, 12>().ldlt().solve(error));
    EXPECT_LT(error.head<9>().norm(), 2e-3) << seed;
    EXPECT_LT(error.tail<3>().norm(), 2e-3) << seed;
    EXPECT_NEAR(result.reading_sigma, sensor.field_sigma, 0.05 * sensor.field_sigma);
    EXPECT_TRUE(result.time_offset_significant);
    EXPECT_NEAR(result.measured_time_offset_s, sensor.truth.time_offset_s, 5.0 * result.time_offset_sigma_s);
    EXPECT_LT(result.time_offset_sigma_s, 2e-4);
    EXPECT_LT(result.gyroscope_noise_factor, 3.0);
  }
  // The mean of chi-square with 12 degrees of freedom over the runs: 12 +- 3 sigma.
  EXPECT_NEAR(sum / kRuns, 12.0, 3.0 * std::sqrt(24.0 / kRuns));
}

TEST(InertialCalibration, HoldsATimeOffsetThatIsNotSignificantAtZero) {
  test::TurningSensor sensor;
  sensor.duration_s = 15.0;
  sensor.truth.time_offset_s = 0.0;
  const InertialCalibration result = calibrated(sensor);
  EXPECT_FALSE(result.time_offset_significant);
  EXPECT_EQ(result.parameters.time_offset_s, 0.0);
}

TEST(InertialCalibration, ReadingsOfOneKilohertzShareOrientations) {
  test::TurningSensor sensor;
  sensor.duration_s = 15.0;
  sensor.field_rate_hz = 1000.0;
  sensor.field_sigma = 5e-3;
  const InertialCalibration result = calibrated(sensor);
  EXPECT_LT(errorOf(result.parameters, sensor.truth).norm(), 5e-3);
  EXPECT_NEAR(result.reading_sigma, sensor.field_sigma, 0.05 * sensor.field_sigma);
}

TEST(InertialCalibration, LeavesOutReadingsThatPointTheWrongWay) {
  test::TurningSensor sensor;
  sensor.duration_s = 15.0;
  std::vector<NormalizedFieldSample> field = sensor.field();
  const Quat turn = so3::exp(Vec3(0.2, 0.1, 0.0));
  const Mat3 correction = sensor.truth.soft_iron.inverse();
  for (size_t i = 100; i < 120; ++i) {
    // The magnitude is correct, so the ellipsoid fit cannot detect it.
    const Vec3 corrected = turn * (correction * (field[i].field_M - sensor.truth.hard_iron));
    field[i].field_M = sensor.truth.soft_iron * corrected + sensor.truth.hard_iron;
  }
  const InertialCalibration result =
      calibrateWithInertialSensors(field, sensor.imu(), noiseOf(sensor), startFor(sensor), {});
  EXPECT_NEAR(result.rejected_share, 20.0 / 750.0, 5.0 / 750.0);
  EXPECT_LT(errorOf(result.parameters, sensor.truth).norm(), 5e-3);
}

TEST(InertialCalibration, HoldsWhatTheModelLeavesOutAndWidensTheCovariance) {
  test::TurningSensor sensor;
  sensor.duration_s = 15.0;
  InertialCalibrationOptions options;
  options.model = IronModel::Offset;
  const InertialCalibration result = calibrated(sensor, options);
  EXPECT_LT((result.parameters.soft_iron - startFor(sensor).soft_iron).norm(), 1e-12);
  EXPECT_GT(std::sqrt(result.covariance(kHardIron, kHardIron)), 1e-3);
  EXPECT_NEAR(std::sqrt(result.covariance(3, 3)), options.left_out_skew_sigma, 1e-9);
}

TEST(InertialCalibration, RefusesWhatItCannotSolve) {
  test::TurningSensor sensor;
  std::vector<NormalizedFieldSample> few = sensor.field();
  few.resize(20);
  EXPECT_THROW(calibrateWithInertialSensors(few, sensor.imu(), noiseOf(sensor), startFor(sensor), {}),
               EstimationError);
  // A vertical field has no heading.
  sensor.truth.dip_rad = M_PI / 2.0;
  sensor.motion.a.setZero();
  sensor.motion.b.setZero();
  sensor.field_sigma = 0.0;
  EXPECT_THROW(calibrateWithInertialSensors(sensor.field(), sensor.imu(), noiseOf(sensor), sensor.truth, {}),
               EstimationError);
}

}  // namespace
}  // namespace lodeline
