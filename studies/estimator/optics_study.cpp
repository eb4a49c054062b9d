// Measures the drift of heading, scale and position of a long dive of points behind physical ports, with the
// magnetometer off. Prints the table of docs/lab-notes/optics.md.

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <functional>

#include "lodeline/estimator/estimator.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/util/angles.h"
#include "lodeline/util/thread_clock.h"
#include "simulation/dive/point_dive.h"
#include "simulation/rendering/optics/port_fit.h"

namespace {

using namespace lodeline;

struct Study {
  uint64_t seed = 1;
  int cameras = 2;
  double seconds = 746.0, metres = 226.0, rate_hz = 6.0, tilt_deg = 0.8, distance_m = 0.015,
         thickness_m = 0.008, pixel_sigma_px = 0.5;
  int tracks = 60;
  std::string imu = "gx5-25";
};

/// Errors of the rig's files relative to the cameras that see the points.
struct Case {
  const char* name;
  std::function<void(const Study&, Rig& truth, Rig& given)> apply;
};

Vec3 tilted(const Study& study, size_t camera) {
  Random random(study.seed, "optics study/tilt/" + std::to_string(camera));
  const double angle = random.uniform(0.0, 2.0 * std::numbers::pi);
  return so3::exp(study.tilt_deg * kDegree * Vec3(std::cos(angle), std::sin(angle), 0.0)) * Vec3::UnitZ();
}

/// Puts every camera behind a tilted plate. The files state the best radial-tangential fit, or the plate
/// itself.
void addPorts(const Study& study, bool in_files, Rig& truth, Rig& given) {
  for (size_t i = 0; i < truth.cameras.size(); ++i) {
    FlatPort port;
    port.normal_C = tilted(study, i);
    port.distance_m = study.distance_m;
    port.thickness_m = study.thickness_m;
    CameraCalibration& camera = truth.cameras[i];
    camera = airCameraFor(camera, port);
    const PortFit fit = fitRadialTangential(camera, port);
    camera.port = Port{};
    camera.port->normal_C = port.normal_C;
    camera.port->distance_m = port.distance_m;
    camera.port->thickness_m = port.thickness_m;
    camera.port->index_glass = port.index_glass;
    camera.port->index_water = port.index_water;
    given.cameras[i] = in_files ? camera : fit.calibration;
  }
}

void misstate(const Study& study, Rig& given) {
  Random random(study.seed, "optics study/files");
  const double focal = 0.003 * random.normal(), shift_x = 1.5 * random.normal(),
               shift_y = 1.5 * random.normal();
  for (CameraCalibration& camera : given.cameras) {
    camera.fx_px *= 1.0 + focal;
    camera.fy_px *= 1.0 + focal;
    camera.cx_px += shift_x;
    camera.cy_px += shift_y;
  }
}

void changeTangential(Rig& given, double first, double second) {
  for (CameraCalibration& camera : given.cameras) {
    camera.distortion.resize(4, 0.0);
    camera.distortion[2] += first;
    camera.distortion[3] += second;
  }
}

const std::array kCases = {
    Case{"exact", [](const Study&, Rig&, Rig&) {}},
    Case{"files off", [](const Study& s, Rig&, Rig& given) { misstate(s, given); }},
    Case{"tangential +0.0005 vertical",
         [](const Study&, Rig&, Rig& given) { changeTangential(given, 5e-4, 0.0); }},
    Case{"tangential +0.0005 sideways",
         [](const Study&, Rig&, Rig& given) { changeTangential(given, 0.0, 5e-4); }},
    Case{"port, fitted", [](const Study& s, Rig& truth, Rig& given) { addPorts(s, false, truth, given); }},
    Case{"port, fitted, files off",
         [](const Study& s, Rig& truth, Rig& given) {
           addPorts(s, false, truth, given);
           misstate(s, given);
         }},
    Case{"port, no tangential in files",
         [](const Study& s, Rig& truth, Rig& given) {
           addPorts(s, false, truth, given);
           for (CameraCalibration& camera : given.cameras) camera.distortion[2] = camera.distortion[3] = 0.0;
         }},
    Case{"port in files", [](const Study& s, Rig& truth, Rig& given) { addPorts(s, true, truth, given); }},
    Case{"port in files, off",
         [](const Study& s, Rig& truth, Rig& given) {
           addPorts(s, true, truth, given);
           misstate(s, given);
         }},
};

struct Outcome {
  double heading_rad = 0.0, heading_sigma_rad = 0.0, scale = 0.0, end_m = 0.0, end_sigma_m = 0.0, ms = 0.0;
  std::string held;
};

Outcome dive(const Study& study, const Case& which, const EstimatorOptions& options) {
  DiveMotionOptions motion;
  motion.seed = study.seed;
  motion.duration_s = study.seconds;
  motion.path_length_m = study.metres;
  StandardRigOptions standard;
  standard.cameras = study.cameras;
  const ImuErrors imu = drawImuErrors(imuGrade(study.imu), {}, study.seed);
  PointDive points = makePointDive(motion, standardRig(standard), imu);
  Rig truth = points.mounted.rig, given = truth;
  which.apply(study, truth, given);
  PointSimulationOptions simulated;
  simulated.seed = study.seed;
  simulated.frame_rate_hz = study.rate_hz;
  simulated.tracks = study.tracks;
  simulated.pixel_sigma_px = study.pixel_sigma_px;
  simulated.imu = imu;
  PointSimulation simulation(points.motion, points.landmarks, truth, given, simulated);
  Diagnostics diagnostics;
  Estimator estimator(given, options, &diagnostics);
  Outcome outcome;
  std::optional<Rigid3> true_from_estimate;
  Rigid3 last_true, last_estimate;
  double estimator_s = 0.0, true_path = 0.0, path = 0.0;
  int frames = 0;
  std::optional<Rigid3> before_true, before;
  while (auto frame = simulation.next()) {
    const double begin_s = threadSeconds();
    const FrameEstimate estimate = estimator.add(frame->tracks, frame->imu, SensorReadings());
    estimator_s += threadSeconds() - begin_s;
    ++frames;
    if (estimate.status == Status::Waiting) continue;
    last_true = frame->truth.motion.world_from_body;
    last_estimate = estimate.state.world_from_body;
    if (!true_from_estimate) {
      const double turn = so3::log(last_true.rotation * last_estimate.rotation.conjugate()).z();
      const Quat rotation = so3::exp(Vec3(0.0, 0.0, turn));
      true_from_estimate = Rigid3(rotation, last_true.translation - rotation * last_estimate.translation);
    }
    constexpr double kStep_m = 2.0;
    if (!before_true || (last_true.translation - before_true->translation).norm() > kStep_m) {
      if (before_true) {
        true_path += (last_true.translation - before_true->translation).norm();
        path += (last_estimate.translation - before->translation).norm();
      }
      before_true = last_true;
      before = last_estimate;
    }
    outcome.heading_sigma_rad = std::sqrt(estimate.covariance(5, 5));
    outcome.end_sigma_m = std::sqrt(estimate.covariance.topLeftCorner<3, 3>().trace());
  }
  const Rigid3 aligned = *true_from_estimate * last_estimate;
  outcome.heading_rad = so3::log(aligned.rotation * last_true.rotation.conjugate()).z();
  outcome.end_m = (aligned.translation - last_true.translation).norm();
  outcome.scale = path / true_path - 1.0;
  outcome.ms = 1e3 * estimator_s / frames;
  return outcome;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Drift of heading, scale and end point over dives of points behind physical ports.");
  Study study;
  int seeds = 3;
  uint64_t first_seed = 1;
  std::vector<std::string> only;
  EstimatorOptions options;
  bool each = false;
  app.add_option("--seeds", seeds)->capture_default_str();
  app.add_option("--first-seed", first_seed)->capture_default_str();
  app.add_option("--cameras", study.cameras)->capture_default_str()->check(CLI::Range(1, 2));
  app.add_option("--seconds", study.seconds)->capture_default_str();
  app.add_option("--metres", study.metres)->capture_default_str();
  app.add_option("--rate", study.rate_hz, "frames a second")->capture_default_str();
  app.add_option("--tilt", study.tilt_deg, "of the ports, degrees")->capture_default_str();
  app.add_option("--distance", study.distance_m, "of the ports from the lenses, m")->capture_default_str();
  app.add_option("--thickness", study.thickness_m, "of the ports, m")->capture_default_str();
  app.add_option("--tracks", study.tracks)->capture_default_str();
  app.add_option("--pixel-sigma", study.pixel_sigma_px)->capture_default_str();
  app.add_option("--imu", study.imu)->capture_default_str();
  app.add_option("--only", only, "cases whose name begins like this");
  app.add_option("--tangential-sigma", options.camera_calibration.tangential_sigma)->capture_default_str();
  app.add_option("--port-tilt-sigma", options.camera_calibration.port_tilt_sigma)->capture_default_str();
  app.add_option("--trust-files", options.camera_calibration.trust_confirmed_files)->capture_default_str();
  app.add_flag("--each", each, "list every seed too");
  CLI11_PARSE(app, argc, argv);
  fmt::print("{:30} {:>12} {:>12} {:>10} {:>10} {:>10} {:>8}\n", "case", "heading deg", "claimed deg",
             "scale %", "end m", "claimed m", "ms");
  for (const Case& which : kCases) {
    const auto named = [&](const std::string& begin) { return std::string(which.name) == begin; };
    if (!only.empty() && std::none_of(only.begin(), only.end(), named)) continue;
    Outcome sum;
    for (int i = 0; i < seeds; ++i) {
      study.seed = first_seed + static_cast<uint64_t>(i);
      const Outcome one = dive(study, which, options);
      if (each)
        fmt::print("  seed {:3} {:>33.3f} {:>12.3f} {:>10.3f} {:>10.3f} {:>10.3f}\n", study.seed,
                   one.heading_rad * kDegreesPerRadian, one.heading_sigma_rad * kDegreesPerRadian,
                   100.0 * one.scale, one.end_m, one.end_sigma_m);
      sum.heading_rad += std::pow(one.heading_rad, 2);
      sum.heading_sigma_rad += std::pow(one.heading_sigma_rad, 2);
      sum.scale += std::pow(one.scale, 2);
      sum.end_m += std::pow(one.end_m, 2);
      sum.end_sigma_m += std::pow(one.end_sigma_m, 2);
      sum.ms += one.ms;
    }
    const auto rms = [&](double squares) { return std::sqrt(squares / seeds); };
    fmt::print("{:30} {:>12.3f} {:>12.3f} {:>10.3f} {:>10.3f} {:>10.3f} {:>8.2f}\n", which.name,
               rms(sum.heading_rad) * kDegreesPerRadian, rms(sum.heading_sigma_rad) * kDegreesPerRadian,
               100.0 * rms(sum.scale), rms(sum.end_m), rms(sum.end_sigma_m), sum.ms / seeds);
    std::fflush(stdout);
  }
  return 0;
}
