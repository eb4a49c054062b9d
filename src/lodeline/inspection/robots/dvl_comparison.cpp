#include "lodeline/inspection/robots/dvl_comparison.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "lodeline/inspection/survey/signed_axes.h"

namespace lodeline {
namespace {

/// Length of a window, in which attitude and integral of the specific force are accurate enough.
constexpr double kWindow_s = 8.0;
constexpr size_t kFewestInWindow = 10, kMostWindows = 60;
constexpr int kFewestPings = 40;

struct TimedVelocity {
  Time time;
  Vec3 velocity_D;
};
using Window = std::vector<TimedVelocity>;

std::vector<Window> windowsOf(const std::vector<DvlSample>& pings, const DvlCalibration& dvl) {
  std::vector<Window> windows;
  const Duration length = Duration::fromSeconds(kWindow_s);
  Window window;
  const auto close = [&] {
    if (window.size() >= kFewestInWindow) windows.push_back(window);
    window.clear();
  };
  for (const DvlSample& ping : pings) {
    const std::optional<Vec3> velocity_D =
        ping.track == DvlTrack::Bottom ? velocityOf(ping, dvl) : std::nullopt;
    if (!velocity_D) continue;
    if (!window.empty() && (ping.time < window.back().time || ping.time > window.front().time + length))
      close();
    window.push_back({ping.time, *velocity_D});
  }
  close();
  const size_t every = std::max<size_t>(1, windows.size() / kMostWindows);
  std::vector<Window> chosen;
  for (size_t i = 0; i < windows.size(); i += every) chosen.push_back(std::move(windows[i]));
  return chosen;
}

struct Sum {
  double squares = 0.0;         ///< of the remainder
  double motion_squares = 0.0;  ///< of the change of velocity by the IMU
  int count = 0;

  double rms(double squared) const { return count > 0 ? std::sqrt(squared / count) : 0.0; }
};

/// Sum of squares of vectors after subtraction of the best line over time.
double squaresAboutLine(const std::vector<double>& times_s, const std::vector<Vec3>& values) {
  const auto count = static_cast<double>(values.size());
  double mean_time_s = 0.0, spread = 0.0;
  Vec3 mean = Vec3::Zero(), slope = Vec3::Zero();
  for (size_t i = 0; i < values.size(); ++i) {
    mean_time_s += times_s[i] / count;
    mean += values[i] / count;
  }
  for (size_t i = 0; i < values.size(); ++i) {
    spread += (times_s[i] - mean_time_s) * (times_s[i] - mean_time_s);
    slope += (times_s[i] - mean_time_s) * (values[i] - mean);
  }
  if (spread > 0.0) slope /= spread;
  double squares = 0.0;
  for (size_t i = 0; i < values.size(); ++i)
    squares += (values[i] - mean - (times_s[i] - mean_time_s) * slope).squaredNorm();
  return squares;
}

Sum remainderOf(const std::vector<Window>& windows, const DvlCalibration& dvl, const InertialPath& path,
                const Mat3& axes, Duration offset) {
  Sum sum;
  const Mat3 body_from_dvl = dvl.body_from_dvl.rotation.toRotationMatrix();
  for (const Window& window : windows) {
    std::vector<double> times_s;
    std::vector<Vec3> differences, motions;
    for (const TimedVelocity& reading : window) {
      const Time time = reading.time + offset;
      const std::optional<Mat3> attitude = path.attitude(time);
      if (!attitude) continue;
      const Vec3 lever_velocity_B = path.rate_B(time)->cross(dvl.body_from_dvl.translation);
      const Vec3 velocity_B = axes * body_from_dvl * reading.velocity_D - lever_velocity_B;
      times_s.push_back((reading.time - window.front().time).seconds());
      motions.push_back(*path.forceIntegral(time));
      differences.push_back(*attitude * velocity_B - motions.back());
    }
    if (differences.size() < kFewestInWindow) continue;
    sum.squares += squaresAboutLine(times_s, differences);
    sum.motion_squares += squaresAboutLine(times_s, motions);
    sum.count += static_cast<int>(differences.size());
  }
  return sum;
}

}  // namespace

std::optional<Vec3> velocityOf(const DvlSample& ping, const DvlCalibration& dvl) {
  if (ping.velocity_D) return ping.velocity_D;
  Mat3 normal = Mat3::Zero();
  Vec3 right = Vec3::Zero();
  int beams = 0;
  for (const DvlBeam& beam : ping.beams) {
    if (!beam.velocity_m_per_s || static_cast<size_t>(beam.index) >= dvl.beams_D.size()) continue;
    const Vec3& beam_D = dvl.beams_D[static_cast<size_t>(beam.index)];
    normal += beam_D * beam_D.transpose();
    right += *beam.velocity_m_per_s * beam_D;
    ++beams;
  }
  if (beams < 3) return std::nullopt;
  const Eigen::LDLT<Mat3> solver(normal);
  const Vec3 velocity_D = solver.solve(right);
  return velocity_D.allFinite() ? std::optional(velocity_D) : std::nullopt;
}

std::optional<DvlComparison> compareDvl(const std::vector<DvlSample>& pings, const DvlCalibration& dvl,
                                        const InertialPath& path) {
  const std::vector<Window> windows = windowsOf(pings, dvl);
  const Duration offset = Duration::fromSeconds(dvl.time_offset_to_imu_s);
  const Sum recorded = remainderOf(windows, dvl, path, Mat3::Identity(), offset);
  if (recorded.count < kFewestPings) return std::nullopt;
  DvlComparison result;
  result.pings = recorded.count;
  result.motion_m_per_s = recorded.rms(recorded.motion_squares);
  result.remainder_m_per_s = recorded.rms(recorded.squares);
  result.best_remainder_m_per_s = result.remainder_at_offset_m_per_s = result.remainder_m_per_s;
  for (const Mat3& axes : signedAxes()) {
    const Sum sum = remainderOf(windows, dvl, path, axes, offset);
    if (sum.rms(sum.squares) >= result.best_remainder_m_per_s) continue;
    result.best_remainder_m_per_s = sum.rms(sum.squares);
    result.best_axes = axes;
  }
  constexpr int kSteps = 50;
  constexpr double kStep_s = 0.02;
  for (int i = -kSteps; i <= kSteps; ++i) {
    const Duration shift = Duration::fromSeconds(i * kStep_s);
    const Sum sum = remainderOf(windows, dvl, path, Mat3::Identity(), offset + shift);
    // Fewer pings lie within the inertial readings where the shift is large.
    if (2 * sum.count < recorded.count || sum.rms(sum.squares) >= result.remainder_at_offset_m_per_s)
      continue;
    result.remainder_at_offset_m_per_s = sum.rms(sum.squares);
    result.time_offset_s = shift.seconds();
  }
  return result;
}

}  // namespace lodeline
