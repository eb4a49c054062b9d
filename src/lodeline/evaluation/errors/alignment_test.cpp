#include "lodeline/trajectory.h"

#include <gtest/gtest.h>

#include "lodeline/diagnostics.h"
#include "lodeline/evaluation/trajectory/test_trajectories.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

const Rigid3 kTilted(Quat(Eigen::AngleAxisd(2.1, Vec3(1.0, -2.0, 0.5).normalized())), Vec3(10.0, -4.0, 7.0));
const Rigid3 kYawed(Quat(Eigen::AngleAxisd(-2.8, Vec3::UnitZ())), Vec3(-3.0, 5.0, 1.5));

PosePairs pairUp(const Trajectory& estimate, const Trajectory& reference) {
  return associate(estimate, reference, {});
}

double angleBetween(const Quat& a, const Quat& b) { return so3::log(a.conjugate() * b).norm(); }

void expectAligns(AlignmentType type, const Rigid3& transform, double scale) {
  const Trajectory truth = test::bend(80);
  const PosePairs pairs = pairUp(test::transformed(truth, transform, scale), truth);
  const Alignment alignment = align(type, pairs);
  EXPECT_NEAR(alignment.scale, 1.0 / scale, 1e-9);
  EXPECT_LT(angleBetween(alignment.reference_from_estimate.rotation, transform.rotation.conjugate()), 1e-9);
  EXPECT_FALSE(alignment.rotation_from_orientations);
  const auto aligned = applyAlignment(alignment, pairs.estimate);
  for (std::size_t i = 0; i < aligned.size(); ++i) {
    EXPECT_LT((aligned[i].translation - pairs.reference[i].translation).norm(), 1e-9);
    EXPECT_LT(angleBetween(aligned[i].rotation, pairs.reference[i].rotation), 1e-9);
  }
}

TEST(Alignment, RecoversYawAndPosition) { expectAligns(AlignmentType::Yaw, kYawed, 1.0); }
TEST(Alignment, RecoversRigidTransformation) { expectAligns(AlignmentType::SE3, kTilted, 1.0); }
TEST(Alignment, RecoversSimilarity) { expectAligns(AlignmentType::Sim3, kTilted, 0.37); }

TEST(Alignment, NoneLeavesTheEstimateAsItIs) {
  const Trajectory truth = test::bend(5);
  const PosePairs pairs = pairUp(test::transformed(truth, kTilted), truth);
  const auto aligned = applyAlignment(align(AlignmentType::None, pairs), pairs.estimate);
  EXPECT_EQ(aligned[3].translation, pairs.estimate[3].translation);
}

TEST(Alignment, RigidAlignmentDoesNotHideAWrongScale) {
  const Trajectory truth = test::bend(80);
  EXPECT_EQ(align(AlignmentType::SE3, pairUp(test::transformed(truth, kTilted, 1.1), truth)).scale, 1.0);
}

TEST(Alignment, ScaleErrorIsTheShareBywhichTheEstimateIsTooLarge) {
  const Trajectory truth = test::bend(80);
  const PosePairs pairs = pairUp(test::transformed(truth, Rigid3(), 1.04), truth);
  EXPECT_NEAR(align(AlignmentType::Sim3, pairs).scaleError(), 0.04, 1e-12);
}

TEST(Alignment, NeverMirrors) {
  Trajectory mirrored = test::bend(80);
  for (StampedPose& pose : mirrored.poses) pose.world_from_body.translation.y() *= -1.0;
  const Alignment alignment = align(AlignmentType::SE3, pairUp(mirrored, test::bend(80)));
  EXPECT_NEAR(alignment.reference_from_estimate.rotation.toRotationMatrix().determinant(), 1.0, 1e-12);
}

TEST(Alignment, YawKeepsTheVerticalWhenTheEstimateIsTilted) {
  const Trajectory truth = test::bend(80);
  const Alignment alignment = align(AlignmentType::Yaw, pairUp(test::transformed(truth, kTilted), truth));
  EXPECT_LT((alignment.reference_from_estimate.rotation * Vec3::UnitZ() - Vec3::UnitZ()).norm(), 1e-12);
}

