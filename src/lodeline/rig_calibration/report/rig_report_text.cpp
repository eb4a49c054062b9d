#include <fmt/format.h>
#include <fmt/ranges.h>

#include "lodeline/cameras/camera_model.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/rig_calibration/report/rig_report.h"
#include "lodeline/util/angles.h"

namespace lodeline {
namespace {

std::string row(const std::string& name, double value, std::optional<double> sigma, const char* unit,
                int digits) {
  const std::string first = fmt::format("  {:<22}{:>12.{}f}", name, value, digits);
  if (!sigma) return fmt::format("{}              {}\n", first, unit);
  return fmt::format("{}  +- {:<9.{}f} {}\n", first, *sigma, digits + 1, unit);
}

std::string rowOfThree(const std::string& name, const Vec3& value, const std::optional<Vec3>& sigma,
                       const char* unit, int digits) {
  std::string text = fmt::format("  {:<22}{:>12.{}f} {:>10.{}f} {:>10.{}f}", name, value.x(), digits,
                                 value.y(), digits, value.z(), digits);
  if (sigma)
    text += fmt::format("  +- {:.{}f} {:.{}f} {:.{}f}", sigma->x(), digits + 1, sigma->y(), digits + 1,
                        sigma->z(), digits + 1);
  return text + fmt::format(" {}\n", unit);
}

std::string lensRows(const CameraCalibrationResult& camera) {
  const CameraCalibration& c = camera.calibration;
  const auto sigma = [&](size_t i) -> std::optional<double> {
    return camera.lens_sigmas.empty() ? std::nullopt : std::optional(camera.lens_sigmas[i]);
  };
  std::string text = row("fx", c.fx_px, sigma(0), "px", 3) + row("fy", c.fy_px, sigma(1), "px", 3) +
                     row("cx", c.cx_px, sigma(2), "px", 3) + row("cy", c.cy_px, sigma(3), "px", 3);
  const CameraModel& model = cameraModel(c);
  for (size_t i = 0; i < c.distortion.size(); ++i)
    text += row(std::string(model.parameters[i]), c.distortion[i], sigma(4 + i), "", 5);
  if (camera.lens_sigmas.empty()) text += "  the lens was kept as stated\n";
  return text;
}

std::string portPlaceRows(const Port& port, const std::optional<Vec3>& sigmas) {
  if (port.type == Port::Type::Dome) {
    return rowOfThree("dome centre", 1e3 * port.centre_C,
                      sigmas ? std::optional<Vec3>(1e3 * *sigmas) : std::nullopt, "mm", 2);
  }
  std::string text = fmt::format("  {:<22}{:>12.5f} {:>10.5f} {:>10.5f}", "port normal", port.normal_C.x(),
                                 port.normal_C.y(), port.normal_C.z());
  if (sigmas)
    text +=
        fmt::format("  +- {:.3f} {:.3f} degrees about x, y", sigmas->x() / kDegree, sigmas->y() / kDegree);
  return text + "\n" +
         row("port distance", 1e3 * port.distance_m, sigmas ? std::optional(1e3 * sigmas->z()) : std::nullopt,
             "mm", 2);
}

std::string portRows(const CameraCalibrationResult& camera) {
  const std::optional<Port>& port = camera.calibration.port;
  if (!port) return "";
  const std::string text = portPlaceRows(*port, camera.port_sigmas);
  if (!camera.port_sigmas) return text + "  the port was kept as stated\n";
  return text + row("index of the water", port->index_water, camera.index_sigma,
                    camera.index_sigma ? "" : "as stated", 5);
}

std::string poseRows(const std::string& to, const Rigid3& pose, const std::optional<PoseSigmas>& sigmas) {
  std::optional<Vec3> turn, shift;
  if (sigmas) {
    turn = sigmas->rotation_rad / kDegree;
    shift = 1e3 * sigmas->translation_m;
  }
  return rowOfThree("rotation to " + to, so3::log(pose.rotation) / kDegree, turn, "degrees", 3) +
         rowOfThree("position on " + to, 1e3 * pose.translation, shift, "mm", 2);
}

std::string cameraText(const CameraCalibrationResult& camera, bool is_first, bool has_imu) {
  const CameraCalibration& c = camera.calibration;
  std::string text = fmt::format("\n{}: {}, {} x {} px\n", c.name, c.model, c.width_px, c.height_px);
  text += fmt::format("  {:<22}{} of {} images, {} corners\n", "board found", camera.views, camera.images,
                      camera.corners.size());
  text += fmt::format("  {:<22}{:.3f} px rms; sigma of a corner {:.3f} px; {:.1f} % do not fit\n", "residual",
                      camera.rms_px, camera.sigma_px, 100.0 * camera.outlier_share);
  text += fmt::format("  {:<22}{:.0f} % of the image; tilts up to {:.0f} degrees\n", "coverage",
                      100.0 * camera.coverage_share, camera.largest_tilt_rad / kDegree);
  text += lensRows(camera) + portRows(camera);
  if (!is_first) text += poseRows("cam0", camera.first_from_camera, camera.first_sigmas);
  if (!has_imu) return text;
  text += poseRows("IMU", c.body_from_camera, camera.body_sigmas);
  std::optional<double> delay_sigma_ms;
  if (camera.delay_sigma_s) delay_sigma_ms = 1e3 * *camera.delay_sigma_s;
  return text + row("delay to IMU", 1e3 * c.time_offset_to_imu_s, delay_sigma_ms,
                    "ms (stamp + this = IMU clock)", 3);
}

}  // namespace

std::string rigCalibrationText(const RigCalibrationResult& result) {
  std::string text = fmt::format("Verdict: {}\n", toString(result.verdict));
  for (const CalibrationDoubt& doubt : result.doubts)
    text += fmt::format("  {}: {}\n", toString(doubt.verdict), doubt.text);
  text += fmt::format("Board: {}\n", boardWords(result.board));
  text += fmt::format(
      "Sigmas are one standard deviation, enlarged up to {:.1f} times by the scatter between images\n",
      result.sigma_inflation);
  for (size_t k = 0; k < result.cameras.size(); ++k)
    text += cameraText(result.cameras[k], k == 0, result.inertial.has_value());
  if (!result.inertial) return text + fmt::format("\nWithout IMU: {}\n", result.without_inertial);
  const InertialResult& imu = *result.inertial;
  text += "\nIMU\n" +
          rowOfThree("gyroscope bias", imu.gyroscope_bias_B / kDegree, std::nullopt, "degrees/s", 4) +
          rowOfThree("accelerometer bias", imu.accelerometer_bias_B, std::nullopt, "m/s^2", 4);
  text += fmt::format("  {:<22}{:.2f} times what the noise densities say\n", "error of readings",
                      imu.inertial_error);
  text += fmt::format("  {:<22}+- {:.3f} degrees each against the body, beyond the sigmas; no motion tells\n",
                      "axes of the IMU", imu_axes::sigmaFor(result.rig.imu.noise) / kDegree);
  text += fmt::format("  {:<22}{:.2f} rad/s and {:.2f} m/s^2 about and along the axis with the least\n",
                      "motion", imu.least_rate_rad_per_s, imu.least_acceleration_m_per_s2);
  return text;
}

}  // namespace lodeline
