#include "lodeline/estimator/visual/landmark_linearization_cache.h"

#include <gtest/gtest.h>

#include "lodeline/estimator/trials/test_window.h"
#include "lodeline/estimator/visual/landmarks.h"
#include "lodeline/estimator/visual/reprojection_system.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/problem/marginalization/landmark_host.h"

namespace lodeline {
namespace {

using Step = Eigen::Matrix<double, 6, 1>;

// A window of three keyframes without motion, a frame interpolated between the last of them and the first
// recent frame, and the recent frames. A third of the tracks ends with the keyframes, a third with the
// interpolated frame.
class LandmarkLinearizationCacheTest : public testing::Test {
 protected:
  LandmarkLinearizationCacheTest() {
    test_.fill();
    test_.disturb(1e-4, 3);
    const auto& frames = test_.window.frames();
    for (size_t i = 0; i < kOld; ++i) {
      frames[i]->has_motion = false;
      frames[i]->first_pose = frames[i]->pose;
    }
    frames[kOld]->is_keyframe = false;
    for (auto& [id, track] : test_.window.tracks()) {
      if (id % 3 == 0 || !track.landmark) continue;
      const FrameId end = frames[id % 3 == 1 ? kOld : kOld + 1]->id;
      std::erase_if(track.observations,
                    [&](const Observation& observation) { return observation.frame >= end; });
      if (track.landmark->host >= end) moveToNewHost(test_.window, track, -1, test_.factors);
    }
    test_.window.removeEmptyTracks();
    test_.window.interpolate(*frames[kOld], *frames[kOld - 1], *frames[kOld + 1]);
  }

  void move(size_t frame, double step) {
    Frame& moved = *test_.window.frames()[frame];
    poseToBlock(perturbed(moved.worldFromBody(), Step::Constant(step)), moved.pose.data());
  }

  int asleep() const {
    int count = 0;
    for (const auto& [id, track] : test_.window.tracks()) count += track.is_frozen;
    return count;
  }

  // Gradient by the old keyframes' poses from the cached terms or from the observations.
  Eigen::VectorXd gradient(const NormalEquations& system) const {
    Eigen::VectorXd gradient(6 * kOld);
    for (size_t i = 0; i < kOld; ++i) {
      const NormalEquations::Block* block = system.find(test_.window.frames()[i]->pose.data());
      gradient.segment<6>(static_cast<Eigen::Index>(6 * i)) = system.gradient().segment<6>(block->offset);
    }
    return gradient;
  }
  Eigen::VectorXd remembered() {
    NormalEquations system;
    linearization_cache_.addTo(&system);
    return gradient(system);
  }
  Eigen::VectorXd evaluated() {
    NormalEquations system;
    ReprojectionSystem(test_.window, test_.factors, ReprojectionSystem::Of::kFrozen).addTo(&system);
    return gradient(system);
  }

