#include "lodeline/factors/intrinsics_factor.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>

#include "lodeline/cameras/fit_camera.h"
#include "lodeline/factors/reprojection_scene.h"

namespace lodeline {
namespace {

using Intrinsics = Eigen::VectorXd;

Intrinsics intrinsics(double focal_u, double focal_v, double centre_u_px, double centre_v_px,
                      double k_1 = 0.0, double k_2 = 0.0, double p_1 = 0.0, double p_2 = 0.0,
                      const Vec2& tilt = Vec2::Zero()) {
  return (Intrinsics(kIntrinsicsSize) << focal_u, focal_v, centre_u_px, centre_v_px, k_1, k_2, p_1, p_2, tilt)
      .finished();
}

const Intrinsics kWrongLens =
    intrinsics(0.006, -0.004, 2.5, -1.5, 0.008, -0.01, 0.002, -0.001, Vec2(0.004, -0.003));

/// Pixel of a point by the formula in intrinsics_factor.h.
Vec2 correctedPixel(const CameraCalibration& file, const Intrinsics& lens, const Vec3& point_C) {
  const auto camera = makeCamera(file);
  const Vec2 pixel = *camera->project(point_C);
  Mat23 by_ray;
  const Vec2 place = placeInPlane(camera->model().plane, point_C.normalized(), &by_ray);
  const double squared = place.squaredNorm();
  const double u = place.x(), v = place.y();
  const Vec2 tangential(2.0 * lens[6] * u * v + lens[7] * (squared + 2.0 * u * u),
                        lens[6] * (squared + 2.0 * v * v) + 2.0 * lens[7] * u * v);
  return pixel + lens.head<2>().cwiseProduct(pixel - Vec2(file.cx_px, file.cy_px)) + lens.segment<2>(2) +
         camera->focalLengthsOnAxis_px().cwiseProduct(
             (lens[4] * squared + lens[5] * squared * squared) * place + tangential +
             squared * (squared * lens.tail<2>() + 1.5 * lens.tail<2>().dot(place) * place));
}

/// Measurement of the scene's landmark by a camera with corrected intrinsics `lens`, interpreted with the
/// intrinsics of the file. A model without these coefficients cannot describe every such lens; the formula
/// then gives the pixel.
DirectionMeasurement seenThrough(const CameraCalibration& file, const Intrinsics& lens, const Vec3& point_C,
                                 double sigma_px) {
  const CameraModel* corrected = findCameraModel(cameraModel(file).radial_model);
  const bool has_all = corrected && corrected->tangential_at && lens.tail<2>().isZero();
  const Vec2 pixel = has_all ? *makeCamera(correctedIntrinsics(file, lens.data()))->project(point_C)
                             : correctedPixel(file, lens, point_C);
  const auto camera = makeCamera(file);
  return DirectionMeasurement::fromBearing(*camera, *camera->unproject(pixel), sigma_px);
}

class IntrinsicsOfAModel : public testing::TestWithParam<std::string> {
 protected:
  ReprojectionScene scene_;
  CameraCalibration file_ = withModel(GetParam());

