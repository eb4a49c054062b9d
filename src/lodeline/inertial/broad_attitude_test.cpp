#include <gtest/gtest.h>
#include <zlib.h>

#include <array>
#include <memory>
#include <numbers>

#include "lodeline/base/test_data.h"
#include "lodeline/inertial/attitude_filter.h"

// BROAD (Laidig et al., Data 2021): a consumer IMU beside optical markers; attitude against theirs.

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

struct Errors {
  double heading_rmse_deg = 0.0;
  double inclination_rmse_deg = 0.0;
  double normalised = 0.0;  ///< mean squared heading error in sigmas
};

/// Without a magnetometer heading starts from the truth.
Errors run(const std::vector<BroadRow>& rows, bool with_magnetometer) {
  Diagnostics diagnostics;
  std::optional<MagnetometerCalibration> magnetometer;
  if (with_magnetometer) magnetometer.emplace().rate_hz = kRate_hz;
  AttitudeFilter filter({}, magnetometer, &diagnostics);
  Errors sums;
  std::optional<double> start_rad;
  int count = 0;
  for (const BroadRow& row : rows) {
    filter.add(row.imu);
    if (with_magnetometer) filter.add(row.field);
    if (!row.truth) continue;
    const AttitudeEstimate& estimate = *filter.estimate();
    const Quat error = estimate.world_from_body * row.truth->conjugate();
    double heading = 2.0 * std::atan2(error.z(), error.w());
    if (!start_rad) start_rad = with_magnetometer ? 0.0 : heading;
    heading = std::remainder(heading - *start_rad, 2.0 * std::numbers::pi);
    sums.heading_rmse_deg += heading * heading;
    sums.inclination_rmse_deg +=
        std::pow(2.0 * std::acos(std::min(1.0, std::hypot(error.w(), error.z()))), 2);
    sums.normalised += std::pow(heading / std::max(1e-6, estimate.heading_sigma_rad), 2);
    ++count;
  }
  const auto rmse_deg = [&](double sum) { return std::sqrt(sum / count) * 180.0 / std::numbers::pi; };
  return {rmse_deg(sums.heading_rmse_deg), rmse_deg(sums.inclination_rmse_deg), sums.normalised / count};
}

class Broad : public ::testing::Test {
 protected:
  std::vector<BroadRow> rows(const char* name) {
    const auto folder = testDataDir();
    if (!folder || !std::filesystem::exists(*folder / "broad" / name)) return {};
    return readBroad(*folder / "broad" / name);
  }
};

#define REQUIRE_ROWS(rows) \
  if (rows.empty()) GTEST_SKIP() << "shared/data/broad is missing"

TEST_F(Broad, UndisturbedHeadingIsWithinThreeDegrees) {
  for (const char* name : {"02_undisturbed_slow_rotation_B.csv.gz", "07_undisturbed_fast_rotation_B.csv.gz",
                           "16_undisturbed_fast_translation_B.csv.gz"}) {
    const auto trial = rows(name);
    REQUIRE_ROWS(trial);
    const Errors errors = run(trial, true);
    RecordProperty(name, std::to_string(errors.heading_rmse_deg));
    EXPECT_LE(errors.heading_rmse_deg, 3.0) << name;
    EXPECT_LE(errors.inclination_rmse_deg, 3.0) << name;
    EXPECT_LE(errors.normalised, 2.0) << name;
  }
}

TEST_F(Broad, AMagnetNearbyDoesNoHarm) {
  const auto trial = rows("28_disturbed_stationary_magnet_A.csv.gz");
  REQUIRE_ROWS(trial);
  const Errors with = run(trial, true);
  const Errors without = run(trial, false);
  EXPECT_LE(with.heading_rmse_deg, without.heading_rmse_deg);
  EXPECT_NEAR(with.inclination_rmse_deg, without.inclination_rmse_deg, 0.1);
}

}  // namespace
}  // namespace lodeline
