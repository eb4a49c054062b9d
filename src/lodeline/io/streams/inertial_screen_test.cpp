#include "lodeline/io/streams/inertial_screen.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "lodeline/util/angles.h"

namespace lodeline {
namespace {

using ::testing::HasSubstr;

constexpr double kRate_hz = 200.0;
constexpr double kGravity = 9.80665;

Time at(int i) { return Time::fromNanoseconds(1'700'000'000'000'000'000 + i * 5'000'000LL); }

double rounded(double value, double resolution) { return std::round(value / resolution) * resolution; }

/// A rig that sways by tenths of rad/s and m/s^2, with the noise and resolution of a common sensor.
std::vector<ImuSample> swaying(int readings, double resolution = 1e-3) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  std::vector<ImuSample> samples;
  for (int i = 0; i < readings; ++i) {
    const double t = i / kRate_hz;
    ImuSample sample{
        at(i), Vec3(0.4 * std::sin(3.1 * t), 0.3 * std::sin(2.3 * t + 1.0), 0.5 * std::sin(1.7 * t + 2.0)),
        Vec3(1.5 * std::sin(2.9 * t), kGravity + 0.8 * std::sin(4.1 * t), 2.0 * std::sin(1.3 * t))};
    for (int axis = 0; axis < 3; ++axis) {
      sample.angular_velocity_B[axis] =
          rounded(sample.angular_velocity_B[axis] + 2.4e-3 * normal(random), resolution);
      sample.specific_force_B[axis] =
          rounded(sample.specific_force_B[axis] + 0.03 * normal(random), 10.0 * resolution);
    }
    samples.push_back(sample);
  }
  return samples;
}

class InertialScreenTest : public ::testing::Test {
 protected:
  std::vector<ImuSample> screen(const std::vector<ImuSample>& samples,
                                const InertialScreenOptions& options = {}) {
    return screened(samples, options, &diagnostics_);
  }

  std::string message(const std::string& kind) const {
    for (const Finding& finding : diagnostics_.ranked()) {
      if (finding.kind == kind) return finding.first_message;
    }
    return "";
  }

  /// Expects every reading of `result` to equal that of `truth` at the same time.
  static void expectSame(const std::vector<ImuSample>& result, const std::vector<ImuSample>& truth,
                         double error) {
    size_t next = 0;
    for (const ImuSample& sample : result) {
      while (truth[next].time < sample.time) ++next;
      ASSERT_EQ(truth[next].time, sample.time);
      ASSERT_LE((truth[next].angular_velocity_B - sample.angular_velocity_B).norm(), error);
      ASSERT_LE((truth[next].specific_force_B - sample.specific_force_B).norm(), error);
    }
  }