  IntrinsicsFactor factor(const DirectionMeasurement& measurement) const {
    return {std::make_unique<HostReprojectionFactor>(measurement, scene_.base(), Rigid3()), measurement};
  }
};

TEST_P(IntrinsicsOfAModel, LeaveNothingAtTheTrueLens) {
  constexpr double kSigma_px = 0.5;
  const IntrinsicsFactor with = factor(seenThrough(file_, kWrongLens, scene_.point_host_C, kSigma_px));
  const double uncorrected = kSigma_px * evaluate(with, {scene_.landmark(), intrinsics(0, 0, 0, 0)}).norm();
  const double corrected = kSigma_px * evaluate(with, {scene_.landmark(), kWrongLens}).norm();
  EXPECT_GT(uncorrected, 1.0);
  // The remaining error is of second order, plus the difference of the models beyond the fourth power.
  EXPECT_LT(corrected, 0.06);
}

// Near the border the radial profile changes most. A focal length would absorb what the block leaves
// unexplained there.
TEST_P(IntrinsicsOfAModel, ExplainAWrongProfileOutToTheBorder) {
  constexpr double kBorder_rad = 0.75;
  const Intrinsics profile = intrinsics(0.0, 0.0, 0.0, 0.0, 0.01, -0.012, 0.002, -0.001);
  for (double angle_rad = 0.05; angle_rad < kBorder_rad; angle_rad += 0.05) {
    const Vec3 ray(0.6 * std::sin(angle_rad), -0.8 * std::sin(angle_rad), std::cos(angle_rad));
    const DirectionMeasurement seen = seenThrough(file_, profile, ray, 1.0);
    const Vec2 by_file_px = directionResidual(seen, ray, nullptr);
    EXPECT_LT((by_file_px + intrinsicsShift(seen, by_file_px, profile.data())).norm(), 0.02) << angle_rad;
  }
}

TEST_P(IntrinsicsOfAModel, GiveTheRayThatTheTrueLensMakesOfAPixel) {
  const DirectionMeasurement seen = seenThrough(file_, kWrongLens, scene_.point_host_C, 0.5);
  const Vec3 truth = scene_.point_host_C.normalized();
  const double by_file_rad = (seen.bearing_C - truth).norm();
  ASSERT_GT(by_file_rad, 0.002);
  EXPECT_LT((rayThrough(seen, kWrongLens.data()) - truth).norm(), 0.03 * by_file_rad);
  EXPECT_LT((rayThrough(seen, Intrinsics::Zero(kIntrinsicsSize).eval().data()) - seen.bearing_C).norm(),
            1e-12);
}

TEST_P(IntrinsicsOfAModel, AreNothingToARightLens) {
  const IntrinsicsFactor right =
      factor(seenThrough(file_, Intrinsics::Zero(kIntrinsicsSize), scene_.point_host_C, 0.5));
  EXPECT_LT(evaluate(right, {scene_.landmark(), Intrinsics::Zero(kIntrinsicsSize)}).norm(), 1e-6);
}

TEST_P(IntrinsicsOfAModel, HaveTheJacobianOfTheirResidual) {
  expectJacobiansMatch(factor(seenThrough(file_, kWrongLens, scene_.point_host_C, 0.5)),
                       {scene_.landmark(), kWrongLens});
}

TEST_P(IntrinsicsOfAModel, CountInSigmas) {
  const auto fine = seenThrough(file_, kWrongLens, scene_.point_host_C, 0.5);
  const auto coarse = seenThrough(file_, kWrongLens, scene_.point_host_C, 1.0);
  const Vec2 residual(0.3, -0.2);
  const IntrinsicsEffect of_fine = intrinsicsEffect(fine, 2.0 * residual, kWrongLens.data());
  const IntrinsicsEffect of_coarse = intrinsicsEffect(coarse, residual, kWrongLens.data());
  EXPECT_LT((of_fine.by_intrinsics - 2.0 * of_coarse.by_intrinsics).norm(), 1e-9);
  EXPECT_LT((of_fine.shift - 2.0 * of_coarse.shift).norm(), 1e-9);
  EXPECT_LT((of_fine.by_residual - of_coarse.by_residual).norm(), 1e-9);
}

/// The intrinsics block that is closest to another lens of the same model: linear least squares over the
/// image.
Intrinsics blockFor(const CameraCalibration& file, const CameraCalibration& truth) {
  const auto camera = makeCamera(file), true_camera = makeCamera(truth);
  Eigen::Matrix<double, kIntrinsicsSize, kIntrinsicsSize> information;
  information.setZero();
  Intrinsics gradient = Intrinsics::Zero(kIntrinsicsSize);
  for (const RayObservation& observation : imageObservations(*camera)) {
    const auto measurement = DirectionMeasurement::fromBearing(*camera, observation.ray_C, 1.0);
    const auto by_block =
        intrinsicsEffect(measurement, Vec2::Zero(), Intrinsics::Zero(kIntrinsicsSize).eval().data())
            .by_intrinsics;
    information += by_block.transpose() * by_block;
    gradient += by_block.transpose() * (*true_camera->project(observation.ray_C) - observation.pixel);
  }
  return information.ldlt().solve(gradient);
}

// The first two parameters of a file may be wrong, whatever the model. The block describes the error over the
// whole image, and the corrected calibration is the true one.
TEST_P(IntrinsicsOfAModel, ServeTheFirstParametersOfTheModel) {
  const auto camera = makeCamera(file_);
  for (size_t k = 0; k <= std::min<size_t>(file_.distortion.size(), 1); ++k) {
    CameraCalibration truth = file_;
    truth.fx_px *= 1.003;
    truth.cy_px += 1.2;
    if (k < truth.distortion.size()) truth.distortion[k] += 0.004;
    const Intrinsics block = blockFor(file_, truth);
    const auto true_camera = makeCamera(truth);
    const auto corrected = makeCamera(correctedIntrinsics(file_, block.data()));
    for (const RayObservation& observation : imageObservations(*camera)) {
      const Vec2 pixel = *true_camera->project(observation.ray_C);
      EXPECT_LT((correctedPixel(file_, block, observation.ray_C) - pixel).norm(), 0.15) << k;
      EXPECT_LT((*corrected->project(observation.ray_C) - pixel).norm(), 0.15) << k;
    }
  }
}

// A shift of the principal point by one pixel moves every point by one pixel. A longer focal length moves
// points at the border only.
TEST_P(IntrinsicsOfAModel, OnTheAxisOnlyTheCentreShows) {
  const auto measurement = DirectionMeasurement::fromBearing(*makeCamera(file_), Vec3::UnitZ(), 1.0);
  Eigen::Matrix<double, 2, kIntrinsicsSize> expected;
  expected.setZero();
  expected.block<2, 2>(0, 2).setIdentity();
  EXPECT_LT((intrinsicsEffect(measurement, Vec2::Zero(), kWrongLens.data()).by_intrinsics - expected).norm(),
            1e-9);
}

// A noisy observation and an exact one must have the same derivative with respect to the intrinsics.
TEST_P(IntrinsicsOfAModel, TakeTheirDerivativeWhereThePointShouldBe) {
  const auto camera = makeCamera(file_);
  const auto seenAt = [&](const Vec2& error_px) {
    return DirectionMeasurement::fromBearing(
        *camera, *camera->unproject(*camera->project(scene_.point_host_C) + error_px), 0.5);
  };
  const DirectionMeasurement exact = seenAt(Vec2::Zero()), noisy = seenAt(Vec2(1.5, -1.0));
  const Vec2 residual = directionResidual(noisy, scene_.point_host_C, nullptr);
  ASSERT_NEAR(residual.norm(), Vec2(1.5, -1.0).norm() / 0.5, 0.05);
  const auto expected = intrinsicsEffect(exact, Vec2::Zero(), kWrongLens.data()).by_intrinsics;
  const auto found = intrinsicsEffect(noisy, residual, kWrongLens.data()).by_intrinsics;
  const auto measured = intrinsicsEffect(noisy, Vec2::Zero(), kWrongLens.data()).by_intrinsics;
  EXPECT_LT((found - expected).norm(), 0.02 * (measured - expected).norm());
}

INSTANTIATE_TEST_SUITE_P(Models, IntrinsicsOfAModel, testing::ValuesIn(modelNames()), modelTestName);

}  // namespace
}  // namespace lodeline
