#include "lodeline/estimator/uncertainty/covariance_inflation.h"

#include <gtest/gtest.h>

#include <numbers>

#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

using Mat15 = Eigen::Matrix<double, 15, 15>;

Rigid3 heading(double yaw_rad, const Vec3& position_W) {
  return Rigid3(so3::exp(yaw_rad * Vec3::UnitZ()), position_W);
}

/// Moves from one pose to another in steps of frames.
void swim(const Rigid3& from, const Rigid3& to, double scene_distance_m, CovarianceInflation* errors) {
  constexpr int kSteps = 2000;
  const Vec3 turn = so3::log(from.rotation.conjugate() * to.rotation);
  for (int k = 1; k <= kSteps; ++k) {
    const double share = static_cast<double>(k) / kSteps;
    errors->follow(Rigid3(from.rotation * so3::exp(share * turn),
                          from.translation + share * (to.translation - from.translation)),
                   scene_distance_m);
  }
}

Mat15 added(const CovarianceInflation& errors, const EstimateSources& sources) {
  Mat15 covariance = Mat15::Zero();
  errors.addTo(sources, &covariance);
  EXPECT_EQ(covariance.bottomRightCorner(12, 12).norm(), 0.0);
  EXPECT_EQ(covariance.topRightCorner(3, 12).norm(), 0.0);
  return covariance;
}

constexpr EstimateSources kTwoCameras{.is_scale_given = true, .has_magnetometer = true};
constexpr EstimateSources kOneCamera{.is_scale_given = false, .has_magnetometer = true};
const Vec3 kPosition(30.0, 40.0, -20.0);

TEST(CovarianceInflation, OfAStraightWayGrowInProportionToIt) {
  CovarianceInflation errors({});
  errors.follow(heading(0.7, Vec3::Zero()), 2.0);
  EXPECT_EQ(added(errors, kTwoCameras).norm(), 0.0);
  swim(heading(0.7, Vec3::Zero()), heading(0.7, kPosition), 2.0, &errors);
  const double sigma_m = kWayPerWaySigma * kPosition.norm();
  EXPECT_NEAR(
      (added(errors, kTwoCameras).topLeftCorner<3, 3>() - sigma_m * sigma_m * Mat3::Identity()).norm(), 0.0,
      1e-12);
}

TEST(CovarianceInflation, OfATurnGrowWithItsAngleAndTheDistanceOfTheScene) {
  CovarianceInflation errors({});
  errors.follow(heading(0.0, kPosition), 2.0);
  swim(heading(0.0, kPosition), heading(3.0, kPosition), 2.0, &errors);
  const Mat15 covariance = added(errors, kTwoCameras);
  EXPECT_NEAR(std::sqrt(covariance(2, 2)), kWayPerTurnSigma * 2.0 * 3.0, 1e-6);
  // A translation error to one side of the body rotates with the body.
  const double chord = 2.0 * std::sin(1.5);
  EXPECT_NEAR(std::sqrt(covariance(0, 0)), kWayPerTurnSigma * 2.0 * chord, 1e-5);
  swim(heading(3.0, kPosition), heading(0.0, kPosition), 2.0, &errors);
  EXPECT_NEAR(added(errors, kTwoCameras).norm(), 0.0, 1e-6)
      << "what sways back and forth slides back and forth";
}

TEST(CovarianceInflation, OfADirectionCancelOnTheWayBackOnlyWhereTheRigTurnsRound) {
  CovarianceInflation errors({});
  const Vec3 end(20.0, 0.0, 0.0);
  errors.follow(heading(0.0, Vec3::Zero()), std::nullopt);
  swim(heading(0.0, Vec3::Zero()), heading(0.0, end), 0.0, &errors);
  errors.follow(heading(std::numbers::pi, end), std::nullopt);
  swim(heading(std::numbers::pi, end), heading(std::numbers::pi, Vec3::Zero()), 0.0, &errors);
  const Mat15 covariance = added(errors, kTwoCameras);
  EXPECT_NEAR(std::sqrt(covariance(2, 2)), kWayPerWaySigma * 40.0, 1e-9);
  EXPECT_NEAR(covariance.topLeftCorner(2, 2).norm(), 0.0, 1e-9);
}

