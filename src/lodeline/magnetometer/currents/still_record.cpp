#include "lodeline/magnetometer/currents/still_record.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "lodeline/magnetometer/currents/current_track.h"
#include "lodeline/magnetometer/iron/reading_screen.h"

namespace lodeline {
namespace {

constexpr double kMostRows = 4000.0;
constexpr int kFewestRows = 100;
constexpr double kShortest_s = 10.0;
constexpr double kKnots_s = 60.0;
constexpr double kLongestGap_s = 1.0;                       // between current readings
constexpr double kAssumedDip_rad = std::numbers::pi / 3.0;  // where no accelerometer tells

/// Values of the hat functions of equally spaced knots.
Eigen::MatrixXd hatFunctions(const Eigen::VectorXd& times_s) {
  const double duration_s = times_s[times_s.size() - 1];
  const int spans = std::max(1, static_cast<int>(std::lround(duration_s / kKnots_s)));
  Eigen::MatrixXd values = Eigen::MatrixXd::Zero(times_s.size(), spans + 1);
  for (Eigen::Index row = 0; row < times_s.size(); ++row) {
    const double at = std::clamp(times_s[row] / duration_s, 0.0, 1.0) * spans;
    const int span = std::min(spans - 1, static_cast<int>(at));
    values(row, span) = 1.0 - (at - span);
    values(row, span + 1) = at - span;
  }
  return values;
}

/// Integrals of the gyroscope's rate up to the table's times; they leave out rotations that do not commute,
/// which is exact enough for a few degrees.
Eigen::MatrixXd integratedRates(const StillTest& test, const TestTable& table) {
  const Duration to_imu = Duration::fromSeconds(test.calibration.time_offset_to_imu_s);
  Eigen::MatrixXd angles(table.times_s.size(), 3);
  Vec3 angle = Vec3::Zero();
  size_t i = 0;
  for (Eigen::Index row = 0; row < table.times_s.size(); ++row) {
    const Time time = table.begin + Duration::fromSeconds(table.times_s[row]) + to_imu;
    for (; i + 1 < test.imu.size() && test.imu[i + 1].time <= time; ++i) {
      const double step_s = (test.imu[i + 1].time - test.imu[i].time).seconds();
      angle += 0.5 * step_s * (test.imu[i].angular_velocity_B + test.imu[i + 1].angular_velocity_B);
    }
    angles.row(row) = angle.transpose();
  }
  return angles;
}

Eigen::MatrixXd besides(const Eigen::MatrixXd& baseline, const Eigen::MatrixXd& columns) {
  return columns - baseline * baseline.colPivHouseholderQr().solve(columns);
}

/// Mean direction of the specific force, which points up at rest.
std::optional<Vec3> upwards_B(const std::vector<ImuSample>& imu) {
  Vec3 sum = Vec3::Zero();
  for (const ImuSample& sample : imu) sum += sample.specific_force_B;
  if (imu.empty() || !(sum.norm() > 0.0)) return std::nullopt;
  return sum.normalized();
}

void describeHeading(const StillTest& test, TestTable* table) {
  const MagnetometerCalibration& magnetometer = test.calibration;
  const Vec3 reading_T = 1e-6 * table->readings_uT.colwise().mean().transpose();
  const Mat3 field_by_reading =
      magnetometer.body_from_magnetometer.rotation.toRotationMatrix() * magnetometer.iron_correction;
  const Vec3 field_B = magnetometer.corrected_B(reading_T);
  const std::optional<Vec3> up_B = upwards_B(test.imu);
  table->is_level_known = up_B.has_value();
  Vec3 east_by_field;  // rad/T
  if (up_B) {
    const Vec3 horizontal_B = field_B - *up_B * up_B->dot(field_B);
    east_by_field = up_B->cross(horizontal_B) / horizontal_B.squaredNorm();
  } else {
    // Any direction across the field; all are equally likely.
    const Vec3 across_B = field_B.unitOrthogonal();
    east_by_field = across_B / (field_B.norm() * std::cos(kAssumedDip_rad));
  }
  table->heading_by_reading = 1e-6 * field_by_reading.transpose() * east_by_field;
}

}  // namespace

Eigen::MatrixXd TestTable::currentsAt(const StillTest& test, double lag_s) const {
  CurrentTrack track(test.channels.size(), kLongestGap_s);
  for (const CurrentSample& sample : test.currents) track.add(sample);
  Eigen::MatrixXd currents_A =
      Eigen::MatrixXd::Constant(times_s.size(), static_cast<Eigen::Index>(test.channels.size()),
                                std::numeric_limits<double>::quiet_NaN());
  for (Eigen::Index row = 0; row < times_s.size(); ++row) {
    const auto now = track.at(begin + Duration::fromSeconds(times_s[row] - lag_s));
    if (now && now->isMeasured()) currents_A.row(row) = now->currents_A.transpose();
  }
  return currents_A;
}

TestTable tabulate(const StillTest& test, Diagnostics* diagnostics) {
  const std::vector<MagnetometerSample> usable = screenReadings(test.magnetometer, diagnostics).usable;
  const int in_row = std::max(1, static_cast<int>(std::ceil(static_cast<double>(usable.size()) / kMostRows)));
  const Eigen::Index rows = static_cast<Eigen::Index>(usable.size()) / in_row;
  if (rows < kFewestRows || (usable.back().time - usable.front().time).seconds() < kShortest_s) {
    throw EstimationError(fmt::format(
        "{} usable magnetometer readings are too few; a still test takes a minute or longer, with "
        "a ramp of each channel",
        usable.size()));
  }
  TestTable table;
  table.begin = usable.front().time;
  table.times_s.setZero(rows);
  table.readings_uT.setZero(rows, 3);
  for (Eigen::Index row = 0; row < rows; ++row) {
    for (int i = 0; i < in_row; ++i) {
      const MagnetometerSample& sample = usable[static_cast<size_t>(row * in_row + i)];
      table.times_s[row] += (sample.time - table.begin).seconds() / in_row;
      table.readings_uT.row(row) += 1e6 / in_row * sample.field_M.transpose();
    }
  }
  table.baseline = hatFunctions(table.times_s);
  table.rotation_B.resize(rows, 0);
  if (test.imu.size() > 1) table.rotation_B = besides(table.baseline, integratedRates(test, table));
  describeHeading(test, &table);
  return table;
}

}  // namespace lodeline