TEST(Alignment, TakesTheRotationFromOrientationsOnALine) {
  const Trajectory truth = test::straight(20);
  const PosePairs pairs = pairUp(test::transformed(truth, kTilted), truth);
  const Alignment alignment = align(AlignmentType::SE3, pairs);
  EXPECT_TRUE(alignment.rotation_from_orientations);
  EXPECT_LT(angleBetween(alignment.reference_from_estimate.rotation, kTilted.rotation.conjugate()), 1e-9);
}

TEST(Alignment, YawIsFixedByALevelLine) {
  const Trajectory truth = test::straight(20);
  const Alignment alignment = align(AlignmentType::Yaw, pairUp(test::transformed(truth, kYawed), truth));
  EXPECT_FALSE(alignment.rotation_from_orientations);
  EXPECT_LT(angleBetween(alignment.reference_from_estimate.rotation, kYawed.rotation.conjugate()), 1e-9);
}

TEST(Alignment, AlignsOneOrTwoPosesByTheirOrientation) {
  for (const int count : {1, 2}) {
    const Trajectory truth = test::bend(count);
    for (const AlignmentType type : {AlignmentType::Yaw, AlignmentType::SE3}) {
      const Rigid3& transform = type == AlignmentType::Yaw ? kYawed : kTilted;
      const Alignment alignment = align(type, pairUp(test::transformed(truth, transform), truth));
      EXPECT_LT(angleBetween(alignment.reference_from_estimate.rotation, transform.rotation.conjugate()),
                1e-9);
    }
  }
}

TEST(Alignment, StandingStillAlignsByOrientation) {
  Trajectory still = test::bend(30);
  for (StampedPose& pose : still.poses) pose.world_from_body.translation = Vec3(1.0, 2.0, 3.0);
  const Alignment alignment = align(AlignmentType::Yaw, pairUp(test::transformed(still, kYawed), still));
  EXPECT_TRUE(alignment.rotation_from_orientations);
  EXPECT_LT(angleBetween(alignment.reference_from_estimate.rotation, kYawed.rotation.conjugate()), 1e-9);
}

TEST(Alignment, SimilarityNeedsMotion) {
  Trajectory still = test::bend(30);
  for (StampedPose& pose : still.poses) pose.world_from_body.translation = Vec3(1.0, 2.0, 3.0);
  EXPECT_THROW(align(AlignmentType::Sim3, pairUp(still, test::bend(30))), InputError);
  EXPECT_THROW(align(AlignmentType::Sim3, pairUp(test::bend(30), still)), InputError);
  EXPECT_THROW(align(AlignmentType::Sim3, pairUp(test::bend(1), test::bend(1))), InputError);
}

TEST(Alignment, FirstPosesCoincide) {
  const Trajectory truth = test::bend(80);
  const PosePairs pairs = pairUp(test::transformed(truth, kTilted, 2.0), truth);
  const Alignment alignment = alignFirstPose(AlignmentType::Sim3, pairs, 0.5);
  EXPECT_LT(
      (alignment.apply(pairs.estimate.front()).translation - pairs.reference.front().translation).norm(),
      1e-9);
  EXPECT_LT((alignment.apply(pairs.estimate.back()).translation - pairs.reference.back().translation).norm(),
            1e-9);
}

TEST(Alignment, OnlyTrueNorthIsTheReferences) {
  EXPECT_EQ(headingBasisOf("true north"), HeadingBasis::North);
  for (const char* reference : {"magnetic north", "start heading", ""})
    EXPECT_EQ(headingBasisOf(reference), HeadingBasis::Start) << reference;
}

TEST(Alignment, NamesAreRefusedWhenUnknown) {
  EXPECT_EQ(alignmentTypeFromString("sim3"), AlignmentType::Sim3);
  EXPECT_STREQ(toString(AlignmentType::Yaw), "yaw");
  EXPECT_THROW(alignmentTypeFromString("sim4"), UsageError);
}

}  // namespace
}  // namespace lodeline
