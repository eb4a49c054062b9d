#include "lodeline/cameras/fit_camera.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

CameraCalibration moved(const CameraCalibration& from, const Eigen::VectorXd& step) {
  CameraCalibration c = from;
  c.fx_px += step[0];
  c.fy_px += step[1];
  c.cx_px += step[2];
  c.cy_px += step[3];
  for (size_t k = 0; k < c.distortion.size(); ++k) c.distortion[k] += step[4 + static_cast<Eigen::Index>(k)];
  return c;
}

/// Squared sum of the distances and its derivatives; infinite where the camera does not see all rays.
struct Cost {
  double squared_sum = 0.0;
  Eigen::MatrixXd information;
  Eigen::VectorXd gradient;

  Cost(const Camera& camera, const std::vector<RayObservation>& observations) {
    const auto size = 4 + static_cast<Eigen::Index>(camera.calibration().distortion.size());
    information.setZero(size, size);
    gradient.setZero(size);
    PixelByParameters by_parameters;
    for (const RayObservation& observation : observations) {
      const auto pixel = camera.project(observation.ray_C, nullptr, &by_parameters);
      if (!pixel) {
        squared_sum = std::numeric_limits<double>::infinity();
        return;
      }
      const Vec2 error = observation.pixel - *pixel;
      squared_sum += error.squaredNorm();
      information += by_parameters.transpose() * by_parameters;
      gradient += by_parameters.transpose() * error;
    }
  }
};

/// The camera of a calibration; null where the parameters are no camera.
std::shared_ptr<const Camera> cameraOrNull(const CameraCalibration& calibration) {
  try {
    return makeCamera(calibration);
  } catch (const InputError&) {
    return nullptr;
  }
}

}  // namespace

std::vector<RayObservation> imageObservations(const Camera& camera) {
  constexpr int kGrid = 24;
  const CameraCalibration& c = camera.calibration();
  std::vector<RayObservation> observations;
  for (int row = 0; row <= kGrid; ++row) {
    for (int column = 0; column <= kGrid; ++column) {
      const Vec2 pixel(column * (c.width_px - 1.0) / kGrid, row * (c.height_px - 1.0) / kGrid);
      if (const auto ray = camera.unproject(pixel)) observations.push_back({*ray, pixel});
    }
  }
  return observations;
}

CameraFit fitCamera(const CameraCalibration& start, std::vector<RayObservation> observations) {
  constexpr int kSteps = 100;
  constexpr double kLeastDamping = 1e-12, kMostDamping = 1e8, kConverged = 1e-14;
  std::shared_ptr<const Camera> camera = makeCamera(start);
  std::erase_if(observations,
                [&](const RayObservation& observation) { return !camera->project(observation.ray_C); });
  Cost cost(*camera, observations);
  double damping = 1e-6;
  for (int i = 0; i < kSteps && damping < kMostDamping; ++i) {
    Eigen::MatrixXd damped = cost.information;
    damped.diagonal() *= 1.0 + damping;
    damped.diagonal().array() += std::numeric_limits<double>::min();
    const Eigen::VectorXd step = damped.ldlt().solve(cost.gradient);
    const auto next = step.allFinite() ? cameraOrNull(moved(camera->calibration(), step)) : nullptr;
    if (next) {
      Cost after(*next, observations);
      if (after.squared_sum < cost.squared_sum) {
        const bool is_converged = cost.squared_sum - after.squared_sum < kConverged * cost.squared_sum;
        camera = next;
        cost = std::move(after);
        damping = std::max(kLeastDamping, 0.1 * damping);
        if (is_converged) break;
        continue;
      }
    }
    damping *= 10.0;
  }
  const double count = static_cast<double>(std::max<size_t>(observations.size(), 1));
  return {camera->calibration(), std::sqrt(cost.squared_sum / count)};
}

CameraFit convertedCamera(const CameraCalibration& calibration, const CameraModel& to) {
  const auto camera = makeCamera(calibration);
  const Vec2 focal_lengths_px = camera->focalLengthsOnAxis_px();
  CameraCalibration start = calibration;
  start.port.reset();
  start.model = to.name;
  start.distortion = to.typical.parameters;
  start.distortion.resize(to.counts.front(), 0.0);
  const Vec2 scale = focal_lengths_px.cwiseQuotient(makeCamera(start)->focalLengthsOnAxis_px());
  start.fx_px *= scale.x();
  start.fy_px *= scale.y();
  return fitCamera(start, imageObservations(*camera));
}

}  // namespace lodeline
