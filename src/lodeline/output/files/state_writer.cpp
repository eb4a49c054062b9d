#include "lodeline/output/files/state_writer.h"

#include <fmt/format.h>
#include <fmt/ostream.h>

#include <cmath>
#include <limits>

#include "lodeline/geometry/so3.h"
#include "lodeline/problem/covariance.h"
#include "lodeline/util/files/output_file.h"
#include "lodeline/util/time/time_steps.h"

namespace lodeline {
namespace {

constexpr const char* kStateHeader =
    "#timestamp [ns],status,keyframe,tracks,landmarks,reprojection_rms [sigma],"
    "p_x [m],p_y [m],p_z [m],q_w,q_x,q_y,q_z,v_x [m/s],v_y [m/s],v_z [m/s],"
    "b_g_x [rad/s],b_g_y [rad/s],b_g_z [rad/s],b_a_x [m/s^2],b_a_y [m/s^2],b_a_z [m/s^2],"
    "sigma_p_x [m],sigma_p_y [m],sigma_p_z [m],sigma_theta_x [rad],sigma_theta_y [rad],sigma_theta_z [rad],"
    "sigma_v_x [m/s],sigma_v_y [m/s],sigma_v_z [m/s],sigma_b_g_x [rad/s],sigma_b_g_y [rad/s],sigma_b_g_z "
    "[rad/s],"
    "sigma_b_a_x [m/s^2],sigma_b_a_y [m/s^2],sigma_b_a_z [m/s^2]";

void append(fmt::memory_buffer& line, const Vec3& v) {
  fmt::format_to(std::back_inserter(line), ",{:.9g},{:.9g},{:.9g}", v.x(), v.y(), v.z());
}

constexpr const char* kAttitudeHeader =
    ",attitude_q_w,attitude_q_x,attitude_q_y,attitude_q_z,attitude_sigma_heading [rad],attitude_status";

/// Standard deviation of a variance; for an invalid variance, the sigma that means "unknown". nan stays
/// nan.
double sigma(double variance) { return std::sqrt(variance <= 0.0 ? kUnknownVariance : variance); }

constexpr const char* kMagnetometerHeader =
    ",sigma_heading [rad],magnetometer,field_x [T],field_y [T],field_z [T],offset_x [T],offset_y "
    "[T],offset_z [T],north_from_world [rad]";

constexpr const char* kDepthHeader = ",pressure,depth [m],depth_at_origin [m],density_ratio,pressure_lag [s]";

constexpr const char* kPosteriorHeader =
    ",posterior_sigma_p_x [m],posterior_sigma_p_y [m],posterior_sigma_p_z [m],posterior_sigma_theta_x [rad],"
    "posterior_sigma_theta_y [rad],posterior_sigma_theta_z [rad]";

/// Header of the pose covariance's upper triangle, [p, theta] in world axes, and of the covariance of v_x and
/// v_y.
std::string covarianceHeader() {
  std::string header;
  for (int row = 0; row < 6; ++row) {
    for (int column = row; column < 6; ++column) header += fmt::format(",cov_pose_{}{}", row, column);
  }
  return header + ",cov_v_01";
}

/// Appends the magnetometer's columns; values that are not estimated are nan.
void appendMagnetometer(fmt::memory_buffer& line, const MagnetometerEstimate& magnetometer) {
  const Vec3 unknown = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
  fmt::format_to(std::back_inserter(line), ",{:.9g},{}", magnetometer.heading_sigma_rad,
                 toString(magnetometer.status));
  append(line, magnetometer.field_W.value_or(unknown));
  append(line, magnetometer.offset_B.value_or(unknown));
  fmt::format_to(std::back_inserter(line), ",{:.9g}",
                 magnetometer.north_from_world_rad.value_or(unknown.x()));
}

/// Appends the gauge's columns; values that are not estimated are nan.
void appendDepth(fmt::memory_buffer& line, const DepthEstimate& depth) {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  DepthEstimate::Gauge unknown{kUnknown, kUnknown, kUnknown, kUnknown, kUnknown, kUnknown};
  const DepthEstimate::Gauge gauge = depth.gauge.value_or(unknown);
  fmt::format_to(std::back_inserter(line), ",{},{:.9g},{:.9g},{:.9g},{:.9g}", toString(depth.status),
                 gauge.body_depth_m, gauge.depth_at_origin_m, gauge.density_ratio, gauge.lag_s);
}

void appendAttitude(fmt::memory_buffer& line, const std::optional<AttitudeEstimate>& attitude) {
  if (!attitude) {
    fmt::format_to(std::back_inserter(line), ",nan,nan,nan,nan,nan,none");
    return;
  }
  const Quat& q = attitude->world_from_body;
  fmt::format_to(std::back_inserter(line), ",{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{}", q.w(), q.x(), q.y(),
                 q.z(), attitude->heading_sigma_rad, toString(attitude->status));
}

/// A frame with an attitude and no other estimates.
FrameEstimate withAttitudeOnly(const FrameEstimate& frame, const AttitudeEstimate& attitude) {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  FrameEstimate known = frame;
  known.state.world_from_body = Rigid3(attitude.world_from_body, Vec3::Constant(kUnknown));
  known.state.velocity_W.setConstant(kUnknown);
  known.state.accelerometer_bias_B.setConstant(kUnknown);
  known.state.gyroscope_bias_B = attitude.gyroscope_bias_B;
  known.covariance.setConstant(kUnknown);
  known.posterior_covariance.setConstant(kUnknown);
  known.covariance(5, 5) = attitude.heading_sigma_rad * attitude.heading_sigma_rad;
  known.sensors.of<MagnetometerEstimate>().heading_sigma_rad = attitude.heading_sigma_rad;
  return known;
}

/// The estimator's values as one line without its end.
fmt::memory_buffer stateLine(const FrameEstimate& estimate, const char* status) {
  const NavigationState& state = estimate.state;
  const Quat q = so3::canonical(state.world_from_body.rotation);
  fmt::memory_buffer line;
  fmt::format_to(std::back_inserter(line), "{},{},{},{},{},{:.4g}", estimate.time.nanoseconds(), status,
                 estimate.is_keyframe ? 1 : 0, estimate.tracks, estimate.landmarks,
                 estimate.reprojection_rms_sigmas);
  append(line, state.world_from_body.translation);
  fmt::format_to(std::back_inserter(line), ",{:.9g},{:.9g},{:.9g},{:.9g}", q.w(), q.x(), q.y(), q.z());
  append(line, state.velocity_W);
  append(line, state.gyroscope_bias_B);
  append(line, state.accelerometer_bias_B);
  for (int i = 0; i < 15; i += 3)
    append(line, estimate.covariance.diagonal().segment<3>(i).unaryExpr(&sigma));
  for (int row = 0; row < 6; ++row) {
    for (int column = row; column < 6; ++column) {
      fmt::format_to(std::back_inserter(line), ",{:.9g}", estimate.covariance(row, column));
    }
  }
  fmt::format_to(std::back_inserter(line), ",{:.9g}", estimate.covariance(6, 7));
  appendMagnetometer(line, estimate.sensors.of<MagnetometerEstimate>());
  return line;
}

}  // namespace

StateWriter::StateWriter(const std::filesystem::path& folder, const std::string& suffix,
                         const std::vector<std::string>& sensor_columns)
    : trajectory_(folder / ("trajectory" + suffix + ".tum")),
      file_(folder / ("states" + suffix + ".csv")),
      states_(openOutput(file_)) {
  states_ << kStateHeader << covarianceHeader() << kMagnetometerHeader << kAttitudeHeader << kDepthHeader
          << kPosteriorHeader;
  for (const std::string& name : sensor_columns) states_ << "," << name;
  states_ << "\n" << std::flush;
}

void StateWriter::write(const FrameEstimate& estimate, const std::optional<AttitudeEstimate>& attitude) {
  const bool has_pose = estimate.status != Status::Waiting;
  if (!has_pose && !attitude) return;
  if (has_pose) trajectory_.write(estimate.time, estimate.state.world_from_body);
  fmt::memory_buffer line = has_pose ? stateLine(estimate, toString(estimate.status))
                                     : stateLine(withAttitudeOnly(estimate, *attitude), "attitude");
  appendAttitude(line, attitude);
  appendDepth(line, estimate.sensors.of<DepthEstimate>());
  for (int i = 0; i < 6; i += 3)
    append(line, estimate.posterior_covariance.diagonal().segment<3>(i).unaryExpr(&sigma));
  for (const SensorRow& row : estimate.sensor_rows) {
    for (const auto& [name, value] : row.columns) fmt::format_to(std::back_inserter(line), ",{}", value);
  }
  states_ << fmt::to_string(line) << "\n" << std::flush;
  if (!states_) {
    throw InputError(file_.string() + ": writing failed at " + std::to_string(estimate.time.nanoseconds()) +
                     " ns; is the disk full?");
  }
}

}  // namespace lodeline
