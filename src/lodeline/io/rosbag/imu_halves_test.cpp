#include "lodeline/io/streams/imu_halves.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <deque>

#include "lodeline/diagnostics.h"
#include "lodeline/io/euroc/test_recording.h"
#include "lodeline/io/rosbag/bag_source.h"
#include "lodeline/io/rosbag/test_bag.h"

namespace lodeline {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class ImuHalvesTest : public testing::Test {
 protected:
  /// Gyroscope at the given times, whose readings are the time; vertical specific force 9 + time.
  std::vector<ImuSample> unite(const std::vector<double>& gyroscope_s,
                               const std::vector<double>& accelerometer_s) {
    std::deque<ImuSample> gyroscope, accelerometer;
    for (const double t : gyroscope_s) gyroscope.push_back({testTime(t), Vec3(t, 0, 0), Vec3::Zero()});
    for (const double t : accelerometer_s)
      accelerometer.push_back({testTime(t), Vec3::Zero(), Vec3(0, 0, 9 + t)});
    const auto take = [](std::deque<ImuSample>* from) -> std::optional<ImuSample> {
      if (from->empty()) return std::nullopt;
      const ImuSample first = from->front();
      from->pop_front();
      return first;
    };
    std::vector<ImuSample> united;
    ImuHalves halves;
    while (auto sample =
               halves.next([&] { return take(&gyroscope); }, [&] { return take(&accelerometer); })) {
      united.push_back(*sample);
    }
    return united;
  }
};

TEST_F(ImuHalvesTest, InterpolatesTheAccelerometer) {
  const std::vector<ImuSample> united =
      unite({0.0, 0.01, 0.02, 0.03, 0.04, 0.05}, {0.005, 0.02, 0.025, 0.045});
  ASSERT_EQ(united.size(), 4u) << "none before the accelerometer's first reading, none after its last";
  for (size_t i = 0; i < united.size(); ++i) {
    const double t = 0.01 * static_cast<double>(i + 1);
    EXPECT_EQ(united[i].time, testTime(t));
    EXPECT_NEAR(united[i].angular_velocity_B.x(), t, 1e-12);
    EXPECT_NEAR(united[i].specific_force_B.z(), 9 + t, 1e-6);
  }
}

TEST_F(ImuHalvesTest, LeavesGapsOfTheAccelerometerOpen) {
  const std::vector<ImuSample> united = unite({0.011, 0.1, 0.2, 0.311}, {0.0, 0.01, 0.02, 0.3, 0.31, 0.32});
  ASSERT_EQ(united.size(), 2u);
  EXPECT_EQ(united[1].time, testTime(0.311));
}

TEST_F(ImuHalvesTest, PassesOverWhatGoesBackInTime) {
  EXPECT_EQ(unite({0.005, 0.015}, {0.0, 0.01, 0.01, 0.004, 0.02}).size(), 2u);
}

/// Bags of a RealSense camera: gyroscope and accelerometer on separate topics.
class SplitBagTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!test::hasRosbag()) GTEST_SKIP() << test::kRosbagMissing;
    test::runRosbag("halves '" + bag_.string() + "'");
  }

  BagSource open(std::map<std::string, std::string> topics) {
    BagOptions options;
    options.topics = std::move(topics);
    options.needs_calibration = false;
    return BagSource(bag_, options, &diagnostics_);
  }
  std::string refusal(std::map<std::string, std::string> topics) {
    try {
      open(std::move(topics));
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  }
  void expectWhole(BagSource source) {
    int count = 0;
    while (const std::optional<ImuSample> sample = source.nextImu()) {
      EXPECT_NEAR(sample->angular_velocity_B.x(), 0.5, 1e-12);
      EXPECT_NEAR(sample->specific_force_B.z(), 9.8, 1e-12);
      ++count;
    }
    EXPECT_EQ(count, 98) << "those between the first and the last reading of the accelerometer";
    EXPECT_NEAR(source.rig().imu.rate_hz, 200.0, 1e-6);
    EXPECT_EQ(diagnostics_.count("imu_united"), 1);
  }

  TestRecording place_;
  std::filesystem::path bag_ = place_.folder() / "halves.bag";
  Diagnostics diagnostics_;
};

TEST_F(SplitBagTest, HalvesAreFoundByTheirContent) { expectWhole(open({})); }

TEST_F(SplitBagTest, HalvesAreNamedInEitherOrder) {
  expectWhole(open({{"imu0", "/camera/accel/sample,/camera/gyro/sample"}}));
}

TEST_F(SplitBagTest, HalfAnImuIsRefused) {
  EXPECT_THAT(refusal({{"imu0", "/camera/accel/sample"}}),
              AllOf(HasSubstr("its angular velocity is zero throughout"),
                    HasSubstr("--topic imu0=/camera/accel/sample,/camera/gyro/sample")));
  EXPECT_THAT(refusal({{"imu0", "/camera/gyro/sample"}}), HasSubstr("its specific force is zero throughout"));
  EXPECT_THAT(refusal({{"imu0", "/camera/gyro/sample,/camera/gyro/sample"}}),
              HasSubstr("are not the gyroscope and the accelerometer"));
}

TEST_F(SplitBagTest, SensorsThatTheRigLacksAreRefused) {
  EXPECT_THROW(open({{"cam9", "/camera/gyro/sample"}}), UsageError);
}

}  // namespace
}  // namespace lodeline
