#include "lodeline/inspection/findings.h"

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

}  // namespace
}  // namespace lodeline
