#include "lodeline/inspection/findings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace lodeline {
namespace {

/// A recording with an IMU alone.
class Readings : public MeasurementSource {
 public:
  explicit Readings(std::vector<ImuSample> samples) : samples_(std::move(samples)) {}
  const Rig& rig() const override { return rig_; }
  std::optional<ImuSample> nextImu() override {
    if (next_ == samples_.size()) return std::nullopt;
    return samples_[next_++];
  }
  std::optional<PendingImage> nextImage(size_t) override { return std::nullopt; }

 private:
  Rig rig_;
  std::vector<ImuSample> samples_;
  size_t next_ = 0;
};

bool isNamed(const Inspection& inspection, const std::string& kind) {
  return std::any_of(inspection.findings.begin(), inspection.findings.end(),
                     [&](const InspectionFinding& finding) { return finding.kind == kind; });
}

Inspection judged(const std::vector<ImuSample>& samples) {
  Readings source(samples);
  Inspection inspection;
  Diagnostics diagnostics;
  inspection.imu = surveyImu(&source, &diagnostics);
  findings::judgeImu(&inspection);
  return inspection;
}

double stepped(double value, double step) { return step * std::round(value / step); }

TEST(Saturation, IsNotWhatCoarseReadingsAtRestShow) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, 1.0);
  std::vector<ImuSample> samples;
  for (int i = 0; i < 20000; ++i) {
    Vec3 rate, force;
    for (int axis = 0; axis < 3; ++axis) {
      rate[axis] = stepped(0.002 * noise(random), 0.002);
      force[axis] = stepped((axis == 2 ? 9.8 : 0.1) + 0.02 * noise(random), 0.02);
    }
    samples.push_back({Time::fromSeconds(0.005 * i), rate, force});
  }
  EXPECT_TRUE(judged(samples).findings.empty());
}

TEST(Saturation, IsNamedWhereReadingsPileUpAtTheEndOfTheRange) {
  std::vector<ImuSample> samples;
  for (int i = 0; i < 4000; ++i) {
    const double t_s = 0.005 * i;
    const Vec3 rate(std::clamp(3.0 * std::sin(2.0 * t_s), -2.18, 2.18), 0.1 * std::sin(t_s),
                    0.2 * std::cos(t_s));
    samples.push_back({Time::fromSeconds(t_s), rate, Vec3(0.1, 0.2, 9.8 + 0.01 * std::sin(7.0 * t_s))});
  }
  EXPECT_TRUE(isNamed(judged(samples), "gyroscope_saturated"));
}

TEST(Rest, TellsTheBiasOfACheapAccelerometerAndNamesAFault) {
  const auto severity = [](double force_m_per_s2) {
    std::vector<ImuSample> samples;
    for (int i = 0; i < 2000; ++i) {
      const double wobble = 1e-3 * std::sin(0.7 * i);
      samples.push_back({Time::fromSeconds(0.005 * i), Vec3(wobble, 0.5 * wobble, 0.01 - wobble),
                         Vec3(wobble, 0.3 * wobble, force_m_per_s2 + wobble)});
    }
    const Inspection inspection = judged(samples);
    return inspection.findings.empty() ? std::string("none") : toString(inspection.findings.front().severity);
  };
  EXPECT_EQ(severity(9.9), "none");
  EXPECT_EQ(severity(9.3), toString(Severity::Notice));
  EXPECT_EQ(severity(11.2), toString(Severity::Warning));
}

/// Seconds at 200 Hz of slow turning; `other` changes every other reading.
template <typename Other>
std::vector<ImuSample> alternating(Other other) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, 0.02);
  std::vector<ImuSample> samples;
  for (int i = 0; i < 4000; ++i) {
    const double t_s = 0.005 * i;
    ImuSample sample{Time::fromSeconds(t_s),
                     Vec3(0.1 * std::sin(t_s), 0.2 * std::cos(0.7 * t_s), 0.1 * std::sin(1.3 * t_s)),
                     Vec3(3.0 * std::sin(0.3 * t_s), 2.0 * std::cos(0.4 * t_s), 9.0)};
    for (int axis = 0; axis < 3; ++axis) sample.specific_force_B[axis] += noise(random);
    if (i % 2 == 1) other(t_s, &sample);
    samples.push_back(sample);
  }
  return samples;
}

TEST(Interleaved, ReadingsOfTwoSensorsAreNamed) {
  const std::vector<ImuSample> turned = alternating([](double, ImuSample* sample) {
    const Vec3 force = sample->specific_force_B;
    sample->specific_force_B = Vec3(force.y(), -force.x(), force.z());
  });
  EXPECT_TRUE(isNamed(judged(turned), "imu_interleaved"));
  const std::vector<ImuSample> biased =
      alternating([](double, ImuSample* sample) { sample->specific_force_B.z() += 0.5; });
  EXPECT_TRUE(isNamed(judged(biased), "imu_interleaved"));
}