TEST(CovarianceInflation, OfTurnsBendTheWaySince) {
  constexpr EstimateSources kByImages{.is_scale_given = true, .are_gyroscope_axes_known = false};
  constexpr EstimateSources kByGyroscope{.is_scale_given = true};
  constexpr double kTurn = 2.0, kWay = 10.0;
  CovarianceInflation errors({});
  errors.follow(heading(0.0, Vec3::Zero()), 0.0);
  swim(heading(0.0, Vec3::Zero()), heading(kTurn, Vec3::Zero()), 0.0, &errors);
  const Vec3 end = kWay * Vec3::UnitX();
  swim(heading(kTurn, Vec3::Zero()), heading(kTurn, end), 0.0, &errors);
  Mat15 covariance = Mat15::Zero(), by_way = Mat15::Zero();
  errors.addTo(kByImages, &covariance);
  errors.addTo(kTwoCameras, &by_way);
  covariance -= by_way;
  const double sigma_rad = kTurnPerTurnSigma * kTurn;
  EXPECT_NEAR(covariance(5, 5), sigma_rad * sigma_rad, 1e-9);
  Mat15 held = Mat15::Zero();
  errors.addTo(kByGyroscope, &held);
  EXPECT_NEAR(held(5, 5), std::pow(kHeldTurnPerTurnSigma * kTurn, 2), 1e-9);
  EXPECT_NEAR(covariance(1, 1), std::pow(sigma_rad * kWay, 2), 1e-9);
  EXPECT_NEAR(covariance(1, 5), sigma_rad * sigma_rad * kWay, 1e-9);
  EXPECT_NEAR(covariance(0, 0), 0.0, 1e-12);
  swim(heading(kTurn, end), heading(0.0, end), 0.0, &errors);
  covariance.setZero();
  errors.addTo(kByImages, &covariance);
  EXPECT_NEAR(covariance(5, 5), 0.0, 1e-9) << "what turns back has the same error once more";
}

TEST(CovarianceInflation, OfOneCameraTurnItOnItsWayOutAndBack) {
  const Vec3 end(20.0, 0.0, 0.0);
  CovarianceInflation errors({});
  errors.follow(heading(0.0, Vec3::Zero()), 0.0);
  swim(heading(0.0, Vec3::Zero()), heading(0.0, end), 0.0, &errors);
  const auto byTheWay = [&] {
    Mat15 one = Mat15::Zero(), two = Mat15::Zero();
    errors.addTo({.is_scale_given = false}, &one);
    errors.addTo({.is_scale_given = true}, &two);
    return Mat15(one - two);
  };
  const double sigma_rad = kTurnPerWaySigma_rad_per_m * 20.0;
  EXPECT_NEAR(std::sqrt(byTheWay()(5, 5)), sigma_rad, 1e-9);
  EXPECT_NEAR(std::sqrt(byTheWay()(1, 1)), 0.5 * sigma_rad * 20.0, 1e-4) << "an arc";
  EXPECT_NEAR(byTheWay()(1, 5), 0.5 * sigma_rad * sigma_rad * 20.0, 1e-6);

  errors.follow(heading(std::numbers::pi, end), std::nullopt);
  swim(heading(std::numbers::pi, end), heading(std::numbers::pi, Vec3::Zero()), 0.0, &errors);
  EXPECT_NEAR(std::sqrt(byTheWay()(5, 5)), 2.0 * sigma_rad, 1e-9) << "the camera looks ahead on both";
  EXPECT_NEAR(added(errors, kOneCamera)(5, 5), 0.0, 1e-12) << "a magnetometer holds the heading";
}

TEST(CovarianceInflation, OfOneCameraCountItsScaleToo) {
  CovarianceInflation errors({});
  errors.follow(heading(0.0, kPosition), 2.0);
  const Mat3 position = added(errors, kOneCamera).topLeftCorner<3, 3>();
  EXPECT_NEAR(kPosition.normalized().dot(position * kPosition.normalized()),
              std::pow(kOneCameraScaleSigma * kPosition.norm(), 2), 1e-12);
  EXPECT_NEAR((position * Vec3(40.0, -30.0, 0.0)).norm(), 0.0, 1e-12);
}

