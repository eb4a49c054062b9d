#include "lodeline/estimator/solver/window_update.h"
#include "lodeline/problem/covariance.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "lodeline/estimator/initialization/start.h"
#include "lodeline/estimator/trials/test_window.h"
#include "lodeline/estimator/visual/landmarks.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

void fill(TestWindow& test, double pixel_sigma_px) {
  TestSceneOptions options;
  options.duration_s = 2.5;
  options.points.tracks = 40;
  options.points.frame_rate_hz = 5.0;
  options.points.pixel_sigma_px = pixel_sigma_px;
  TestScene scene(options);
  while (const auto frame = scene.next()) {
    test.add(*frame);
    createLandmarks(test.window, test.factors, test.options.landmark);
  }
}

TEST(WindowUpdate, FindsBackToTheTruth) {
  TestWindow test(2);
  fill(test, 0.1);
  const Prior prior = startPrior(*test.window.frames().front(), test.options.initial_state, 0.05);
  std::vector<Rigid3> truth;
  for (const auto& frame : test.window.frames()) truth.push_back(frame->worldFromBody());
  test.disturb(0.02, 5);
  const SolveSummary summary = updateWindow(test.window, prior, test.factors, {50, 1e-9}).summary;
  EXPECT_TRUE(summary.usable);
  EXPECT_LT(summary.final_cost, 0.01 * summary.initial_cost);
  // A tenth of a pixel: 0.2 mrad per observation, and the corresponding distance at 5 m over the root of 5
  // observations.
  for (size_t k = 0; k < truth.size(); ++k) {
    const auto error = perturbationBetween(truth[k], test.window.frames()[k]->worldFromBody());
    EXPECT_LT(error.head<3>().norm(), 5e-3) << "frame " << k;
    EXPECT_LT(error.tail<3>().norm(), 5e-3) << "frame " << k;
  }
}

TEST(WindowUpdate, StaysWhereItIsAtTheMinimum) {
  TestWindow test(2);
  fill(test, 0.5);
  const Prior prior = startPrior(*test.window.frames().front(), test.options.initial_state, 0.05);
  updateWindow(test.window, prior, test.factors, {100, 1e-14});
  const Rigid3 before = test.window.newest().worldFromBody();
  const SolveSummary again = updateWindow(test.window, prior, test.factors, {10, 1e-9}).summary;
  EXPECT_NEAR(again.final_cost, again.initial_cost, 1e-9 * again.initial_cost);
  EXPECT_LT(perturbationBetween(before, test.window.newest().worldFromBody()).norm(), 1e-6);
}

TEST(WindowUpdate, CovarianceEqualsTheDenseInverse) {
  TestWindow test(2);
  fill(test, 0.5);
  const Prior prior = startPrior(*test.window.frames().front(), test.options.initial_state, 0.05);
  const auto covariance = newestCovariance(test.window, prior, test.factors);
  const DenseSystem dense = denseSystem(test.window, prior, test.factors);
  const Reduced reduced = denseSchur(dense.hessian, dense.gradient, dense.frame_rows);
  const Eigen::VectorXd scale = reduced.hessian.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd inverse =
      scale.asDiagonal() *
      Eigen::MatrixXd(scale.asDiagonal() * reduced.hessian * scale.asDiagonal()).fullPivLu().inverse() *
      scale.asDiagonal();
  // The newest frame's pose and motion are the last 15 rows.
  const Eigen::MatrixXd expected = inverse.bottomRightCorner<15, 15>();
  const Eigen::VectorXd sigmas = expected.diagonal().cwiseSqrt().cwiseInverse();
  EXPECT_LT((sigmas.asDiagonal() * (covariance - expected) * sigmas.asDiagonal()).cwiseAbs().maxCoeff(),
            1e-6);
  EXPECT_EQ(covariance, covariance.transpose());
}

TEST(WindowUpdate, ScaleIsAsSureAsDistanceOrSpeed) {
  Frame frame;
  NavigationState state;
  state.world_from_body.translation = Vec3(0.0, 10.0, 0.0);
  state.velocity_W = Vec3(2.0, 0.0, 0.0);
  frame.setState(state);
  Eigen::Matrix<double, 15, 15> covariance = Eigen::Matrix<double, 15, 15>::Identity();
  covariance(1, 1) = 0.25;  // 0.5 m along a distance of 10 m
  covariance(6, 6) = 0.04;  // 0.2 m/s along 2 m/s
  EXPECT_NEAR(scaleUncertainty(frame, covariance), 0.05, 1e-12);
  covariance(6, 6) = 0.0004;
  EXPECT_NEAR(scaleUncertainty(frame, covariance), 0.01, 1e-12);
  frame.setState({});
  EXPECT_GT(scaleUncertainty(frame, covariance), 1e6) << "at rest at the origin nothing shows the scale";
}

}  // namespace
}  // namespace lodeline