TEST(Interleaved, OneSensorIsNotEvenWhereItVibratesNearHalfItsRate) {
  EXPECT_FALSE(isNamed(judged(alternating([](double, ImuSample*) {})), "imu_interleaved"));
  for (const double frequency_hz : {92.0, 99.0, 99.7}) {
    std::vector<ImuSample> samples = alternating([](double, ImuSample*) {});
    for (ImuSample& sample : samples) {
      const double t_s = sample.time.seconds();
      sample.specific_force_B += 3.0 * std::sin(2.0 * M_PI * frequency_hz * t_s) * Vec3(0.5, 0.2, 0.8);
    }
    EXPECT_FALSE(isNamed(judged(samples), "imu_interleaved")) << frequency_hz;
  }
}

Inspection judgedTurning(double correlation, double camera_rate, double gyroscope_rate) {
  Inspection inspection;
  inspection.rig.cameras.emplace_back();
  inspection.cameras.emplace_back();
  TurnComparison turning;
  turning.correlation = correlation;
  turning.camera_rate_rad_per_s = camera_rate;
  turning.gyroscope_rate_rad_per_s = gyroscope_rate;
  inspection.cameras.front().turning = turning;
  findings::judgeTurning(&inspection);
  return inspection;
}

TEST(Turning, OfImagesWithoutTheGyroscopeIsNamedWhereThereIsAny) {
  EXPECT_TRUE(isNamed(judgedTurning(0.3, 0.1, 0.2), "camera_unrelated"));
  EXPECT_TRUE(isNamed(judgedTurning(0.3, 0.4, 0.0), "camera_unrelated"));
  EXPECT_FALSE(isNamed(judgedTurning(0.95, 0.4, 0.4), "camera_unrelated"));
}

TEST(Turning, IsNotToldOfARigThatHangsStill) {
  const Inspection inspection = judgedTurning(0.3, 0.05, 0.02);
  EXPECT_FALSE(isNamed(inspection, "camera_unrelated"));
  EXPECT_TRUE(isNamed(inspection, "turns_too_vague"));
}

/// Two cameras at 20 Hz whose rotations agree with the gyroscope's at these offsets.
Inspection judgedPair(double correlation, double first_s, double second_s, double sigma_s = 1e-3) {
  Inspection inspection;
  for (const auto& [name, offset_s] : {std::pair{"cam0", first_s}, {"cam1", second_s}}) {
    inspection.rig.cameras.emplace_back();
    inspection.cameras.emplace_back();
    TurnComparison turning;
    turning.correlation = correlation;
    turning.camera_rate_rad_per_s = turning.gyroscope_rate_rad_per_s = 0.03;
    turning.time_offset_s = offset_s;
    turning.time_offset_sigma_s = sigma_s;
    inspection.cameras.back().survey.name = name;
    inspection.cameras.back().survey.stream.rate_hz = 20.0;
    inspection.cameras.back().turning = turning;
  }
  findings::judgeTurning(&inspection);
  return inspection;
}

std::string messageOf(const Inspection& inspection, const std::string& kind, const std::string& sensor) {
  for (const InspectionFinding& finding : inspection.findings) {
    if (finding.kind == kind && finding.sensor == sensor) return finding.message;
  }
  return "";
}

TEST(Turning, NamesALagOfWholeFrames) {
  EXPECT_THAT(messageOf(judgedPair(0.98, 0.001, -0.049), kCameraTimeOffset, "cam1"),
              testing::HasSubstr("which is 1 frame: each image carries the stamp of a later one"));
  EXPECT_THAT(messageOf(judgedPair(0.98, 0.001, 0.099), kCameraTimeOffset, "cam1"),
              testing::HasSubstr("which is 2 frames: each image carries the stamp of an earlier one"));
  EXPECT_THAT(messageOf(judgedPair(0.98, 0.001, -0.029), kCameraTimeOffset, "cam1"),
              testing::Not(testing::HasSubstr("frame")));
  EXPECT_EQ(messageOf(judgedPair(0.98, 0.001, 0.001), kCameraTimeOffset, "cam1"), "");
}

TEST(Turning, NamesALagBehindTheFirstCameraInSlowMotion) {
  // In slow motion the rotations of neither camera are clear enough to judge its offset to the gyroscope.
  const Inspection slow = judgedPair(0.8, 0.012, -0.04, 4e-3);
  EXPECT_THAT(messageOf(slow, "cameras_apart", "cam1"),
              testing::AllOf(testing::HasSubstr("52 ms (+-5.7) behind those of cam0"),
                             testing::HasSubstr("which is 1 frame"), testing::HasSubstr("to -0.0520 s")));
  EXPECT_FALSE(isNamed(judgedPair(0.8, 0.012, -0.04, 15e-3), "cameras_apart"));  // not significant
  EXPECT_FALSE(isNamed(judgedPair(0.8, 0.012, 0.001, 1e-3), "cameras_apart"));   // harmless
  EXPECT_FALSE(isNamed(judgedPair(0.5, 0.012, -0.04, 1e-3), "cameras_apart"));   // unrelated
}

}  // namespace
}  // namespace lodeline