TEST(CovarianceInflation, OfTheHeightAreHeldByAPressureSensorUpToItsDensity) {
  CovarianceInflation errors({});
  errors.follow(heading(0.0, Vec3::Zero()), 2.0);
  swim(heading(0.0, Vec3::Zero()), heading(0.0, kPosition), 2.0, &errors);
  const Mat15 free = added(errors, kTwoCameras);
  const Mat15 held = added(errors, {.is_scale_given = true, .density_sigma = 0.001});
  EXPECT_NEAR(held(2, 2), std::pow(kHeldHeightSigma_m, 2) + std::pow(0.001 * 20.0, 2), 1e-12);
  EXPECT_NEAR((held - free).topLeftCorner(2, 2).norm(), 0.0, 1e-15);

  CovarianceInflation at_start(EstimatorOptions{});
  at_start.follow(heading(0.0, kPosition), 2.0);
  EXPECT_NEAR(added(at_start, {.is_scale_given = true, .density_sigma = 0.007})(2, 2),
              std::pow(0.007 * 20.0, 2), 1e-12);
}

TEST(CovarianceInflation, HaveARootWithOneColumnForEachError) {
  for (const bool is_one_camera : {false, true}) {
    for (const bool has_magnetometer : {false, true}) {
      for (const std::optional<double> density : {std::optional<double>(), std::optional<double>(0.004)}) {
        CovarianceInflation errors({});
        errors.follow(heading(0.0, Vec3::Zero()), 2.0);
        swim(heading(0.0, Vec3::Zero()), heading(2.5, kPosition), 2.0, &errors);
        const EstimateSources sources{
            .is_scale_given = !is_one_camera, .density_sigma = density, .has_magnetometer = has_magnetometer};
        const Eigen::Matrix<double, 6, Eigen::Dynamic> root = errors.root(sources);
        ASSERT_EQ(root.cols(), CovarianceInflation::kErrors);
        Mat15 covariance = Mat15::Zero();
        errors.addTo(sources, &covariance);
        EXPECT_GT(covariance.norm(), 1e-3);
        EXPECT_LT((root * root.transpose() - covariance.topLeftCorner<6, 6>()).norm(),
                  1e-9 * covariance.norm());
      }
    }
  }
}

TEST(CovarianceInflation, AreNoneWhereTheCalibrationIsBelieved) {
  EstimatorOptions options;
  options.camera_calibration.enabled = false;
  CovarianceInflation errors(options);
  errors.follow(heading(0.0, Vec3::Zero()), 2.0);
  swim(heading(0.0, Vec3::Zero()), heading(2.0, kPosition), 2.0, &errors);
  EXPECT_EQ(added(errors, {.is_scale_given = false, .density_sigma = 0.007}).norm(), 0.0);
  EXPECT_EQ(errors.root({.is_scale_given = false}).norm(), 0.0);
  EXPECT_EQ(unmodelledDensitySigma(options), 0.0);
}

TEST(CovarianceInflation, OfTheHeadingTurnWayAndSpeedAboutTheOrigin) {
  NavigationState state;
  state.world_from_body = heading(0.3, kPosition);
  state.velocity_W = Vec3(0.2, -0.1, 0.05);
  constexpr double kSigma = 0.05, kTurn = 1e-6;
  Mat15 covariance = Mat15::Zero();
  addHeadingError(kSigma, state, &covariance);
  const Mat3 turned = so3::exp(kTurn * Vec3::UnitZ()).toRotationMatrix();
  Eigen::Matrix<double, 9, 1> moved;
  moved << turned * kPosition - kPosition, kTurn * Vec3::UnitZ(),
      turned * state.velocity_W - state.velocity_W;
  moved *= kSigma / kTurn;
  EXPECT_NEAR((covariance.topLeftCorner<9, 9>() - moved * moved.transpose()).norm(), 0.0, 1e-5);
  EXPECT_EQ(covariance.bottomRightCorner(6, 15).norm(), 0.0);
}

}  // namespace
}  // namespace lodeline