  Diagnostics diagnostics_;
};

TEST_F(InertialScreenTest, LetsGoodReadingsPass) {
  for (const double resolution : {1e-9, 1e-3, 2e-2}) {
    const std::vector<ImuSample> samples = swaying(4000, resolution);
    const std::vector<ImuSample> result = screen(samples);
    // The sensor with the coarsest resolution may lose a few readings until its resolution is known.
    EXPECT_GE(result.size() + (resolution > 1e-2 ? 8 : 0), samples.size()) << resolution;
    expectSame(result, samples, 0.0);
  }
  EXPECT_TRUE(diagnostics_.ranked().empty());
}

TEST_F(InertialScreenTest, LetsKnocksAndFastTurnsPass) {
  std::vector<ImuSample> samples = swaying(2000);
  // A mechanical shock oscillates within the sensor's bandwidth and decays within 30 ms; a kick rotates the
  // rig suddenly.
  for (int i = 0; i < 20; ++i) {
    const double t = i / kRate_hz, ring = std::exp(-t / 0.01) * std::sin(2.0 * M_PI * 35.0 * t);
    samples[static_cast<size_t>(700 + i)].specific_force_B.x() += 60.0 * ring;
    samples[static_cast<size_t>(700 + i)].angular_velocity_B.z() += 3.0 * ring;
  }
  for (int i = 0; i < 100; ++i) {
    const double turn = 6.0 * std::pow(std::sin(M_PI * i / 100.0), 2);
    samples[static_cast<size_t>(1200 + i)].angular_velocity_B.y() += turn;
    samples[static_cast<size_t>(1200 + i)].specific_force_B.x() += turn * turn * 0.2;
  }
  EXPECT_EQ(screen(samples).size(), samples.size());
  EXPECT_TRUE(diagnostics_.ranked().empty());
}

TEST_F(InertialScreenTest, LeavesOutWhatNoSensorSays) {
  for (const double value : {1e3, -1e6, 1e30, 1e300, std::nan(""), HUGE_VAL}) {
    for (const int axis : {0, 2, 3, 5}) {
      const std::vector<ImuSample> truth = swaying(600);
      std::vector<ImuSample> samples = truth;
      (axis < 3 ? samples[300].angular_velocity_B[axis] : samples[300].specific_force_B[axis - 3]) = value;
      const std::vector<ImuSample> result = screen(samples);
      EXPECT_EQ(result.size(), truth.size() - 1) << value << " " << axis;
      expectSame(result, truth, 0.0);
    }
  }
  EXPECT_EQ(diagnostics_.count("imu_impossible"), 24);
  EXPECT_THAT(message("imu_impossible"), HasSubstr("1700000001500000000 ns"));
  EXPECT_THAT(message("imu_impossible"), HasSubstr("1000"));
}

TEST_F(InertialScreenTest, LeavesOutSpikesAgainstTheNeighbours) {
  const std::vector<ImuSample> truth = swaying(2000);
  std::vector<ImuSample> samples = truth;
  for (size_t i = 100; i < 1900; i += 90) samples[i].angular_velocity_B.x() += i % 180 == 100 ? 5.0 : -50.0;
  for (size_t i = 150; i < 1900; i += 90) samples[i].specific_force_B.z() += 50.0;
  samples[1901].specific_force_B.z() -= 30.0;
  samples[1902].specific_force_B.z() += 30.0;  // two consecutive ones
  const std::vector<ImuSample> result = screen(samples);
  EXPECT_EQ(result.size(), truth.size() - 42);
  expectSame(result, truth, 0.0);
  EXPECT_EQ(diagnostics_.count("imu_spike"), 42);
}

TEST_F(InertialScreenTest, LeavesOutRowsOfZeros) {
  const std::vector<ImuSample> truth = swaying(600);
  std::vector<ImuSample> samples = truth;
  for (size_t i = 100; i < 110; ++i)
    samples[i].angular_velocity_B = samples[i].specific_force_B = Vec3::Zero();
  expectSame(screen(samples), truth, 0.0);
  EXPECT_EQ(diagnostics_.count("imu_zero"), 10);

  for (ImuSample& sample : samples) sample.angular_velocity_B = sample.specific_force_B = Vec3::Zero();
  EXPECT_TRUE(screen(samples).empty());
  EXPECT_THAT(message("imu_unusable"), HasSubstr("600 readings are zero"));
}

TEST_F(InertialScreenTest, LeavesOutAStuckStretchAndSaysHowLongItIs) {
  const std::vector<ImuSample> truth = swaying(1000);
  std::vector<ImuSample> samples = truth;
  for (size_t i = 400; i < 600; ++i) {
    samples[i] = samples[399];
    samples[i].time = at(static_cast<int>(i));
  }
  const std::vector<ImuSample> result = screen(samples);
  EXPECT_EQ(result.size(), 800u);
  expectSame(result, truth, 0.0);
  EXPECT_THAT(message("imu_unusable"), HasSubstr("0.995 s after 1700000002000000000 ns"));
  EXPECT_EQ(diagnostics_.ranked().front().severity, Severity::Serious);
}

TEST_F(InertialScreenTest, LeavesOutAGyroscopeThatHangsWhileTheAccelerometerMoves) {
  for (const Vec3& value : {Vec3(0.1, 0.2, -0.1), Vec3(Vec3::Zero())}) {
    for (const size_t begin : {size_t{0}, size_t{400}}) {
      std::vector<ImuSample> samples = swaying(1000);
      for (size_t i = begin; i < samples.size(); ++i) samples[i].angular_velocity_B = value;
      EXPECT_LT(screen(samples).size(), begin + 250) << begin;
    }
  }
  EXPECT_GT(diagnostics_.count("imu_stuck"), 0);
}

TEST_F(InertialScreenTest, TakesHeldReadingsOnceEach) {
  std::vector<ImuSample> samples = swaying(1200), truth = samples;
  for (size_t i = 0; i < samples.size(); ++i) {
    const Time time = samples[i].time;
    samples[i] = truth[i - i % 3];
    samples[i].time = time;
  }
  const std::vector<ImuSample> result = screen(samples);
  EXPECT_LT(result.size(), 410u);
  expectSame({result.begin() + 20, result.end()}, truth, 0.0);
  EXPECT_THAT(message("imu_held"), HasSubstr("figure by figure the one before"));
  EXPECT_EQ(diagnostics_.count("imu_unusable"), 0);
}

TEST_F(InertialScreenTest, KeepsRepetitionsOfACoarseSensorAtRest) {
  std::vector<ImuSample> samples = swaying(400, 0.01);
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (int i = 400; i < 2000; ++i) {
    // Motion decays; then noise of a fifth of the resolution remains.
    const double motion = std::exp(-(i - 400) / 40.0);
    ImuSample sample = samples[static_cast<size_t>(i % 400)];
    sample.time = at(i);
    for (int axis = 0; axis < 3; ++axis) {
      sample.angular_velocity_B[axis] =
          rounded(motion * sample.angular_velocity_B[axis] + 2e-3 * normal(random), 0.01);
      sample.specific_force_B[axis] =
          rounded((axis == 1 ? kGravity : 0.0) + motion * normal(random) + 0.02 * normal(random), 0.1);
    }
    samples.push_back(sample);
  }
  EXPECT_GT(screen(samples).size(), samples.size() - 20);
  EXPECT_TRUE(diagnostics_.ranked().empty());
}

TEST_F(InertialScreenTest, TakesASaturatedSensorForUnusableThere) {
  std::vector<ImuSample> samples = swaying(4000);
  size_t clipped = 0, passed = 0;
  for (ImuSample& sample : samples) {
    const double rate = sample.angular_velocity_B.z();
    sample.angular_velocity_B.z() = std::clamp(rate, -0.3, 0.3);
    clipped += std::abs(rate) >= 0.3 ? 1 : 0;
  }
  for (const ImuSample& sample : screen(samples))
    passed += std::abs(sample.angular_velocity_B.z()) >= 0.3 ? 1 : 0;
  EXPECT_GT(clipped, 1500u);
  EXPECT_LT(passed, 100u);  // the first plateau
  EXPECT_EQ(static_cast<size_t>(diagnostics_.count("imu_saturated")), clipped - passed);
}

TEST_F(InertialScreenTest, ConvertsAnAccelerometerInGOrMilliG) {
  for (const double unit : {kGravity, 1e-3 * kGravity}) {
    const std::vector<ImuSample> truth = swaying(600);
    std::vector<ImuSample> samples = truth;
    for (ImuSample& sample : samples) sample.specific_force_B /= unit;
    Diagnostics diagnostics;
    const std::vector<ImuSample> result = screened(samples, {}, &diagnostics);
    EXPECT_EQ(result.size(), truth.size());
    expectSame(result, truth, 1e-9);
    ASSERT_EQ(diagnostics.ranked().size(), 1u);
    EXPECT_EQ(diagnostics.ranked().front().kind, "accelerometer_unit");
    EXPECT_EQ(diagnostics.ranked().front().severity, Severity::Serious);
    EXPECT_THAT(diagnostics.ranked().front().first_message, HasSubstr(unit > 1.0 ? "in g," : "in mg,"));
  }
}

TEST_F(InertialScreenTest, ConvertsAGyroscopeThatIsKnownToBeInDegrees) {
  const std::vector<ImuSample> truth = swaying(600);
  std::vector<ImuSample> samples = truth;
  for (ImuSample& sample : samples) sample.angular_velocity_B /= kDegree;
  InertialScreenOptions options;
  options.rate_to_SI = kDegree;
  const std::vector<ImuSample> result = screen(samples, options);
  EXPECT_EQ(result.size(), truth.size());
  expectSame(result, truth, 1e-9);
}

TEST_F(InertialScreenTest, FollowsUnitsThatChangeInMidStream) {
  struct Change {
    double rate, force;
    const char* words;
  };
  for (const Change& change :
       {Change{1.0 / kDegree, 1.0, "rad/s to deg/s"}, Change{1.0, 1.0 / kGravity, "to g"},
        Change{1.0, 1e3 / kGravity, "to mg"}, Change{1.0 / kDegree, 1.0 / kGravity, " and "}}) {
    const std::vector<ImuSample> truth = swaying(1000);
    std::vector<ImuSample> samples = truth;
    for (size_t i = 500; i < samples.size(); ++i) {
      samples[i].angular_velocity_B *= change.rate;
      samples[i].specific_force_B *= change.force;
    }
    Diagnostics diagnostics;
    const std::vector<ImuSample> result = screened(samples, {}, &diagnostics);
    EXPECT_EQ(result.size(), truth.size()) << change.words;
    expectSame(result, truth, 1e-9);
    ASSERT_EQ(diagnostics.ranked().size(), 1u) << change.words;
    EXPECT_EQ(diagnostics.ranked().front().kind, "imu_changes");
    EXPECT_THAT(diagnostics.ranked().front().first_message, HasSubstr(change.words));
    EXPECT_THAT(diagnostics.ranked().front().first_message, HasSubstr("1700000002500000000 ns"));
  }
}

TEST_F(InertialScreenTest, FollowsAnAxisThatChangesItsSign) {
  const std::vector<ImuSample> truth = swaying(1000);
  std::vector<ImuSample> samples = truth;
  for (size_t i = 500; i < samples.size(); ++i) samples[i].specific_force_B.y() *= -1.0;
  expectSame(screen(samples), truth, 0.0);
  EXPECT_THAT(message("imu_changes"), HasSubstr("accelerometer's y axis changes its sign"));
}

TEST_F(InertialScreenTest, LooksNoFurtherAheadThanItMust) {
  const std::vector<ImuSample> samples = swaying(600);
  size_t pulled = 0;
  InertialScreen screen([&]() -> std::optional<ImuSample> { return samples[pulled++]; }, {}, &diagnostics_);
  for (size_t i = 0; i < 500; ++i) {
    ASSERT_NE(screen.peek(), nullptr);
    EXPECT_EQ(pulled, i + 1);
    screen.pop();
  }
}

}  // namespace
}  // namespace lodeline
