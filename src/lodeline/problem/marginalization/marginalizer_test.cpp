#include "lodeline/problem/marginalization/marginalizer.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lodeline/estimator/initialization/start.h"
#include "lodeline/estimator/solver/window_solver.h"
#include "lodeline/estimator/solver/window_update.h"
#include "lodeline/estimator/trials/marginalizer_dive.h"
#include "lodeline/estimator/trials/test_window.h"
#include "lodeline/estimator/visual/landmarks.h"
#include "lodeline/problem/covariance.h"
#include "lodeline/problem/marginalization/landmark_host.h"
#include "lodeline/problem/prior_terms.h"

namespace lodeline {
namespace {

struct StartedWindow : TestWindow {
  StartedWindow() : TestWindow(2, quadraticOptions()) {}
  Prior start;
};

enum class OldTracks { End, LiveOn };

// Eight keyframes at the batch solution. Where old tracks end, the newest frame observes none of the
// landmarks of frame 0. All of frame 0's landmarks are then marginalized with it, and no observation is
// dropped.
class LosslessMarginalizationTest : public testing::Test {
 protected:
  static constexpr int kFrames = 8;

  void fill(StartedWindow& test, OldTracks old_tracks = OldTracks::End) {
    TestScene scene(sceneOptions(1.0 + (kFrames - 1) * 0.2 + 0.01, 5.0));
    std::vector<SimulatedFrame> frames = scene.all();
    ASSERT_EQ(frames.size(), static_cast<size_t>(kFrames));
    std::erase_if(frames.back().tracks.observations, [&](const FeatureObservation& o) {
      if (old_tracks == OldTracks::LiveOn) return false;
      const auto& first = frames.front().tracks.observations;
      return std::any_of(first.begin(), first.end(),
                         [&](const FeatureObservation& other) { return other.track == o.track; });
    });
    for (const SimulatedFrame& frame : frames) {
      test.add(frame);
      createLandmarks(test.window, test.factors, test.options.landmark);
    }
    test.start = startPrior(*test.window.frames().front(), test.options.initial_state, 0.05);
    ASSERT_TRUE(solveWithCeres(test.window, test.start, test.factors, kToTheEnd).usable);
  }
  static constexpr SolveLimits kToTheEnd{100, 1e-16};

