#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lodeline/diagnostics.h"
#include "lodeline/io/euroc/test_recording.h"
#include "lodeline/io/rosbag/bag_source.h"
#include "lodeline/io/rosbag/convert/ros1_writer.h"
#include "lodeline/io/rosbag/messages.h"

namespace lodeline {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

/// Bags with wrong header stamps. The IMU was recorded at 200 Hz from 1000 s on.
class BagStampsTest : public testing::Test {
 protected:
  static Time received(int i) { return Time::fromNanoseconds(1'000'000'000'000 + int64_t{5'000'000} * i); }

  template <typename StampOf>
  void write(const StampOf& stampOf) {
    try {
      Ros1Writer writer(bag_, "none");
      for (int i = 0; i < 100; ++i) {
        const ImuSample sample{stampOf(i), Vec3(i, 2.0, 3.0), Vec3(4.0, 5.0, 9.8)};
        writer.write("/imu", messages::kImu.name, received(i),
                     messages::imu(sample, static_cast<uint32_t>(i)));
      }
      writer.close();
    } catch (const UsageError& error) {
      GTEST_SKIP() << error.what();
    }
  }

  BagSource open(bool use_received_times) {
    BagOptions options;
    options.with_cameras = options.needs_calibration = false;
    options.use_received_times = use_received_times;
    return BagSource(bag_, options, &diagnostics_);
  }

  void expectRefusal(const char* why) {
    EXPECT_THAT([&] { open(false); }, ThrowsMessage<InputError>(AllOf(HasSubstr("/imu"), HasSubstr(why),
                                                                      HasSubstr("--received-times"))));
  }

  void expectTimesOfRecording() {
    BagSource source = open(true);
    EXPECT_NEAR(source.rig().imu.rate_hz, 200.0, 1e-6);
    for (int i = 0; i < 100; ++i) {
      const std::optional<ImuSample> sample = source.nextImu();
      ASSERT_TRUE(sample);
      EXPECT_EQ(sample->time, received(i));
      EXPECT_EQ(sample->angular_velocity_B.x(), i);
    }
    EXPECT_FALSE(source.nextImu());
  }

  TestRecording place_;
  std::filesystem::path bag_ = place_.folder() / "stamps.bag";
  Diagnostics diagnostics_;
};

TEST_F(BagStampsTest, StampsOfZeroAreRefusedOrReplacedByTimesOfRecording) {
  write([](int) { return Time(); });
  if (IsSkipped()) return;
  expectRefusal("all have the stamp 0 ns");
  expectTimesOfRecording();
}

TEST_F(BagStampsTest, StampsThatCountAnotherUnitAreRefused) {
  for (const int64_t step_ns : {int64_t{5'000}, int64_t{5'000'000'000}}) {
    write([&](int i) { return Time::fromNanoseconds(step_ns * (i + 1)); });
    if (IsSkipped()) return;
    expectRefusal("another unit");
    expectTimesOfRecording();
  }
}

TEST_F(BagStampsTest, StampsOfAnotherClockAreFine) {
  write([](int i) { return Time::fromNanoseconds(int64_t{5'000'000} * i + 77); });
  if (IsSkipped()) return;
  BagSource source = open(false);
  EXPECT_EQ(source.nextImu()->time.nanoseconds(), 77);
  EXPECT_NEAR(source.rig().imu.rate_hz, 200.0, 1e-6);
}

}  // namespace
}  // namespace lodeline
