#include <gtest/gtest.h>
#include <zlib.h>

#include <array>
#include <memory>
#include <numbers>
#include <optional>

#include "lodeline/ahrs/attitude_filter.h"
#include "lodeline/imu/test_real_recording.h"
#include "lodeline/util/files/test_data.h"

// Attitude compared with optical ground truth: BROAD (Laidig et al., Data 2021), a consumer IMU rotated and
// moved by hand; EuRoC.

namespace lodeline {
namespace {

constexpr double kRate_hz = 285.7142857;

struct BroadRow {
  ImuSample imu;
  MagnetometerSample field;
  std::optional<Quat> truth;  ///< world (x east, y magnetic north, z up) from sensor
};

std::vector<BroadRow> readBroad(const std::filesystem::path& file) {
  const std::unique_ptr<gzFile_s, int (*)(gzFile)> stream(gzopen(file.c_str(), "rb"), gzclose);
  std::vector<BroadRow> rows;
  std::array<char, 1024> line;
  if (!stream || gzgets(stream.get(), line.data(), line.size()) == nullptr) return rows;
  while (gzgets(stream.get(), line.data(), line.size()) != nullptr) {
    std::array<double, 13> n{};
    char* at = line.data();
    for (double& number : n) {
      number = std::strtod(at, &at);
      ++at;
    }
    BroadRow row;
    row.imu = {Time::fromSeconds(static_cast<double>(rows.size()) / kRate_hz), Vec3(n.data()),
               Vec3(n.data() + 3)};
    row.field = {row.imu.time, 1e-6 * Vec3(n.data() + 6)};
    if (std::isfinite(n[9])) row.truth = Quat(n[9], n[10], n[11], n[12]).normalized();
    rows.push_back(row);
  }
  return rows;
}

/// Sums over an attitude's errors. The rotation error is split into one about the vertical and one about a
/// horizontal axis.
struct HeadingAndTilt {
  double heading = 0.0, inclination = 0.0, normalized = 0.0;
  int count = 0;
  std::optional<double> start_rad;

  /// `from_start`: heading is relative to the first one.
  void add(const AttitudeEstimate& estimate, const Quat& truth, bool from_start) {
    const Quat error = estimate.world_from_body * truth.conjugate();
    const double about_up = 2.0 * std::atan2(error.z(), error.w());
    if (!start_rad) start_rad = from_start ? about_up : 0.0;
    const double heading_rad = std::remainder(about_up - *start_rad, 2.0 * std::numbers::pi);
    heading += heading_rad * heading_rad;
    inclination += std::pow(2.0 * std::acos(std::min(1.0, std::hypot(error.w(), error.z()))), 2);
    normalized += std::pow(heading_rad / std::max(1e-6, estimate.heading_sigma_rad), 2);
    ++count;
  }
  double headingRmse_deg() const { return std::sqrt(heading / count) * 180.0 / std::numbers::pi; }
  double inclinationRmse_deg() const { return std::sqrt(inclination / count) * 180.0 / std::numbers::pi; }
  /// Mean squared heading error in units of sigma.
  double normalizedHeading() const { return normalized / count; }
};

/// Without a magnetometer, the heading is initialized with the truth.
HeadingAndTilt run(const std::vector<BroadRow>& rows, bool with_magnetometer) {
  Diagnostics diagnostics;
  std::optional<MagnetometerCalibration> magnetometer;
  if (with_magnetometer) magnetometer.emplace().rate_hz = kRate_hz;
  AttitudeFilter filter({}, magnetometer, &diagnostics);
  HeadingAndTilt errors;
  for (const BroadRow& row : rows) {
    filter.add(row.imu);
    if (with_magnetometer) filter.add(row.field);
    if (row.truth) errors.add(*filter.estimate(), *row.truth, !with_magnetometer);
  }
  return errors;
}

class Broad : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = testData("broad");
    if (!folder_) GTEST_SKIP() << missingTestData("broad");
  }
  std::vector<BroadRow> rows(const char* name) const { return readBroad(*folder_ / name); }

 private:
  std::optional<std::filesystem::path> folder_;
};

TEST_F(Broad, UndisturbedHeadingIsWithinThreeDegrees) {
  for (const char* name : {"02_undisturbed_slow_rotation_B.csv.gz", "07_undisturbed_fast_rotation_B.csv.gz",
                           "16_undisturbed_fast_translation_B.csv.gz"}) {
    const auto trial = rows(name);
    ASSERT_FALSE(trial.empty()) << name;
    const HeadingAndTilt errors = run(trial, true);
    RecordProperty(name, std::to_string(errors.headingRmse_deg()));
    EXPECT_LE(errors.headingRmse_deg(), 3.0) << name;
    EXPECT_LE(errors.inclinationRmse_deg(), 3.0) << name;
    EXPECT_LE(errors.normalizedHeading(), 2.0) << name;
  }
}

TEST_F(Broad, AMagnetNearbyDoesNoHarm) {
  const auto trial = rows("28_disturbed_stationary_magnet_A.csv.gz");
  ASSERT_FALSE(trial.empty());
  const HeadingAndTilt with = run(trial, true);
  const HeadingAndTilt without = run(trial, false);
  EXPECT_LE(with.headingRmse_deg(), without.headingRmse_deg());
  EXPECT_NEAR(with.inclinationRmse_deg(), without.inclinationRmse_deg(), 0.1);
}

// Aggressive flight for 107 s with a gyroscope bias of 4.6 deg/s, no magnetometer. Heading is relative to the
// first truth.
TEST(Flight, DriftsLittleInHeadingAndTilt) {
  const auto folder = testData("euroc_imu_gt");
  if (!folder) GTEST_SKIP() << missingTestData("euroc_imu_gt");
  const auto file = [&](const char* name) { return *folder / name; };
  const RealRecording recording =
      readRealRecording(file("V1_03_difficult_imu0.csv.gz"), file("V1_03_difficult_groundtruth.csv.gz"));
  Diagnostics diagnostics;
  AttitudeFilter filter({}, std::nullopt, &diagnostics);
  HeadingAndTilt errors;
  auto truth = recording.truth.begin();
  for (const ImuSample& sample : recording.readings) {
    filter.add(sample);
    while (truth != recording.truth.end() && truth->time < sample.time) ++truth;
    if (truth == recording.truth.end() || truth->time != sample.time) continue;
    errors.add(*filter.estimate(), truth->world_from_body.rotation, true);
  }
  EXPECT_GT(errors.count, 15000);
  EXPECT_LE(errors.headingRmse_deg(), 1.0);
  EXPECT_LE(errors.inclinationRmse_deg(), 2.5);
}

}  // namespace
}  // namespace lodeline
