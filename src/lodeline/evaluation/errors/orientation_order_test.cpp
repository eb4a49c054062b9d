#include "lodeline/evaluation/errors/orientation_order.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace lodeline {
namespace {

using ::testing::HasSubstr;

/// Pairs of rotations about all axes and their `read` versions in another world and body frame.
template <typename Read>
PosePairs pairsWith(Read read) {
  const Quat world(Eigen::AngleAxisd(0.7, Vec3(0.2, 0.3, 0.9).normalized()));
  const Quat body(Eigen::AngleAxisd(-1.2, Vec3(0.8, -0.5, 0.1).normalized()));
  PosePairs pairs;
  for (int i = 0; i < 60; ++i) {
    const double t = 0.1 * i;
    const Quat q = Quat(Eigen::AngleAxisd(t, Vec3::UnitZ())) *
                   Quat(Eigen::AngleAxisd(0.5 * std::sin(t), Vec3::UnitX())) *
                   Quat(Eigen::AngleAxisd(0.4 * std::cos(1.7 * t), Vec3::UnitY()));
    pairs.time.push_back(Time::fromSeconds(t));
    const Vec3 position_m(std::cos(t), std::sin(1.3 * t), 0.3 * t);
    pairs.reference.emplace_back(q, position_m);
    pairs.estimate.emplace_back(read(world * q * body), world * position_m);
  }
  return pairs;
}

std::string findingOf(const PosePairs& pairs) {
  Diagnostics diagnostics;
  checkOrientationOrder(pairs, diagnostics);
  return diagnostics.ranked().empty() ? std::string() : diagnostics.ranked().front().first_message;
}

TEST(OrientationOrder, IsNoFindingBetweenConventionsOfFrames) {
  EXPECT_EQ(findingOf(pairsWith([](const Quat& q) { return q; })), "");
}

TEST(OrientationOrder, IsNoFindingWhereNothingFits) {
  PosePairs pairs = pairsWith([](const Quat& q) { return q; });
  for (std::size_t i = 0; i < pairs.size(); ++i) pairs.estimate[i] = pairs.estimate[(i * 37) % pairs.size()];
  EXPECT_EQ(findingOf(pairs), "");
}

TEST(OrientationOrder, NamesTheOrderThatFits) {
  // A file with x y z w read as w x y z, one with the reverse error, and one with inverse rotations.
  const auto mistakenForWFirst = [](const Quat& q) { return Quat(q.x(), q.y(), q.z(), q.w()); };
  const auto mistakenForWLast = [](const Quat& q) { return Quat(q.z(), q.w(), q.x(), q.y()); };
  EXPECT_THAT(findingOf(pairsWith(mistakenForWFirst)), HasSubstr("estimate read as w last"));
  EXPECT_THAT(findingOf(pairsWith(mistakenForWLast)), HasSubstr("estimate read as w first"));
  EXPECT_THAT(findingOf(pairsWith([](const Quat& q) { return q.conjugate(); })), HasSubstr("inverse"));
  PosePairs swapped = pairsWith(mistakenForWFirst);
  std::swap(swapped.estimate, swapped.reference);
  EXPECT_THAT(findingOf(swapped), HasSubstr("reference read as w last"));
}

TEST(OrientationOrder, IsFoundForTurnsAboutOneAxisByThePositions) {
  const auto pairsOfOneAxis = [](auto read) {
    PosePairs pairs;
    for (int i = 0; i < 60; ++i) {
      const double t = 0.1 * i;
      const Rigid3 pose(Quat(Eigen::AngleAxisd(0.3 + 0.2 * t, Vec3(0.1, -0.2, 1.0).normalized())),
                        Vec3(std::cos(t), std::sin(1.3 * t), 0.3 * t + 0.2 * std::sin(3.0 * t)));
      pairs.time.push_back(Time::fromSeconds(t));
      pairs.reference.push_back(pose);
      pairs.estimate.emplace_back(read(pose.rotation), pose.translation);
    }
    return pairs;
  };
  EXPECT_EQ(findingOf(pairsOfOneAxis([](const Quat& q) { return q; })), "");
  EXPECT_THAT(findingOf(pairsOfOneAxis([](const Quat& q) { return Quat(q.x(), q.y(), q.z(), q.w()); })),
              HasSubstr("estimate read as w last"));
}

}  // namespace
}  // namespace lodeline
