#include "lodeline/inspection/start_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "lodeline/inspection/survey/excerpt_source.h"
#include "lodeline/util/angles.h"

namespace lodeline {
namespace {

using ::testing::HasSubstr;

/// A recording of inertial readings alone at 200 Hz, given by a function of time.
class MadeUpSource : public MeasurementSource {
 public:
  using Reading = std::function<ImuSample(double time_s)>;
  MadeUpSource(Reading reading, int readings) : reading_(std::move(reading)), readings_(readings) {}

  const Rig& rig() const override { return rig_; }
  std::optional<ImuSample> nextImu() override {
    if (next_ == readings_) return std::nullopt;
    const double time_s = 0.005 * next_++;
    ImuSample sample = reading_(time_s);
    sample.time = Time::fromSeconds(100.0 + time_s);
    return sample;
  }
  std::optional<PendingImage> nextImage(size_t) override { return std::nullopt; }

 private:
  Rig rig_;
  Reading reading_;
  int readings_;
  int next_ = 0;
};

/// Rolls and pitches by up to 40 degrees without translation, with the noise of a common sensor.
ImuSample tumbling(double time_s, std::mt19937* random) {
  const double roll = 0.7 * std::sin(1.3 * time_s), roll_rate = 0.91 * std::cos(1.3 * time_s);
  const double pitch = 0.6 * std::sin(0.9 * time_s), pitch_rate = 0.54 * std::cos(0.9 * time_s);
  ImuSample sample;
  sample.angular_velocity_B = Vec3(roll_rate, pitch_rate * std::cos(roll), -pitch_rate * std::sin(roll));
  sample.specific_force_B =
      9.80665 * Vec3(-std::sin(pitch), std::cos(pitch) * std::sin(roll), std::cos(pitch) * std::cos(roll));
  std::normal_distribution<double> normal;
  for (int axis = 0; axis < 3; ++axis) {
    sample.angular_velocity_B[axis] += 2e-3 * normal(*random);
    sample.specific_force_B[axis] += 2e-2 * normal(*random);
  }
  return sample;
}

class StartCheckTest : public testing::Test {
 protected:
  StartCheck check(const MadeUpSource::Reading& reading, int readings = 4000) {
    return checkStart([&](Diagnostics*) { return std::make_unique<MadeUpSource>(reading, readings); },
                      "dive7", StartCheckOptions(), &diagnostics_);
  }
  MadeUpSource::Reading tumble() {
    return [this](double time_s) { return tumbling(time_s, &random_); };
  }

  std::mt19937 random_{1};
  Diagnostics diagnostics_;
};

TEST_F(StartCheckTest, SaysNothingOfASoundRecording) {
  const StartCheck result = check(tumble());
  EXPECT_EQ(result.rate_to_SI, 1.0);
  EXPECT_NEAR(result.noise.gyroscope_rad_per_s_sqrtHz, 2e-3 * std::sqrt(0.005), 5e-5);
  EXPECT_TRUE(diagnostics_.ranked().empty());
}

TEST_F(StartCheckTest, FindsTheGyroscopesUnitByTheTurningOfGravity) {
  const StartCheck result = check([this](double time_s) {
    ImuSample sample = tumbling(time_s, &random_);
    sample.angular_velocity_B /= kDegree;
    return sample;
  });
  EXPECT_NEAR(result.rate_to_SI, kDegree, 1e-12);
  ASSERT_EQ(diagnostics_.ranked().size(), 1u);
  EXPECT_EQ(diagnostics_.ranked().front().kind, "gyroscope_unit");
  EXPECT_THAT(diagnostics_.ranked().front().first_message, HasSubstr("this run converts them"));
}

TEST_F(StartCheckTest, FindsTheOtherUnitsOfGyroscopes) {
  for (const auto& [name, to_SI] : {std::pair{"rpm", 6.0 * kDegree}, {"mrad/s", 1e-3}}) {
    diagnostics_ = {};
    const StartCheck result = check([&, unit = to_SI](double time_s) {
      ImuSample sample = tumbling(time_s, &random_);
      sample.angular_velocity_B /= unit;
      return sample;
    });
    EXPECT_NEAR(result.rate_to_SI, to_SI, 1e-12) << name;
    ASSERT_EQ(diagnostics_.count("gyroscope_unit"), 1) << name;
    EXPECT_THAT(diagnostics_.ranked().front().first_message, HasSubstr(std::string("is in ") + name));
  }
}

TEST_F(StartCheckTest, DistrustsAGyroscopeInOtherAxesThanTheAccelerometer) {
  check([this](double time_s) {
    ImuSample sample = tumbling(time_s, &random_);
    const Vec3 rate = sample.angular_velocity_B;
    sample.angular_velocity_B = Vec3(rate.y(), rate.x(), rate.z());
    return sample;
  });
  EXPECT_EQ(diagnostics_.count("imu_axes"), 1);
  ASSERT_EQ(diagnostics_.count(kSensorsContradict), 1);
  for (const Finding& finding : diagnostics_.ranked()) {
    EXPECT_THAT(finding.first_message, HasSubstr("`lodeline inspect dive7`"));
  }
}

TEST_F(StartCheckTest, SaysNothingOfARigThatRests) {
  const StartCheck result = check([this](double) {
    ImuSample sample = tumbling(0.0, &random_);
    sample.angular_velocity_B -= Vec3(0.91, 0.54, 0.0);
    return sample;
  });
  EXPECT_EQ(result.rate_to_SI, 1.0);
  EXPECT_TRUE(diagnostics_.ranked().empty());
}

TEST(ExcerptSource, HoldsItsPartOnly) {
  ExcerptSource source(std::make_unique<MadeUpSource>([](double) { return ImuSample(); }, 4000), 5.0, 2.0);
  int readings = 0;
  std::optional<Time> first, last;
  while (const std::optional<ImuSample> sample = source.nextImu()) {
    if (!first) first = sample->time;
    last = sample->time;
    ++readings;
  }
  EXPECT_EQ(first, Time::fromSeconds(104.0));  // a second before the part
  EXPECT_EQ(last, Time::fromSeconds(107.0));
  EXPECT_EQ(readings, 601);
}

}  // namespace
}  // namespace lodeline
