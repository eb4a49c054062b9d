#pragma once

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "lodeline/batch/refine.h"
#include "lodeline/cameras/port_camera.h"
#include "lodeline/estimator/trials/scene.h"
#include "simulation/dive/point_dive.h"

namespace lodeline {

/// Test support: a dive of points behind ports that the rig file misstates.
struct PortDiveOptions {
  uint64_t seed = 1;
  int cameras = 2;
  Port::Type type = Port::Type::Flat;
  double seconds = 60.0, metres = 18.0, rate_hz = 6.0;
  int tracks = 60;
  double normal_error_rad = 0.5 * std::numbers::pi / 180.0;  ///< in a random direction
  double length_error_m = 0.003;  ///< of the distance, or of the centre in a random direction
  double focal_error = 0.0, centre_error_px = 0.0;  ///< sigmas of the errors of the lens
};

/// The record of a run on such a dive.
struct PortDive {
  Rig given;
  std::vector<Vec3> true_changes;  ///< of the ports, as in PortCorrection
  EstimatorOptions options;
  EstimatorLog record;
  std::vector<Rigid3> truth;  ///< poses of the frames in the world of the run
  double run_s = 0.0;

  PortDive(const PortDiveOptions& dive, const EstimatorOptions& estimator_options)
      : options(estimator_options) {
    DiveMotionOptions motion;
    motion.seed = dive.seed;
    motion.duration_s = dive.seconds;
    motion.path_length_m = dive.metres;
    StandardRigOptions standard;
    standard.cameras = dive.cameras;
    PointSimulationOptions simulated;
    simulated.seed = dive.seed;
    simulated.frame_rate_hz = dive.rate_hz;
    simulated.tracks = dive.tracks;
    simulated.imu = drawImuErrors(imuGrade("gx5-25"), {}, dive.seed);
    const PointDive points = makePointDive(motion, standardRig(standard), simulated.imu);
    Rig seen_through = points.mounted.rig;
    given = seen_through;
    for (size_t i = 0; i < given.cameras.size(); ++i)
      addPort(dive, i, &seen_through.cameras[i], &given.cameras[i]);
    PointSimulation simulation(points.motion, points.landmarks, seen_through, given, simulated);
    Diagnostics diagnostics;
    Estimator estimator(given, options, &diagnostics);
    TruthComparison comparison;
    while (auto frame = simulation.next()) {
      const FrameEstimate estimate = estimator.add(frame->tracks, frame->imu);
      record.add(frame->tracks, frame->imu, estimate, estimator);
      const Comparison compared = comparison.compare(*frame, estimate, estimator);
      if (compared.initialized()) truth.push_back(compared.true_world_from_body);
    }
    record.finish(estimator);
  }

  /// Root mean square of the position errors (m) or of the headings' (rad).
  double rms(const std::vector<FrameEstimate>& frames, bool of_heading = false) const {
    double sum = 0.0;
    for (size_t i = 0; i < frames.size(); ++i) {
      const Eigen::Matrix<double, 6, 1> error =
          perturbationBetween(truth[i], frames[i].state.world_from_body);
      sum += of_heading ? error[5] * error[5] : error.head<3>().squaredNorm();
    }
    return std::sqrt(sum / static_cast<double>(frames.size()));
  }

 private:
  void addPort(const PortDiveOptions& dive, size_t camera, CameraCalibration* in_water,
               CameraCalibration* file) {
    Random random(dive.seed, "port dive/" + std::to_string(camera));
    Port port;
    port.type = dive.type;
    port.distance_m = 0.02;
    port.thickness_m = 0.008;
    port.centre_C = Vec3(0.001, -0.001, 0.004);
    port.radius_m = 0.05;
    Vec3 change = dive.length_error_m * random.normal3().normalized();
    if (dive.type == Port::Type::Flat) {
      const double around = random.uniform(0.0, 2.0 * std::numbers::pi);
      change = Vec3(dive.normal_error_rad * std::cos(around), dive.normal_error_rad * std::sin(around),
                    random.uniform(0.0, 1.0) < 0.5 ? -dive.length_error_m : dive.length_error_m);
      // The view is that of the rig without a port.
      in_water->fx_px /= port.index_water;
      in_water->fy_px /= port.index_water;
    }
    *file = *in_water;
    file->port = port;
    in_water->port = correctedPort(port, change);
    const double focal = 1.0 + dive.focal_error * random.normal();
    file->fx_px *= focal;
    file->fy_px *= focal;
    file->cx_px += dive.centre_error_px * random.normal();
    file->cy_px += dive.centre_error_px * random.normal();
    true_changes.push_back(change);
  }
};

}  // namespace lodeline
