#include "lodeline/problem/state/camera_states.h"

#include <algorithm>

#include "lodeline/diagnostics.h"
#include "lodeline/factors/calibrated_reprojection_factor.h"
#include "lodeline/factors/intrinsics_factor.h"

namespace lodeline {
namespace {

constexpr const char* kTimeOffset = "camera.dt";
constexpr const char* kShutter = "camera.shutter";

// Small enough to hold a state, large enough for a well conditioned prior.
constexpr double kHeld = 1e-7;

// Names short enough to need no heap memory: they are looked up for every landmark.
std::string extrinsicsName(size_t camera) { return "cam" + std::to_string(camera) + ".T_BC"; }

std::string intrinsicsName(size_t camera) { return "cam" + std::to_string(camera) + ".lens"; }

std::string portName(size_t camera) { return "cam" + std::to_string(camera) + ".port"; }

void addState(Window& window, Prior& prior, const std::string& name, const Eigen::VectorXd& sigmas,
              const Vec3& start = Vec3::Zero()) {
  ParameterBlock state;
  state.name = name;
  state.value.assign(static_cast<size_t>(sigmas.size()), 0.0);
  if (!start.isZero()) std::copy_n(start.data(), 3, state.value.begin());
  ParameterBlock& added = window.add(std::move(state));
  prior.append(added.value.data(), static_cast<int>(sigmas.size()), sigmas.cwiseMax(kHeld));
}

Eigen::VectorXd extrinsicsSigmas(double rotation_rad, double position_m) {
  Eigen::VectorXd sigmas(kExtrinsicsSize);
  sigmas << Vec3::Constant(rotation_rad), Vec3::Constant(position_m);
  return sigmas;
}

/// Prior sigmas of a secondary camera. The position is only limited to the size of the rig;
/// FactorBuilder::placement() contains the rest.
Eigen::VectorXd stereoSigmas(const CameraCalibrationOptions& options) {
  constexpr double kSomewhere_m = 0.05;
  return extrinsicsSigmas(options.stereo_rotation_sigma_rad,
                          options.stereo_position_sigma_m > 0.0 ? kSomewhere_m : 0.0);
}

}  // namespace

Eigen::VectorXd stereoRotationSigmas(const CameraCalibrationOptions& options) {
  return Vec3::Constant(std::max(options.stereo_rotation_sigma_rad, kHeld));
}

double placementLossWidth(const ParameterBlock& secondary) { return secondary.priors.empty() ? 1.0 : 0.5; }

Eigen::VectorXd intrinsicsSigmas(const CameraCalibrationOptions& options) {
  Eigen::VectorXd sigmas(kIntrinsicsSize);
  sigmas << Vec2::Constant(options.focal_length_sigma), Vec2::Constant(options.principal_point_sigma_px),
      Vec2::Constant(options.radial_sigma), Vec2::Constant(options.tangential_sigma),
      Vec2::Constant(options.port_tilt_sigma);
  return sigmas.cwiseMax(kHeld);
}

void addCameraStates(Window& window, Prior& prior, int cameras, const CameraCalibrationOptions& options,
                     const std::vector<Vec3>& rotations) {
  if (!options.enabled) return;
  addState(window, prior, extrinsicsName(0),
           extrinsicsSigmas(options.rotation_sigma_rad, options.position_sigma_m));
  addState(window, prior, kTimeOffset, Eigen::VectorXd::Constant(1, options.time_offset_sigma_s));
  for (size_t camera = 1; camera < static_cast<size_t>(cameras); ++camera) {
    addState(window, prior, extrinsicsName(camera), stereoSigmas(options),
             camera <= rotations.size() ? rotations[camera - 1] : Vec3::Zero());
    window.findGlobal(extrinsicsName(camera))->is_correlation_wanted = true;  // reportedCovariance()
  }
}

void addShutterState(Window& window, Prior& prior, const Rig& rig, const CameraCalibrationOptions& options) {
  const auto rolls = [](const CameraCalibration& camera) { return camera.hasRollingShutter(); };
  if (!options.enabled || std::none_of(rig.cameras.begin(), rig.cameras.end(), rolls)) return;
  if (rig.cameras.size() > kShutterSize) {
    throw UsageError("a rolling shutter is estimated for six cameras at most; remove a camera from the rig");
  }
  // A line delay is some 1e-5 s, so the usual sigma of a held state would not hold it.
  constexpr double kHeld_s = 1e-10;
  Eigen::VectorXd sigmas = Eigen::VectorXd::Constant(kShutterSize, kHeld_s);
  ParameterBlock state;
  state.name = kShutter;
  state.value.assign(kShutterSize, 0.0);
  for (size_t i = 0; i < rig.cameras.size(); ++i) {
    state.value[i] = rig.cameras[i].line_delay_s;
    sigmas[static_cast<Eigen::Index>(i)] = std::max(kHeld_s, rig.cameras[i].line_delay_sigma_s);
  }
  prior.append(window.add(std::move(state)).value.data(), kShutterSize, sigmas);
}

void addIntrinsicsStates(Window& window, Prior& prior, int cameras, const CameraCalibrationOptions& options) {
  if (!options.enabled || !options.intrinsics) return;
  for (int camera = 0; camera < cameras; ++camera)
    addState(window, prior, intrinsicsName(static_cast<size_t>(camera)), intrinsicsSigmas(options));
}

void addPortStates(Window& window, Prior& prior, const Rig& rig, const CameraCalibrationOptions& options) {
  if (!options.enabled || !options.intrinsics) return;
  for (size_t camera = 0; camera < rig.cameras.size(); ++camera) {
    const std::optional<Port>& port = rig.cameras[camera].port;
    if (!port) continue;
    Eigen::VectorXd sigmas = Vec3::Constant(options.port_distance_sigma_m);
    if (port->type == Port::Type::Flat) sigmas.head<2>().setConstant(options.port_normal_sigma_rad);
    if (!sigmas.isZero(0.0)) addState(window, prior, portName(camera), sigmas);
  }
}

CameraStates cameraStates(const Window& window) {
  CameraStates states;
  states.camera0 = window.findGlobal(extrinsicsName(0));
  if (!states.camera0) return states;
  states.time_offset = window.findGlobal(kTimeOffset);
  states.shutter = window.findGlobal(kShutter);
  while (ParameterBlock* secondary = window.findGlobal(extrinsicsName(states.secondary.size() + 1)))
    states.secondary.push_back(secondary);
  while (ParameterBlock* lens = window.findGlobal(intrinsicsName(states.intrinsics.size())))
    states.intrinsics.push_back(lens);
  for (size_t camera = 0; camera < states.intrinsics.size(); ++camera)
    states.ports.push_back(window.findGlobal(portName(camera)));
  if (std::all_of(states.ports.begin(), states.ports.end(), [](const auto* port) { return !port; }))
    states.ports.clear();
  return states;
}

Vec3 rayOf(const Observation& observation, const CameraStates& states) {
  if (states.intrinsics.empty()) return observation.measurement.bearing_C;
  const ParameterBlock* lens = states.intrinsics[static_cast<size_t>(observation.camera)];
  return rayThrough(observation.measurement, lens->value.data());
}

DirectionMeasurement atTimeOfImage(const Observation& observation, const CameraMotion& motion,
                                   const CameraStates& states) {
  if (!states.shutter) return observation.measurement;
  return atTimeOfImage(observation.measurement, motion,
                       states.shutter->value[static_cast<size_t>(observation.camera)]);
}

std::optional<CameraCorrections> cameraCorrections(const Window& window) {
  using Correction = Eigen::Matrix<double, kExtrinsicsSize, 1>;
  const CameraStates states = cameraStates(window);
  if (!states) return std::nullopt;
  CameraCorrections corrections;
  corrections.extrinsics.emplace_back(Eigen::Map<const Correction>(states.camera0->value.data()));
  for (const ParameterBlock* secondary : states.secondary)
    corrections.extrinsics.emplace_back(Eigen::Map<const Correction>(secondary->value.data()));
  corrections.time_offset_s = states.timeOffset_s();
  if (states.shutter) {
    const auto first = states.shutter->value.begin();
    corrections.line_delays_s.assign(first, first + static_cast<long>(corrections.extrinsics.size()));
  }
  for (const ParameterBlock* lens : states.intrinsics)
    corrections.intrinsics.emplace_back(Eigen::Map<const IntrinsicsCorrection>(lens->value.data()));
  for (const ParameterBlock* port : states.ports)
    corrections.ports.push_back({port ? Vec3(port->value.data()) : Vec3::Zero()});
  corrections.are_files_held = !states.intrinsics.empty() && !states.intrinsics.front()->priors.empty();
  return corrections;
}

}  // namespace lodeline
