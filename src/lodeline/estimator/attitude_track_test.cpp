#include "lodeline/estimator/attitude_track.h"

#include <gtest/gtest.h>

#include "lodeline/imu/gravity.h"

namespace lodeline {
namespace {

const Vec3 kField_W(0.0, 20e-6, -40e-6);

/// A level rig at rest that looks along its x axis to the east, in packets of a tenth of a second.
FramePacket packetOf(int index) {
  FramePacket packet;
  packet.time = Time::fromSeconds(0.1 * (index + 1));
  for (int i = 0; i <= 20; ++i) {
    ImuSample sample;
    sample.time = Time::fromSeconds(0.1 * index + 0.005 * i);
    sample.specific_force_B = -standardGravity_W();
    packet.imu.push_back(sample);
  }
  for (int i = 1; i <= 5; ++i) {
    const Vec3 noise = 1e-9 * Vec3(i, index % 7, 0);
    packet.readings.of<MagnetometerSample>().push_back(
        {Time::fromSeconds(0.1 * index + 0.02 * i), kField_W + noise});
  }
  return packet;
}

TEST(AttitudeTrack, KnowsAttitudeWithoutAnyImage) {
  Diagnostics diagnostics;
  Rig rig;
  rig.magnetometer.emplace().rate_hz = 50.0;
  AttitudeTrack track(rig, {}, &diagnostics);
  std::optional<AttitudeEstimate> last;
  for (int i = 0; i < 100; ++i) last = track.add(packetOf(i));
  ASSERT_TRUE(last);
  EXPECT_EQ(last->time, Time::fromSeconds(10.0));
  EXPECT_EQ(last->status, HeadingStatus::Magnetic);
  EXPECT_LT(last->world_from_body.angularDistance(Quat::Identity()), 0.01);
  // The readings at the borders of packets, which come twice, are not an error.
  EXPECT_TRUE(diagnostics.ranked().empty());
}

TEST(AttitudeTrack, HasNothingToSayWithoutReadings) {
  Diagnostics diagnostics;
  AttitudeTrack track(Rig(), {}, &diagnostics);
  FramePacket packet;
  EXPECT_FALSE(track.add(packet));
  packet = packetOf(0);
  packet.readings.of<MagnetometerSample>().clear();
  const auto& estimate = track.add(packet);
  ASSERT_TRUE(estimate);
  EXPECT_EQ(estimate->status, HeadingStatus::NoMagnetometer);
}

}  // namespace
}  // namespace lodeline