  StartedWindow batch_;
  StartedWindow shortened_;
};

TEST_F(LosslessMarginalizationTest, ThenSolvingEqualsTheBatchSolution) {
  fill(batch_);
  fill(shortened_);
  shortened_.disturb(1e-4, 11);
  Marginalizer marginalizer(shortened_.factors);
  marginalizer.start(shortened_.start);
  marginalizer.marginalizeToSize(shortened_.window, {.recent_frames = 3, .keyframes = 4});
  ASSERT_EQ(shortened_.window.frames().size(), 7u);
  ASSERT_FALSE(marginalizer.takeMapPoints().empty());
  ASSERT_TRUE(solveWithCeres(shortened_.window, marginalizer.prior(), shortened_.factors, kToTheEnd).usable);

  // With linearization points 1e-4 (m, rad) away from the solution, the rest is of second order: some per
  // cent of the curvature that Gauss-Newton leaves out.
  double moved = 0.0;
  for (const auto& frame : shortened_.window.frames()) {
    const Frame& other = *batch_.window.find(frame->id);
    const auto difference = perturbationBetween(other.worldFromBody(), frame->worldFromBody());
    EXPECT_LT(difference.norm(), 1e-5) << "frame " << frame->id;
    if (frame->first_pose) {
      const Rigid3 first = poseFromBlock(frame->firstPose());
      moved = std::max(moved, perturbationBetween(first, frame->worldFromBody()).norm());
    }
    if (!frame->has_motion) continue;
    EXPECT_LT((other.velocity_W() - frame->velocity_W()).norm(), 2e-5);
    EXPECT_LT((other.accelerometerBias() - frame->accelerometerBias()).norm(), 1e-4);
  }
  EXPECT_GT(moved, 1e-4) << "the comparison means nothing where nothing moves";

  const auto batch_covariance = newestCovariance(batch_.window, batch_.start, batch_.factors);
  const auto covariance = newestCovariance(shortened_.window, marginalizer.prior(), shortened_.factors);
  const Eigen::Matrix<double, 15, 1> scale = batch_covariance.diagonal().cwiseSqrt().cwiseInverse();
  EXPECT_LT((scale.asDiagonal() * (covariance - batch_covariance) * scale.asDiagonal()).cwiseAbs().maxCoeff(),
            0.01);
}

// The observations of a continuing landmark before the cut count like those of a separate track that ends
// there.
TEST_F(LosslessMarginalizationTest, CutTracksCountAsTwo) {
  constexpr FrameId kLastBeforeCut = 3;
  constexpr TrackId kOlder = 1000;
  fill(batch_, OldTracks::LiveOn);
  fill(shortened_, OldTracks::LiveOn);
  std::vector<std::pair<TrackId, FeatureTrack>> older;
  for (auto& [id, track] : batch_.window.tracks()) {
    if (!track.landmark || !track.seenIn(0) || !track.seenIn(kFrames - 1)) continue;
    if (auto part = splitTrack(batch_.window, track, kLastBeforeCut, batch_.factors))
      older.emplace_back(kOlder + id, std::move(*part));
  }
  ASSERT_GT(older.size(), 10u);
  for (auto& [id, track] : older) batch_.window.tracks()[id] = track;
  WindowOptions wanted{.recent_frames = 3, .keyframes = 4, .split_at_keyframe = 4};
  Marginalizer two(batch_.factors), cut(shortened_.factors);
  two.start(batch_.start);
  cut.start(shortened_.start);
  two.marginalizeToSize(batch_.window, wanted);
  wanted.split_at_keyframe = 1;
  cut.marginalizeToSize(shortened_.window, wanted);
  EXPECT_EQ(two.takeMapPoints().size(), cut.takeMapPoints().size() + older.size());

  const auto expected = newestCovariance(batch_.window, two.prior(), batch_.factors);
  const auto covariance = newestCovariance(shortened_.window, cut.prior(), shortened_.factors);
  EXPECT_LT((covariance - expected).norm(), 1e-6 * expected.norm());
  ASSERT_TRUE(solveWithCeres(batch_.window, two.prior(), batch_.factors, kToTheEnd).usable);
  ASSERT_TRUE(solveWithCeres(shortened_.window, cut.prior(), shortened_.factors, kToTheEnd).usable);
  for (const auto& frame : shortened_.window.frames()) {
    const Frame& other = *batch_.window.find(frame->id);
    EXPECT_LT(perturbationBetween(other.worldFromBody(), frame->worldFromBody()).norm(), 1e-8);
  }
}

// The four directions that neither camera nor IMU observes: translations, and rotation about gravity.
Eigen::Vector4d unobservableInformation(const Prior& prior) {
  Eigen::MatrixXd directions = Eigen::MatrixXd::Zero(prior.tangentSize(), 4);
  int row = 0;
  for (const Prior::Block& block : prior.blocks) {
    const Vec3 first = block.linearization_point.head<3>();  // position, or velocity
    directions.block<3, 1>(row, 3) = Vec3::UnitZ().cross(first);
    if (block.isPose()) {
      directions.block<3, 3>(row, 0).setIdentity();
      directions.block<3, 1>(row + 3, 3) = Vec3::UnitZ();
    }
    row += block.tangentSize();
  }
  return (prior.sqrt_information * directions).colwise().squaredNorm();
}

// Just enough prior information for the equations to have a solution; Ceres works without it.
InitialStateOptions nearlyNothing() {
  InitialStateOptions options;
  options.position_sigma_m = 30.0;
  options.yaw_sigma_rad = 0.3;
  options.velocity_sigma_m_per_s = 30.0;
  return options;
}

// Runs a window without any prior on its pose, or with a negligible one. Returns the information of its
// marginalization prior about that pose.
enum class LinearizationPoints { Kept, Forgotten, ResetLinearizationPoints };
enum class OtherFrames { Dropped, Interpolated };
Eigen::Vector4d informationAfter(int frames, LinearizationPoints linearization_points,
                                 OtherFrames other_frames = OtherFrames::Dropped, int keyframes = 3) {
  EstimatorOptions options;
  // A poor IMU: estimates then move far enough from their linearization points for the difference to matter.
  options.preintegration.noise_inflation = 10.0;
  options.preintegration.motion_noise = MotionNoiseOptions::none();
  options.landmark.min_frames = 1;  // and so do points with little information
  TestWindow test(2, options);
  Marginalizer marginalizer(test.factors);
  TestScene scene(sceneOptions(1.0 + 0.1 * frames, 10.0));
  WindowOptions wanted{.recent_frames = 3, .keyframes = keyframes, .split_at_keyframe = 1};
  const bool interpolates = other_frames == OtherFrames::Interpolated;
  if (interpolates) wanted.interpolated_spacing_s = 0.05;
  int interpolated = 0;
  for (int k = 0; k < frames; ++k) {
    Frame& added = test.add(*scene.next(), k % 2 == 0);
    if (k == 0 && interpolates) marginalizer.start(startPrior(added, nearlyNothing(), 0.3));
    createLandmarks(test.window, test.factors, options.landmark);
    if (k < 3) continue;
    const SolveLimits limits{4, 1e-6};
    EXPECT_TRUE(interpolates
                    ? updateWindow(test.window, marginalizer.prior(), test.factors, limits).summary.usable
                    : solveWithCeres(test.window, marginalizer.prior(), test.factors, limits).usable);
    removeOutliers(test.window, test.factors, options.landmark);
    if (linearization_points == LinearizationPoints::ResetLinearizationPoints)
      marginalizer.resetLinearizationPoints(test.window);
    marginalizer.marginalizeToSize(test.window, wanted);
    for (const auto& frame : test.window.frames()) interpolated += frame->interpolated.has_value();
    if (linearization_points == LinearizationPoints::ResetLinearizationPoints)
      marginalizer.resetLinearizationPoints(test.window);
    if (linearization_points != LinearizationPoints::Forgotten) continue;
    for (const auto& frame : test.window.frames()) {
      frame->first_pose.reset();
      frame->first_motion.reset();
    }
  }
  EXPECT_EQ(test.window.poseOnlyCount(), keyframes);
  EXPECT_EQ(interpolated > frames, interpolates);
  return unobservableInformation(marginalizer.prior());
}

TEST(Marginalizer, CreatesNoInformationAboutPlaceAndHeading) {
  for (const LinearizationPoints linearization_points :
       {LinearizationPoints::Kept, LinearizationPoints::ResetLinearizationPoints}) {
    const Eigen::Vector4d information = informationAfter(30, linearization_points);
    // The rest is rounding and the jitter of the factorization: less than a sigma of 10 m and 0.1 rad.
    EXPECT_LT(information[0], 1e-2);
    EXPECT_LT(information[1], 1e-2);
    EXPECT_LT(information[2], 1e-2);
    EXPECT_LT(information[3], 1e2);
    // No more than the initial information, with short windows and with windows that cut tracks.
    const InitialStateOptions known = nearlyNothing();
    for (const int keyframes : {3, 6}) {
      const Eigen::Vector4d interpolated =
          informationAfter(30, linearization_points, OtherFrames::Interpolated, keyframes);
      for (int i = 0; i < 3; ++i)
        EXPECT_NEAR(interpolated[i], std::pow(known.position_sigma_m, -2), 1e-4) << "100 m, from rounding";
      EXPECT_NEAR(interpolated[3] * std::pow(known.yaw_sigma_rad, 2), 1.0, 0.01);
    }
  }
}

TEST(Marginalizer, WithoutLinearizationPointsWouldInventAHeading) {
  const Eigen::Vector4d with = informationAfter(30, LinearizationPoints::Kept);
  const Eigen::Vector4d without = informationAfter(30, LinearizationPoints::Forgotten);
  EXPECT_GT(without[3], 1e4) << "a heading known to 0.6 degrees out of nothing";
  EXPECT_GT(without[3], 1e3 * with[3]);
}

TEST(Marginalizer, ResetLinearizationPointsSaysTheSameAtThePresentValues) {
  TestWindow test(2);
  Marginalizer marginalizer(test.factors);
  TestScene scene(sceneOptions(3.0, 10.0));
  for (int k = 0; k < 15; ++k) {
    addNext(test, scene, 2, &marginalizer);
    marginalizer.marginalizeToSize(test.window, {.recent_frames = 3, .keyframes = 3});
  }
  test.disturb(0.02, 3);
  const auto gradient = [&] {
    NormalEquations system;
    PriorTerms(marginalizer.prior()).addTo(&system);
    return Eigen::VectorXd(system.gradient().head(marginalizer.prior().tangentSize()));
  };
  const double cost = PriorTerms(marginalizer.prior()).cost();
  const Eigen::VectorXd gradient_before = gradient();
  const Eigen::Vector4d information = unobservableInformation(marginalizer.prior());
  ASSERT_GT(cost, 100.0) << "the frames must have moved by more than the prior likes";

  marginalizer.resetLinearizationPoints(test.window);
  EXPECT_NEAR(PriorTerms(marginalizer.prior()).cost(), cost, 1e-6 * cost);
  const Eigen::Vector4d after = unobservableInformation(marginalizer.prior());
  for (int i = 0; i < 4; ++i)
    EXPECT_NEAR(after[i], information[i], 1e-6 * information[i]) << "direction " << i;
  // Only the derivatives by yaw may change.
  const Eigen::VectorXd gradient_after = gradient();
  int row = 0;
  for (const Prior::Block& block : marginalizer.prior().blocks) {
    EXPECT_EQ(block.linearization_point,
              Eigen::Map<const Eigen::VectorXd>(block.value, block.linearization_point.size()));
    for (int i = 0; i < block.tangentSize(); ++i) {
      if (block.isPose() && i == 5) continue;
      EXPECT_NEAR(gradient_after[row + i], gradient_before[row + i], 1e-6 * gradient_before.norm());
    }
    row += block.tangentSize();
  }
  for (const auto& frame : test.window.frames()) {
    EXPECT_FALSE(frame->first_pose.has_value());
    EXPECT_FALSE(frame->first_motion.has_value());
  }
}

class MarginalizersBooks : public testing::TestWithParam<double> {};

TEST_P(MarginalizersBooks, AreInOrder) {
  TestWindow test(2);
  const WindowOptions wanted{.recent_frames = 3, .keyframes = 4, .interpolated_spacing_s = GetParam()};
  int interpolated = 0;
  Marginalizer marginalizer(test.factors);
  TestScene scene(sceneOptions(4.0, 10.0));
  std::map<TrackId, MapPoint> map;
  for (int k = 0; k < 30; ++k) {
    addNext(test, scene, 3, &marginalizer);
    marginalizer.marginalizeToSize(test.window, wanted);
    for (const MapPoint& point : marginalizer.takeMapPoints()) map[point.track] = point;

    const Window& window = test.window;
    ASSERT_LE(window.recentCount(), 3);
    ASSERT_LE(window.poseOnlyCount(), 4);
    const Frame* before = nullptr;
    for (const auto& frame : window.frames()) {
      EXPECT_TRUE(frame->has_motion || frame->is_keyframe || frame->interpolated);
      if (frame->interpolated) {
        ++interpolated;
        EXPECT_FALSE(frame->has_motion || frame->is_keyframe);
        ASSERT_NE(window.find(frame->interpolated->before), nullptr);
        ASSERT_NE(window.find(frame->interpolated->after), nullptr);
      }
      const bool follows_motion = before && before->has_motion;
      EXPECT_EQ(frame->from_previous != nullptr, follows_motion) << "frame " << frame->id;
      before = frame.get();
    }
    for (const auto& [id, track] : window.tracks()) {
      for (const Observation& observation : track.observations)
        ASSERT_NE(window.find(observation.frame), nullptr);
      if (track.landmark) {
        ASSERT_NE(window.find(track.landmark->host), nullptr);
        ASSERT_NE(track.find(track.landmark->host, 0), nullptr) << "the host must see its landmark";
      }
    }
    for (const Prior::Block& block : marginalizer.prior().blocks) {
      const bool lives = std::any_of(window.frames().begin(), window.frames().end(), [&](const auto& frame) {
        return block.value == frame->pose.data() ||
               (frame->has_motion && block.value == frame->motion.data());
      });
      for (const auto& frame : window.frames()) {
        ASSERT_FALSE(frame->interpolated && block.value == frame->pose.data());
      }
      ASSERT_TRUE(lives) << "the prior speaks of a block that is gone";
    }
  }
  EXPECT_TRUE(marginalizer.takeMapPoints().empty());
  EXPECT_EQ(interpolated > 0, GetParam() < 0.1);
  // Frames are at their true poses, so points are as accurate as their observations: half a pixel over a
  // short baseline.
  ASSERT_GT(map.size(), 10u);
  double squares = 0.0;
  for (const auto& [id, point] : map) {
    EXPECT_GE(point.observations, 2);
    const double range_m = scene.landmark(id).norm();
    squares += (point.position_W - scene.landmark(id)).squaredNorm() / (range_m * range_m);
  }
  EXPECT_LT(std::sqrt(squares / static_cast<double>(map.size())), 0.1) << "of their distance";
}

INSTANTIATE_TEST_SUITE_P(SpacingOfInterpolatedFrames, MarginalizersBooks, testing::Values(0.05, 0.15));

}  // namespace
}  // namespace lodeline
