#include "simulation/rendering/optics/port_fit.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <vector>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

constexpr int kParameters = 9;  // fx fy cx cy k1 k2 p1 p2 shift
using Parameters = Eigen::Matrix<double, kParameters, 1>;

struct Sight {
  Vec2 pixel;
  Vec3 point_C;
};

/// OpenCV's radial-tangential projection (Brown 1966) of a point, with the centre shifted by `shift` along z.
Vec2 projectBy(const Parameters& p, const Vec3& point_C) {
  const double z = point_C.z() - p[8];
  const double x = point_C.x() / z, y = point_C.y() / z;
  const double r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (p[4] + r2 * p[5]);
  const double xd = x * radial + 2.0 * p[6] * x * y + p[7] * (r2 + 2.0 * x * x);
  const double yd = y * radial + p[6] * (r2 + 2.0 * y * y) + 2.0 * p[7] * x * y;
  return {p[0] * xd + p[2], p[1] * yd + p[3]};
}

std::vector<Sight> sightsThroughPort(const CameraCalibration& in_air, const PortWindow& port, double near_m,
                                     double far_m) {
  const auto camera = makeCamera(in_air);
  std::vector<Sight> sights;
  constexpr int kGrid = 16;
  for (int row = 0; row <= kGrid; ++row) {
    for (int column = 0; column <= kGrid; ++column) {
      const Vec2 pixel(column * (in_air.width_px - 1.0) / kGrid, row * (in_air.height_px - 1.0) / kGrid);
      const auto air_ray = camera->unproject(pixel);
      if (!air_ray) continue;
      const auto ray = throughPort(port, *air_ray);
      if (!ray) continue;
      for (const double depth : {near_m, std::sqrt(near_m * far_m), far_m}) {
        sights.push_back({pixel, ray->origin_C + depth / ray->direction_C.z() * ray->direction_C});
      }
    }
  }
  return sights;
}

}  // namespace

PortFit fitRadialTangential(const CameraCalibration& in_air, const PortWindow& port, double near_m,
                            double far_m) {
  const std::vector<Sight> sights = sightsThroughPort(in_air, port, near_m, far_m);
  if (sights.size() < 100) {
    throw UsageError("port: hardly any ray of camera '" + in_air.name +
                     "' passes it; check the port's pose and the focal length");
  }
  Parameters p;
  const double enlargement = enlargementBy(port);
  p << in_air.fx_px * enlargement, in_air.fy_px * enlargement, in_air.cx_px, in_air.cy_px, 0, 0, 0, 0, 0;
  double squared_sum = 0.0;
  for (int iteration = 0; iteration < 20; ++iteration) {
    Eigen::Matrix<double, kParameters, kParameters> normal_matrix;
    normal_matrix.setZero();
    Parameters gradient = Parameters::Zero();
    squared_sum = 0.0;
    for (const Sight& sight : sights) {
      const Vec2 residual = sight.pixel - projectBy(p, sight.point_C);
      Eigen::Matrix<double, 2, kParameters> jacobian;
      for (int k = 0; k < kParameters; ++k) {
        const double step = k < 4 ? 1e-3 : 1e-6;
        Parameters forward = p, backward = p;
        forward[k] += step;
        backward[k] -= step;
        jacobian.col(k) =
            (projectBy(forward, sight.point_C) - projectBy(backward, sight.point_C)) / (2.0 * step);
      }
      normal_matrix += jacobian.transpose() * jacobian;
      gradient += jacobian.transpose() * residual;
      squared_sum += residual.squaredNorm();
    }
    const Parameters update = normal_matrix.ldlt().solve(gradient);
    p += update;
    if (update.head<4>().norm() < 1e-9) break;
  }
  PortFit fit;
  fit.calibration = in_air;
  fit.calibration.fx_px = p[0];
  fit.calibration.fy_px = p[1];
  fit.calibration.cx_px = p[2];
  fit.calibration.cy_px = p[3];
  fit.calibration.model = "radial-tangential";
  fit.calibration.distortion = {p[4], p[5], p[6], p[7]};
  fit.calibration.body_from_camera = in_air.body_from_camera * Rigid3(Quat::Identity(), Vec3(0.0, 0.0, p[8]));
  fit.rms_px = std::sqrt(squared_sum / static_cast<double>(sights.size()));
  return fit;
}

}  // namespace lodeline