  static constexpr size_t kOld = 3;
  TestWindow test_;
  LandmarkLinearizationCache linearization_cache_{3};
};

TEST_F(LandmarkLinearizationCacheTest, AreThoseLastSeenByOldKeyframes) {
  linearization_cache_.freeze(test_.window, test_.factors);
  int ended = 0;
  for (const auto& [id, track] : test_.window.tracks()) {
    const bool has_ended =
        track.landmark && track.observations.back().frame < test_.window.frames()[kOld]->id;
    EXPECT_EQ(track.is_frozen, has_ended);
    ended += has_ended;
  }
  EXPECT_GT(ended, 5);
  EXPECT_LT(ended, static_cast<int>(test_.window.tracks().size()));
}

TEST_F(LandmarkLinearizationCacheTest, AreWithTheOthersAllThatTheWindowHas) {
  NormalEquations all, apart;
  ReprojectionSystem every(test_.window, test_.factors);
  every.addTo(&all);
  linearization_cache_.freeze(test_.window, test_.factors);
  ReprojectionSystem live(test_.window, test_.factors, ReprojectionSystem::Of::kLive);
  live.addTo(&apart);
  linearization_cache_.addTo(&apart);
  ASSERT_EQ(apart.size(), all.size());
  EXPECT_NEAR(live.cost() + linearization_cache_.cost(), every.cost(), 1e-9 * every.cost());
  EXPECT_LT((apart.hessian() - all.hessian()).norm(), 1e-9 * all.hessian().norm());
  EXPECT_LT((apart.gradient() - all.gradient()).norm(), 1e-9 * all.gradient().norm());
}

TEST_F(LandmarkLinearizationCacheTest, FollowMovesOfTheKeyframesToFirstOrder) {
  // The curvature of a robust loss differs from that of its quadratic cost.
  for (const auto& frame : test_.window.frames()) frame->robust_scale_sigmas = 1e3;
  linearization_cache_.freeze(test_.window, test_.factors);
  const Eigen::VectorXd before = evaluated();
  double errors[2];
  for (int i = 0; i < 2; ++i) {
    const double step = i == 0 ? 2e-4 : 1e-4;
    const PoseBlock pose = test_.window.frames()[2]->pose;
    move(2, step);
    const Eigen::VectorXd change = evaluated() - before;
    errors[i] = (remembered() - evaluated()).norm();
    EXPECT_LT(errors[i], 0.1 * change.norm());
    test_.window.frames()[2]->pose = pose;
  }
  EXPECT_LT(errors[1], 0.3 * errors[0]);
}

TEST_F(LandmarkLinearizationCacheTest, SayNothingOfPositionAndHeadingOfAll) {
  linearization_cache_.freeze(test_.window, test_.factors);
  NormalEquations system;
  linearization_cache_.addTo(&system);
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(system.size(), 4);
  for (size_t i = 0; i < kOld; ++i) {
    const Frame& frame = *test_.window.frames()[i];
    const int row = system.find(frame.pose.data())->offset;
    all.block<3, 3>(row, 0).setIdentity();
    all.block<3, 1>(row, 3) = Vec3::UnitZ().cross(frame.firstWorldFromBody().translation);
    all(row + 5, 3) = 1.0;
  }
  const Eigen::MatrixXd told = all.transpose() * system.hessian() * all;
  EXPECT_LT(told.diagonal().maxCoeff(), 1e-9 * system.hessian().diagonal().maxCoeff());
}

TEST_F(LandmarkLinearizationCacheTest, DoNotMindWhereAllOfThemAre) {
  linearization_cache_.freeze(test_.window, test_.factors);
  move(1, 1e-3);
  const Eigen::VectorXd before = remembered();
  const double cost = linearization_cache_.cost();
  const Rigid3 elsewhere{so3::exp(Vec3(0.3, -0.2, 1.0)), Vec3(20.0, -30.0, 10.0)};
  for (const auto& frame : test_.window.frames())
    poseToBlock(elsewhere * frame->worldFromBody(), frame->pose.data());
  EXPECT_NEAR(linearization_cache_.cost(), cost, 1e-9 * cost);
  EXPECT_LT((remembered() - before).norm(), 1e-9 * before.norm());
  linearization_cache_.invalidateIfStale(test_.window);
  EXPECT_GT(asleep(), 0);
}

TEST_F(LandmarkLinearizationCacheTest, KeepTheirObservationsAndErrors) {
  size_t of_frozen = 0;
  linearization_cache_.freeze(test_.window, test_.factors);
  for (const auto& [id, track] : test_.window.tracks()) {
    if (track.is_frozen) of_frozen += track.observations.size() - 1;
  }
  EXPECT_EQ(linearization_cache_.errors().size(), of_frozen);
  removeOutliers(test_.window, test_.factors, {.max_error_sigmas = 1e-9});
  size_t kept = 0;
  for (const auto& [id, track] : test_.window.tracks()) {
    if (track.landmark) kept += track.observations.size() - 1;
  }
  EXPECT_EQ(kept, of_frozen);
}

TEST_F(LandmarkLinearizationCacheTest, WakeAfterSomeFrames) {
  linearization_cache_.freeze(test_.window, test_.factors);
  for (int frame = 0; frame < 3; ++frame) {
    linearization_cache_.invalidateIfStale(test_.window);
    EXPECT_GT(asleep(), 0);
  }
  linearization_cache_.invalidateIfStale(test_.window);
  EXPECT_EQ(asleep(), 0);
  EXPECT_EQ(linearization_cache_.cost(), 0.0);
  EXPECT_TRUE(linearization_cache_.errors().empty());
}

TEST_F(LandmarkLinearizationCacheTest, WakeWhereAKeyframeGoes) {
  linearization_cache_.freeze(test_.window, test_.factors);
  test_.window.remove(test_.window.frames()[1]->id);
  linearization_cache_.invalidateIfStale(test_.window);
  EXPECT_EQ(asleep(), 0);
}

TEST_F(LandmarkLinearizationCacheTest, WakeWhereLinearizationPointsChange) {
  linearization_cache_.freeze(test_.window, test_.factors);
  test_.window.frames()[1]->first_pose.reset();
  linearization_cache_.invalidateIfStale(test_.window);
  EXPECT_EQ(asleep(), 0);
}

TEST_F(LandmarkLinearizationCacheTest, WakeWhereKeyframesMoveFar) {
  linearization_cache_.freeze(test_.window, test_.factors);
  move(1, 0.002);
  linearization_cache_.invalidateIfStale(test_.window);
  EXPECT_GT(asleep(), 0);
  move(1, 0.02);
  linearization_cache_.invalidateIfStale(test_.window);
  EXPECT_EQ(asleep(), 0);
}

TEST_F(LandmarkLinearizationCacheTest, AreNeverAsleepWhereNotWanted) {
  LandmarkLinearizationCache never(0);
  never.freeze(test_.window, test_.factors);
  EXPECT_EQ(asleep(), 0);
}

}  // namespace
}  // namespace lodeline
