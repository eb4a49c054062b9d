#include <algorithm>
#include <array>
#include <cmath>

#include "lodeline/cameras/camera_model.h"
#include "lodeline/cameras/image_place.h"

namespace lodeline {
namespace {

constexpr double kConvergedStepRad = 1e-13;
/// Tangent of the angle to the axis below which the series is used. There the series is exact to machine
/// precision, and the closed form would divide zero by zero.
constexpr double kNearAxis = 1e-4;

/// Fisheye camera model. The image radius theta_d is a polynomial of the angle theta to the optical axis:
///
///     theta_d = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8)
///
/// Source: J. Kannala, S. Brandt, "A generic camera model and calibration method for conventional,
/// wide-angle, and fish-eye lenses", PAMI 2006, as used by OpenCV's fisheye module and Kalibr. The model is
/// valid beyond 90 degrees while the polynomial increases, at most to the 115 degrees of the widest lenses
/// made.
class EquidistantCamera final : public Camera {
 public:
  explicit EquidistantCamera(const CameraCalibration& calibration);

  std::optional<Vec2> project(const Vec3& point_C, Mat23* pixel_by_point,
                              PixelByParameters* pixel_by_parameters) const override;
  std::optional<Vec3> unproject(const Vec2& pixel) const override;
  double maxAngle_rad() const override { return max_angle_rad_; }

 private:
  double distort(double theta, double* derivative) const;
  double findMaxAngle() const;

  std::array<double, 4> k_{};
  double max_angle_rad_ = 0.0;
  double max_distorted_ = 0.0;
};

EquidistantCamera::EquidistantCamera(const CameraCalibration& calibration) : Camera(calibration) {
  std::copy_n(calibration.distortion.begin(), std::min(calibration.distortion.size(), k_.size()), k_.begin());
  max_angle_rad_ = findMaxAngle();
  max_distorted_ = distort(max_angle_rad_, nullptr);
}

double EquidistantCamera::distort(double theta, double* derivative) const {
  const double t2 = theta * theta;
  const auto& [k1, k2, k3, k4] = k_;
  if (derivative) *derivative = 1.0 + t2 * (3.0 * k1 + t2 * (5.0 * k2 + t2 * (7.0 * k3 + t2 * 9.0 * k4)));
  return theta * (1.0 + t2 * (k1 + t2 * (k2 + t2 * (k3 + t2 * k4))));
}

double EquidistantCamera::findMaxAngle() const {
  const auto rises = [this](double theta) {
    double slope = 0.0;
    distort(theta, &slope);
    return slope > 0.0;
  };
  constexpr int kSteps = 2000;
  double good = 0.0;
  for (int i = 1; i <= kSteps; ++i) {
    double bad = kWidestLens_rad * i / kSteps;
    if (rises(bad)) {
      good = bad;
      continue;
    }
    while (bad - good > 1e-14) {
      const double middle = 0.5 * (good + bad);
      if (middle <= good || middle >= bad) break;
      (rises(middle) ? good : bad) = middle;
    }
    break;
  }
  return good;
}

std::optional<Vec2> EquidistantCamera::project(const Vec3& point_C, Mat23* pixel_by_point,
                                               PixelByParameters* pixel_by_parameters) const {
  const double x = point_C.x(), y = point_C.y(), z = point_C.z();
  const double rho2 = x * x + y * y;
  const double rho = std::sqrt(rho2);
  const double theta = std::atan2(rho, z);
  const double distance2 = rho2 + z * z;
  if (!(distance2 > 0.0) || !(theta <= max_angle_rad_)) return std::nullopt;

  // Image radius = scale * rho; `bend` is the derivative of scale by rho, divided by rho.
  double slope = 0.0;
  const double distorted = distort(theta, &slope);
  double scale = 0.0, bend = 0.0;
  if (rho < kNearAxis * z) {
    const double curvature = k_[0] - 1.0 / 3.0;
    scale = (1.0 + curvature * rho2 / (z * z)) / z;
    bend = 2.0 * curvature / (z * z * z);
  } else {
    scale = distorted / rho;
    bend = (slope * z / distance2 - scale) / rho2;
  }

  const CameraCalibration& c = calibration();
  if (pixel_by_point) {
    const double scale_by_z = -slope / distance2;
    *pixel_by_point << c.fx_px * (scale + x * x * bend), c.fx_px * x * y * bend, c.fx_px * x * scale_by_z,
        c.fy_px * x * y * bend, c.fy_px * (scale + y * y * bend), c.fy_px * y * scale_by_z;
  }
  if (pixel_by_parameters) {
    setPinholeColumns(c, scale * point_C.head<2>(), pixel_by_parameters);
    const Vec2 lateral_px(c.fx_px * x, c.fy_px * y);
    double power = rho > 0.0 ? theta / rho : 1.0 / z;
    for (int k = 4; k < 8; ++k) pixel_by_parameters->col(k) = (power *= theta * theta) * lateral_px;
  }
  return Vec2(c.fx_px * scale * x + c.cx_px, c.fy_px * scale * y + c.cy_px);
}

std::optional<Vec3> EquidistantCamera::unproject(const Vec2& pixel) const {
  const Vec2 distorted = placeOf(calibration(), pixel);
  const double target = distorted.norm();
  if (!(target <= max_distorted_)) return std::nullopt;
  if (target == 0.0) return Vec3::UnitZ();

  constexpr int kMaxIterations = 60;
  double low = 0.0, high = max_angle_rad_;
  double theta = std::min(target, high);
  for (int i = 0; i < kMaxIterations; ++i) {
    double slope = 0.0;
    const double error = distort(theta, &slope) - target;
    (error > 0.0 ? high : low) = theta;
    double next = theta - error / slope;
    if (!(next >= low && next <= high)) next = 0.5 * (low + high);
    const double step = next - theta;
    theta = next;
    if (std::abs(step) < kConvergedStepRad) break;
  }
  const Vec2 direction = distorted / target * std::sin(theta);
  return Vec3(direction.x(), direction.y(), std::cos(theta));
}

}  // namespace

CameraModel equidistantModel() {
  return {
      .name = "equidistant",
      .distortions = {"equidistant", "equi"},
      .aliases = {"kb4", "KANNALA_BRANDT", "KannalaBrandt8", "fisheye"},
      .parameters = {"k1", "k2", "k3", "k4"},
      .counts = {4},
      .make = [](const CameraCalibration& c) -> std::shared_ptr<const Camera> {
        return std::make_shared<EquidistantCamera>(c);
      },
      .radial_model = "equidistant",
      .colmap = {{"OPENCV_FISHEYE", 4}},
      .typical = {0.55, {-0.012, 0.004, -0.003, 0.0005}},
  };
}

}  // namespace lodeline
