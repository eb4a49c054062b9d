#include "lodeline/inspection/survey/camera_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lodeline/util/angles.h"

namespace lodeline {
namespace {

/// Name of the nearest axis, e.g. "+x", with the angle to it where that is not small.
std::string nearestAxis(const Vec3& direction) {
  int axis = 0;
  direction.cwiseAbs().maxCoeff(&axis);
  const double angle_deg = kDegreesPerRadian * std::acos(std::min(1.0, std::abs(direction[axis])));
  const std::string name = fmt::format("{}{}", direction[axis] < 0.0 ? '-' : '+', "xyz"[axis]);
  return angle_deg < 5.0 ? name : fmt::format("{} ({:.0f} deg off)", name, angle_deg);
}

}  // namespace

bool isCalibrated(const CameraCalibration& camera) { return camera.width_px > 0; }

std::string describeAxes(const CameraCalibration& camera) {
  const Mat3 rotation = camera.body_from_camera.rotation.toRotationMatrix();
  return fmt::format("looks along the body's {}; the top of its image points along {}, its right along {}",
                     nearestAxis(rotation.col(2)), nearestAxis(-rotation.col(1)),
                     nearestAxis(rotation.col(0)));
}

std::string describeGravity(const CameraCalibration& camera, const Vec3& up_B) {
  const Vec3 down_C = camera.body_from_camera.rotation.conjugate() * -up_B;
  const double pitch_deg = kDegreesPerRadian * std::asin(std::clamp(down_C.z(), -1.0, 1.0));
  if (std::abs(pitch_deg) > 60.0) {
    return fmt::format("looks {}, {:.0f} deg off the vertical", pitch_deg > 0.0 ? "down" : "up",
                       90.0 - std::abs(pitch_deg));
  }
  const double roll_deg = kDegreesPerRadian * std::atan2(down_C.x(), down_C.y());
  const char* word = std::abs(roll_deg) < 45.0    ? "upright"
                     : std::abs(roll_deg) > 135.0 ? "upside down"
                                                  : "on its side";
  return fmt::format(
      "{} on average (gravity {:.0f} deg off the image's downward direction, {:.0f} deg {} its plane)", word,
      std::abs(roll_deg), std::abs(pitch_deg), pitch_deg > 0.0 ? "in front of" : "behind");
}

}  // namespace lodeline
