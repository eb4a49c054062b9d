#include "lodeline/estimator/visual/reprojection_system.h"

#include <gtest/gtest.h>

#include "lodeline/estimator/trials/test_window.h"
#include "lodeline/problem/prior_terms.h"

namespace lodeline {
namespace {

enum class Calibrated { No, Placement, PlacementAndLens, PlacementLensAndShutter };

// A window of a moving rig in four versions of the calibration. The value of each block differs from its
// linearization point, as after marginalization.
class ReprojectionSystemTest : public testing::TestWithParam<std::tuple<int, Calibrated, bool>> {
 protected:
  ReprojectionSystemTest() : test_(std::get<0>(GetParam())) {
    prior_ = test_.fill();
    test_.disturb(0.01, 3);
    Frame& second = *test_.window.frames()[1];
    second.first_pose = second.pose;
    (*second.first_pose)[0] += 0.02;
    second.robust_scale_sigmas = 0.3;
    double weight = 0.1;
    for (auto& [id, track] : test_.window.tracks()) track.weight = weight = std::fmod(weight + 0.3, 2.0);
    if (std::get<1>(GetParam()) != Calibrated::No) disturbCalibration();
    if (std::get<2>(GetParam())) interpolate(4);
  }

  // Interpolates the frame between its neighbours, which have moved since.
  void interpolate(size_t index) {
    const auto& frames = test_.window.frames();
    for (auto& [id, track] : test_.window.tracks()) {
      if (track.landmark && track.landmark->host == frames[index]->id) track.landmark.reset();
    }
    test_.window.interpolate(*frames[index], *frames[index - 1], *frames[index + 1]);
    frames[index - 1]->first_pose = frames[index - 1]->pose;
    const Eigen::Matrix<double, 6, 1> moved = Eigen::Matrix<double, 6, 1>::Constant(0.01);
    for (const size_t i : {index - 1, index + 1})
      poseToBlock(perturbed(frames[i]->worldFromBody(), moved), frames[i]->pose.data());
    test_.window.placeInterpolated();
  }

  void disturbCalibration() {
    test_.options.camera_calibration.intrinsics = std::get<1>(GetParam()) >= Calibrated::PlacementAndLens;
    addCameraStates(test_.window, prior_, std::get<0>(GetParam()), test_.options.camera_calibration);
    addIntrinsicsStates(test_.window, prior_, std::get<0>(GetParam()), test_.options.camera_calibration);
    if (hasShutter()) {
      Rig rolling = test_.rig;
      for (CameraCalibration& camera : rolling.cameras)
        camera.line_delay_s = camera.line_delay_sigma_s = 3e-5;
      addShutterState(test_.window, prior_, rolling, test_.options.camera_calibration);
    }
    double offset = 0.0;
    for (const auto& state : test_.window.globals()) {
      state->first = state->value;
      const bool is_shutter = state.get() == cameraStates(test_.window).shutter;
      for (double& value : state->value) value = (is_shutter ? 3e-5 : 1e-3) * std::sin(offset += 1.0);
    }
    for (const auto& frame : test_.window.frames()) {
      frame->gyroscope_B = Vec3(0.3, -0.2, 0.4);
      frame->updateImageMotion();
    }
  }

  bool hasShutter() const { return std::get<1>(GetParam()) == Calibrated::PlacementLensAndShutter; }

  // The factor takes the derivative by the line delay numerically, with the lens at the linearization points.
  double tolerance() const { return hasShutter() ? 1e-5 : 1e-9; }

  // The same system from the factors, one landmark at a time, with the prior first so that rows are in the
  // same order.
  NormalEquations reference() {
    NormalEquations system;
    system.add(test_.factors.prior(prior_));
    for (auto& [id, track] : test_.window.tracks()) {
      if (track.landmark) system.addEliminated(test_.factors.landmark(test_.window, track));
    }
    return system;
  }

  NormalEquations quick(ReprojectionSystem* terms) {
    NormalEquations system;
    PriorTerms(prior_).addTo(&system);
    terms->addTo(&system);
    return system;
  }

  double referenceCost() {
    double cost = 0.0;
    for (auto& [id, track] : test_.window.tracks()) {
      if (!track.landmark) continue;
      for (Factor& factor : test_.factors.landmark(test_.window, track).factors) {
        Vec2 residual;
        factor.function->Evaluate(factor.blocks.data(), residual.data(), nullptr);
        double rho[3];
        factor.loss->Evaluate(residual.squaredNorm(), rho);
        cost += 0.5 * rho[0];
      }
    }
    return cost;
  }

  std::vector<Vec3> landmarks() {
    std::vector<Vec3> values;
    for (auto& [id, track] : test_.window.tracks()) {
      if (track.landmark) values.emplace_back(track.landmark->parameters.data());
    }
    return values;
  }

