#include "lodeline/inspection/survey/magnetometer_survey.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "lodeline/inspection/survey/inertial_path.h"
#include "lodeline/inspection/survey/signed_axes.h"
#include "lodeline/util/median.h"

namespace lodeline {
namespace {

constexpr double kMagnetometerGapPeriods = 4.0;
/// Length of a window, in which the gyroscope alone gives the attitude; the effect of its bias is small.
constexpr double kWindow_s = 8.0;
/// Readings per window, and number of windows, to limit the computing time for long recordings.
constexpr size_t kRowsPerWindow = 80;
constexpr size_t kMostWindows = 12;
/// Minimum rotation of the rig within a window, rad.
constexpr double kLeastTurn_rad = 0.35;

/// Readings of one time span.
using Window = std::vector<MagnetometerSample>;

/// Sum of squares of the compensated field after subtraction of the best constant field and hard iron; and
/// the number of readings.
struct Remainder {
  double squares = 0.0;
  double count = 0.0;
  double turn_rad = 0.0;
  double relative(double field) const { return count > 0.0 ? std::sqrt(squares / count) / field : 0.0; }
};

Remainder remainderOf(const std::vector<Window>& windows, const InertialPath& path, const Mat3& axes,
                      Duration offset) {
  Remainder result;
  Mat3 hessian = Mat3::Zero();
  Vec3 gradient = Vec3::Zero();
  double squares = 0.0;
  for (const Window& window : windows) {
    std::vector<Mat3> attitudes;
    std::vector<Vec3> fields;
    Mat3 mean_attitude = Mat3::Zero();
    Vec3 mean_field = Vec3::Zero();
    for (const MagnetometerSample& sample : window) {
      const std::optional<Mat3> attitude = path.attitude(sample.time + offset);
      if (!attitude) continue;
      attitudes.push_back(*attitude);
      fields.push_back(*attitude * axes * sample.field_M);
      mean_attitude += *attitude;
      mean_field += fields.back();
    }
    if (fields.size() < kRowsPerWindow / 4) continue;
    const auto count = static_cast<double>(fields.size());
    for (size_t i = 0; i < fields.size(); ++i) {
      const Mat3 jacobian = attitudes[i] - mean_attitude / count;
      const Vec3 deviation = fields[i] - mean_field / count;
      hessian += jacobian.transpose() * jacobian;
      gradient += jacobian.transpose() * deviation;
      squares += deviation.squaredNorm();
      result.turn_rad =
          std::max(result.turn_rad, Eigen::AngleAxisd(Mat3(attitudes[0].transpose() * attitudes[i])).angle());
    }
    result.count += count;
  }
  // The prior allows a hard iron as large as the field itself: with little rotation a larger one would be
  // arbitrary.
  const double prior = result.count * 1e-3;
  const Vec3 iron = (hessian + prior * Mat3::Identity()).ldlt().solve(gradient);
  result.squares = std::max(0.0, squares - 2.0 * iron.dot(gradient) + iron.dot(hessian * iron));
  return result;
}

std::vector<Window> windowsOf(const std::vector<MagnetometerSample>& readings,
                              const std::vector<ImuSample>& imu) {
  std::vector<Window> windows;
  if (readings.empty() || imu.empty()) return windows;
  const Duration length = Duration::fromSeconds(kWindow_s);
  for (size_t begin = 0; begin < readings.size();) {
    size_t end = begin;
    while (end < readings.size() && readings[end].time < readings[begin].time + length) ++end;
    const size_t every = std::max<size_t>(1, (end - begin) / kRowsPerWindow);
    Window window;
    for (size_t i = begin; i < end; i += every) window.push_back(readings[i]);
    if (window.size() >= kRowsPerWindow / 4) windows.push_back(std::move(window));
    begin = std::max(end, begin + 1);
  }
  const size_t keep = std::max<size_t>(1, windows.size() / kMostWindows);
  std::vector<Window> chosen;
  for (size_t i = 0; i < windows.size(); i += keep) chosen.push_back(std::move(windows[i]));
  return chosen;
}

std::optional<FieldTurning> compareWithGyroscope(const std::vector<MagnetometerSample>& readings,
                                                 const std::vector<ImuSample>& imu,
                                                 const MagnetometerCalibration& calibration, double field) {
  const std::vector<Window> windows = windowsOf(readings, imu);
  const InertialPath path(imu, medianRate_B(imu));
  const Mat3 given = calibration.body_from_magnetometer.rotation.toRotationMatrix();
  const Duration offset = Duration::fromSeconds(calibration.time_offset_to_imu_s);
  const Remainder as_recorded = remainderOf(windows, path, given, offset);
  if (as_recorded.count < 40.0 || as_recorded.turn_rad < kLeastTurn_rad) return std::nullopt;
  FieldTurning turning;
  turning.scatter = turning.best_scatter = turning.scatter_at_offset = as_recorded.relative(field);
  for (const Mat3& axes : signedAxes()) {
    const double scatter = remainderOf(windows, path, axes * given, offset).relative(field);
    if (scatter >= turning.best_scatter) continue;
    turning.best_scatter = scatter;
    turning.best_axes = axes;
  }
  constexpr double kSearch_s = 0.2, kStep_s = 5e-3;
  for (int i = -static_cast<int>(kSearch_s / kStep_s); i <= static_cast<int>(kSearch_s / kStep_s); ++i) {
    const Duration shift = Duration::fromSeconds(i * kStep_s);
    const double scatter = remainderOf(windows, path, given, offset + shift).relative(field);
    if (scatter >= turning.scatter_at_offset) continue;
    turning.scatter_at_offset = scatter;
    turning.time_offset_s = shift.seconds();
  }
  return turning;
}

/// Mean angle of the field below the horizon. The vertical is the accelerometer's mean over the second around
/// each reading.
std::optional<double> inclinationOf(const std::vector<MagnetometerSample>& readings,
                                    const std::vector<ImuSample>& imu,
                                    const MagnetometerCalibration& calibration) {
  std::vector<double> angles;
  const Duration half = Duration::fromSeconds(0.5);
  const size_t every = std::max<size_t>(1, readings.size() / 200);
  for (size_t i = 0; i < readings.size(); i += every) {
    const auto begin =
        std::lower_bound(imu.begin(), imu.end(), readings[i].time - half,
                         [](const ImuSample& sample, Time time) { return sample.time < time; });
    Vec3 force = Vec3::Zero();
    for (auto sample = begin; sample != imu.end() && sample->time < readings[i].time + half; ++sample) {
      force += sample->specific_force_B;
    }
    const Vec3 field_B = calibration.corrected_B(readings[i].field_M);
    if (force.isZero() || field_B.isZero()) continue;
    angles.push_back(-std::asin(std::clamp(force.normalized().dot(field_B.normalized()), -1.0, 1.0)));
  }
  if (angles.size() < 10) return std::nullopt;
  return median(angles);
}

}  // namespace

MagnetometerSurvey surveyMagnetometer(MeasurementSource* source, const std::vector<ImuSample>& imu) {
  MagnetometerSurvey survey;
  StreamSurvey stream;
  std::vector<MagnetometerSample> readings;
  while (const std::optional<MagnetometerSample> sample = source->nextMagnetometer()) {
    stream.add(sample->time, !readings.empty() && sample->field_M == readings.back().field_M);
    readings.push_back(*sample);
  }
  survey.stream = stream.summarize(kMagnetometerGapPeriods);
  if (readings.empty()) return survey;
  std::vector<double> sizes;
  double squares = 0.0;
  for (const MagnetometerSample& sample : readings) sizes.push_back(sample.field_M.norm());
  const double size = median(sizes);
  for (const double s : sizes) squares += (s - size) * (s - size) / static_cast<double>(sizes.size());
  survey.unit = unitBySize(size);
  survey.field_T = size * teslaPer(survey.unit);
  survey.field_spread = size > 0.0 ? std::sqrt(squares) / size : 0.0;
  std::stable_sort(readings.begin(), readings.end(),
                   [](const MagnetometerSample& a, const MagnetometerSample& b) { return a.time < b.time; });
  const MagnetometerCalibration& calibration = *source->rig().magnetometer;
  survey.inclination_rad = inclinationOf(readings, imu, calibration);
  if (size > 0.0 && imu.size() > 100) survey.turning = compareWithGyroscope(readings, imu, calibration, size);
  return survey;
}

}  // namespace lodeline
