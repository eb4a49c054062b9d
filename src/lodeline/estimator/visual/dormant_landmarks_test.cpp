#include "lodeline/estimator/visual/dormant_landmarks.h"

#include <gtest/gtest.h>

#include "lodeline/estimator/trials/test_window.h"
#include "lodeline/estimator/visual/landmark_host.h"
#include "lodeline/estimator/visual/landmarks.h"
#include "lodeline/estimator/visual/visual_terms.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

using Step = Eigen::Matrix<double, 6, 1>;

// A window of three keyframes without motion, a frame that hangs between the last of them and the first of
// the recent frames, and these. A third of the tracks ends with the keyframes, a third with the frame
// between.
class DormantLandmarksTest : public testing::Test {
 protected:
  DormantLandmarksTest() {
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
      std::erase_if(track.sightings, [&](const Sighting& sighting) { return sighting.frame >= end; });
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
    for (const auto& [id, track] : test_.window.tracks()) count += track.is_dormant;
    return count;
  }

  // Of the old keyframes' poses, by what the dormant landmarks stand for and by their sightings.
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
    dormant_.addTo(&system);
    return gradient(system);
  }
  Eigen::VectorXd evaluated() {
    NormalEquations system;
    VisualTerms(test_.window, test_.factors, VisualTerms::Of::kDormant).addTo(&system);
    return gradient(system);
  }

  static constexpr size_t kOld = 3;
  TestWindow test_;
  DormantLandmarks dormant_{3};
};

TEST_F(DormantLandmarksTest, AreThoseLastSeenByOldKeyframes) {
  dormant_.putToSleep(test_.window, test_.factors);
  int ended = 0;
  for (const auto& [id, track] : test_.window.tracks()) {
    const bool has_ended = track.landmark && track.sightings.back().frame < test_.window.frames()[kOld]->id;
    EXPECT_EQ(track.is_dormant, has_ended);
    ended += has_ended;
  }
  EXPECT_GT(ended, 5);
  EXPECT_LT(ended, static_cast<int>(test_.window.tracks().size()));
}

TEST_F(DormantLandmarksTest, AreWithTheOthersAllThatTheWindowHas) {
  NormalEquations all, apart;
  VisualTerms every(test_.window, test_.factors);
  every.addTo(&all);
  dormant_.putToSleep(test_.window, test_.factors);
  VisualTerms awake(test_.window, test_.factors, VisualTerms::Of::kAwake);
  awake.addTo(&apart);
  dormant_.addTo(&apart);
  ASSERT_EQ(apart.size(), all.size());
  EXPECT_NEAR(awake.cost() + dormant_.cost(), every.cost(), 1e-9 * every.cost());
  EXPECT_LT((apart.hessian() - all.hessian()).norm(), 1e-9 * all.hessian().norm());
  EXPECT_LT((apart.gradient() - all.gradient()).norm(), 1e-9 * all.gradient().norm());
}

TEST_F(DormantLandmarksTest, FollowMovesOfTheKeyframesToFirstOrder) {
  // A loss that bends has another curvature than the system that stands for it.
  for (const auto& frame : test_.window.frames()) frame->robust_scale_sigmas = 1e3;
  dormant_.putToSleep(test_.window, test_.factors);
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

TEST_F(DormantLandmarksTest, SayNothingOfPositionAndHeadingOfAll) {
  dormant_.putToSleep(test_.window, test_.factors);
  NormalEquations system;
  dormant_.addTo(&system);
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

TEST_F(DormantLandmarksTest, DoNotMindWhereAllOfThemAre) {
  dormant_.putToSleep(test_.window, test_.factors);
  move(1, 1e-3);
  const Eigen::VectorXd before = remembered();
  const double cost = dormant_.cost();
  const Rigid3 elsewhere{so3::exp(Vec3(0.3, -0.2, 1.0)), Vec3(20.0, -30.0, 10.0)};
  for (const auto& frame : test_.window.frames())
    poseToBlock(elsewhere * frame->worldFromBody(), frame->pose.data());
  EXPECT_NEAR(dormant_.cost(), cost, 1e-9 * cost);
  EXPECT_LT((remembered() - before).norm(), 1e-9 * before.norm());
  dormant_.wakeIfDue(test_.window);
  EXPECT_GT(asleep(), 0);
}

TEST_F(DormantLandmarksTest, KeepTheirSightingsAndErrors) {
  size_t of_dormant = 0;
  dormant_.putToSleep(test_.window, test_.factors);
  for (const auto& [id, track] : test_.window.tracks()) {
    if (track.is_dormant) of_dormant += track.sightings.size() - 1;
  }
  EXPECT_EQ(dormant_.errors().size(), of_dormant);
  removeOutliers(test_.window, test_.factors, {.max_error_sigmas = 1e-9});
  size_t kept = 0;
  for (const auto& [id, track] : test_.window.tracks()) {
    if (track.landmark) kept += track.sightings.size() - 1;
  }
  EXPECT_EQ(kept, of_dormant);
}

TEST_F(DormantLandmarksTest, WakeAfterSomeFrames) {
  dormant_.putToSleep(test_.window, test_.factors);
  for (int frame = 0; frame < 3; ++frame) {
    dormant_.wakeIfDue(test_.window);
    EXPECT_GT(asleep(), 0);
  }
  dormant_.wakeIfDue(test_.window);
  EXPECT_EQ(asleep(), 0);
  EXPECT_EQ(dormant_.cost(), 0.0);
  EXPECT_TRUE(dormant_.errors().empty());
}

TEST_F(DormantLandmarksTest, WakeWhereAKeyframeGoes) {
  dormant_.putToSleep(test_.window, test_.factors);
  test_.window.remove(test_.window.frames()[1]->id);
  dormant_.wakeIfDue(test_.window);
  EXPECT_EQ(asleep(), 0);
}

TEST_F(DormantLandmarksTest, WakeWhereFirstEstimatesChange) {
  dormant_.putToSleep(test_.window, test_.factors);
  test_.window.frames()[1]->first_pose.reset();
  dormant_.wakeIfDue(test_.window);
  EXPECT_EQ(asleep(), 0);
}

TEST_F(DormantLandmarksTest, WakeWhereKeyframesMoveFar) {
  dormant_.putToSleep(test_.window, test_.factors);
  move(1, 0.002);
  dormant_.wakeIfDue(test_.window);
  EXPECT_GT(asleep(), 0);
  move(1, 0.02);
  dormant_.wakeIfDue(test_.window);
  EXPECT_EQ(asleep(), 0);
}

TEST_F(DormantLandmarksTest, AreNeverAsleepWhereNotWanted) {
  DormantLandmarks never(0);
  never.putToSleep(test_.window, test_.factors);
  EXPECT_EQ(asleep(), 0);
}

}  // namespace
}  // namespace lodeline