  TestWindow test_;
  Prior prior_;
};

// Rows of `of` in the order of `as`.
std::vector<int> rowsInOrder(const NormalEquations& of, const NormalEquations& as) {
  std::vector<int> rows;
  for (const NormalEquations::Block& block : as.blocks()) {
    const NormalEquations::Block* found = of.find(block.value);
    for (int i = 0; found && i < block.tangentSize(); ++i) rows.push_back(found->offset + i);
  }
  return rows;
}

TEST_P(ReprojectionSystemTest, EqualTheFactors) {
  ReprojectionSystem terms(test_.window, test_.factors);
  EXPECT_NEAR(terms.cost(), referenceCost(), 1e-10 * referenceCost());
  const NormalEquations expected = reference();
  const NormalEquations system = quick(&terms);
  ASSERT_EQ(system.size(), expected.size());
  const std::vector<int> rows = rowsInOrder(system, expected);
  const Eigen::MatrixXd h = system.hessian()(rows, rows);
  const Eigen::VectorXd scale = expected.hessian().diagonal().cwiseSqrt().cwiseInverse();
  EXPECT_LT((scale.asDiagonal() * (h - expected.hessian()) * scale.asDiagonal()).cwiseAbs().maxCoeff(),
            tolerance());
  const Eigen::VectorXd g = system.gradient()(rows);
  EXPECT_LT(scale.cwiseProduct(g - expected.gradient()).norm(),
            tolerance() * scale.cwiseProduct(expected.gradient()).norm());
}

TEST_P(ReprojectionSystemTest, TakeNewValuesWhenTold) {
  ReprojectionSystem terms(test_.window, test_.factors);
  const double before = terms.cost();
  for (auto& [id, track] : test_.window.tracks()) {
    if (track.landmark) track.landmark->parameters[2] *= 1.01;
  }
  EXPECT_EQ(terms.cost(), before);
  terms.update();
  EXPECT_GT(std::abs(terms.cost() - before), 1e-3 * before);
  EXPECT_NEAR(terms.cost(), referenceCost(), 1e-10 * referenceCost());
}

TEST_P(ReprojectionSystemTest, StepLandmarksLikeTheFactors) {
  const std::vector<Vec3> before = landmarks();
  ASSERT_GT(before.size(), 20u);
  const NormalEquations expected = reference();
  Eigen::VectorXd step(expected.size());
  for (int i = 0; i < step.size(); ++i) step[i] = 1e-3 * std::cos(i);
  if (hasShutter()) {
    const double* shutter = cameraStates(test_.window).shutter->value.data();
    step.segment(expected.find(shutter)->offset, kShutterSize) *= 0.01;
  }
  expected.stepLandmarks(step);
  const std::vector<Vec3> wanted = landmarks();

  size_t next = 0;
  for (auto& [id, track] : test_.window.tracks()) {
    if (track.landmark) Eigen::Map<Vec3>(track.landmark->parameters.data()) = before[next++];
  }
  ReprojectionSystem terms(test_.window, test_.factors);
  const NormalEquations system = quick(&terms);
  Eigen::VectorXd same_step(system.size());
  same_step(rowsInOrder(system, expected)) = step;
  terms.stepLandmarks(system, same_step);
  const std::vector<Vec3> stepped = landmarks();
  for (size_t i = 0; i < wanted.size(); ++i)
    EXPECT_LT((stepped[i] - wanted[i]).norm(), 10.0 * tolerance() * (wanted[i] - before[i]).norm())
        << "landmark " << i;
}

std::string nameOf(const testing::TestParamInfo<std::tuple<int, Calibrated, bool>>& info) {
  constexpr const char* kNames[] = {"CamerasAsTheFilesSay", "CamerasCalibrated", "CamerasWithLenses",
                                    "RollingShutters"};
  return std::to_string(std::get<0>(info.param)) + kNames[static_cast<int>(std::get<1>(info.param))] +
         (std::get<2>(info.param) ? "OneFrameInterpolated" : "");
}

INSTANTIATE_TEST_SUITE_P(Rigs, ReprojectionSystemTest,
                         testing::Combine(testing::Values(1, 2),
                                          testing::Values(Calibrated::No, Calibrated::Placement,
                                                          Calibrated::PlacementAndLens,
                                                          Calibrated::PlacementLensAndShutter),
                                          testing::Bool()),
                         nameOf);

// As after darkness, when every landmark has gone.
TEST(ReprojectionSystem, OfAWindowWithoutLandmarksAreNothing) {
  TestWindow test(2);
  test.add(Rigid3());
  test.add(Rigid3(Quat::Identity(), Vec3(0.0, 0.3, 0.0)));
  ReprojectionSystem terms(test.window, test.factors);
  NormalEquations system;
  terms.addTo(&system);
  EXPECT_EQ(terms.cost(), 0.0);
  EXPECT_EQ(system.gradient().norm(), 0.0);
  EXPECT_EQ(system.hessian().norm(), 0.0);
  terms.stepLandmarks(system, Eigen::VectorXd::Zero(system.size()));
}

// The residual of a point behind a camera is constant, with zero derivatives.
TEST(ReprojectionSystem, BearAPointBehindACamera) {
  TestWindow test(1);
  const Frame& host = test.add(Rigid3());
  const Frame& target = test.add(Rigid3(Quat::Identity(), Vec3(0.0, 0.3, 0.0)));
  test.see(1, Vec3(3, 0, 0), host);
  test.seeAlong(1, Vec3(0.0, 0.0, -1.0), target);
  test.place(1, Vec3(3, 0, 0), host);
  ReprojectionSystem terms(test.window, test.factors);
  NormalEquations system;
  terms.addTo(&system);
  EXPECT_TRUE(std::isfinite(terms.cost()));
  EXPECT_EQ(system.gradient().norm(), 0.0);
  EXPECT_EQ(system.hessian().norm(), 0.0);
}

}  // namespace
}  // namespace lodeline
