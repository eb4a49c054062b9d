#include "lodeline/problem/factor_builder.h"

#include <ceres/normal_prior.h>

#include "lodeline/factors/calibrated_reprojection_factor.h"
#include "lodeline/factors/inertial_factor.h"
#include "lodeline/factors/intrinsics_factor.h"
#include "lodeline/factors/ports/port_factor.h"
#include "lodeline/problem/state/inertial_states.h"

namespace lodeline {

namespace {

std::shared_ptr<const ceres::LossFunction> lossOf(const FeatureTrack& track, double scale_sigmas) {
  return std::make_shared<ceres::ScaledLoss>(new ceres::CauchyLoss(scale_sigmas), track.weight,
                                             ceres::TAKE_OWNERSHIP);
}

/// Replaces the target pose of a reprojection factor by one interpolated between two keyframes.
void hangOnNeighbours(const Window& window, const Frame& target, Factor* factor) {
  constexpr size_t kTarget = 1;  // index of the target pose in such factors
  const auto& [before_id, after_id, between] = *target.interpolated;
  Frame &before = *window.find(before_id), &after = *window.find(after_id);
  factor->function = std::make_unique<InterpolatedPoseFactor>(std::move(factor->function), kTarget, between,
                                                              before.firstPose(), after.firstPose());
  factor->blocks[kTarget] = before.pose.data();
  factor->blocks.push_back(after.pose.data());
}

/// Linearization points of the blocks of FactorBuilder::calibratedFactor(), in their order.
std::vector<const double*> linearizationPoints(const Window& window, const Landmark& landmark,
                                               const Observation& observation, const CameraStates& states) {
  std::vector<const double*> first;
  const double* of_secondary = nullptr;
  if (observation.camera > 0) of_secondary = states.secondary[observation.camera - 1]->linearizationPoint();
  if (observation.frame == landmark.host) {
    first = {nullptr};
    if (observation.camera > 0) first.push_back(of_secondary);
  } else {
    const Frame& target = *window.find(observation.frame);
    const Frame& before = target.interpolated ? *window.find(target.interpolated->before) : target;
    first = {window.find(landmark.host)->firstPose(), before.firstPose(), nullptr,
             states.camera0->linearizationPoint(), states.time_offset->linearizationPoint()};
    if (observation.camera > 0) first.push_back(of_secondary);
    if (target.interpolated) first.push_back(window.find(target.interpolated->after)->firstPose());
  }
  // Ports and intrinsics are linearized at their present values.
  if (states.portOf(observation.camera)) first.push_back(nullptr);
  if (!states.intrinsics.empty()) first.push_back(nullptr);
  return first;
}

/// Prior of a zero state with the same sigma for each of its entries.
Factor zeroPrior(ParameterBlock& state, double sigma) {
  const auto size = static_cast<Eigen::Index>(state.value.size());
  Factor factor;
  factor.function = std::make_unique<ceres::NormalPrior>(ceres::Matrix::Identity(size, size) / sigma,
                                                         ceres::Vector::Zero(size));
  factor.blocks = {state.value.data()};
  return factor;
}

/// Wraps a reprojection factor for the estimated intrinsics of its camera, where there are any.
void addIntrinsics(const DirectionMeasurement& measurement, int camera, const CameraStates& states,
                   Factor* factor) {
  if (states.intrinsics.empty()) return;
  factor->function = std::make_unique<IntrinsicsFactor>(std::move(factor->function), measurement);
  factor->blocks.push_back(states.intrinsics[static_cast<size_t>(camera)]->value.data());
}

}  // namespace

FactorBuilder::FactorBuilder(const Rig& rig, const EstimatorOptions& options)
    : gravity_W_(options.gravity_W),
      imu_axes_(options.imu_axes),
      placement_sigma_m_(options.camera_calibration.stereo_position_sigma_m),
      robust_scale_(options.solver.robust_scale_sigmas) {
  for (const CameraCalibration& camera : rig.cameras) {
    body_from_camera_.push_back(camera.body_from_camera);
    camera0_from_camera_.push_back(body_from_camera_.front().inverse() * camera.body_from_camera);
    behind_port_.push_back(camera.port ? std::dynamic_pointer_cast<const RefractiveCamera>(makeCamera(camera))
                                       : nullptr);
    centre_rows_.push_back(camera.hasRollingShutter() ? centreRow(camera) : 0.0);
  }
}

Factor FactorBuilder::inertial(const Window& window, Frame& before, Frame& frame) const {
  Factor factor;
  const ImuAxesStates axes(window);
  const InertialLinearizationPoints linearization_points{
      before.firstPose(),
      before.firstMotion(),
      frame.firstPose(),
      frame.firstMotion(),
      axes.gyroscope ? axes.gyroscope->linearizationPoint() : nullptr,
      axes.accelerometer ? axes.accelerometer->linearizationPoint() : nullptr};
  factor.function = std::make_unique<InertialFactor>(
      frame.from_previous.get(), gravity_W_, linearization_points,
      EstimatedAxes{axes.gyroscope != nullptr, axes.accelerometer != nullptr});
  factor.blocks = {before.pose.data(), before.motion.data(), frame.pose.data(), frame.motion.data()};
  if (axes.gyroscope) factor.blocks.push_back(axes.gyroscope->value.data());
  if (axes.accelerometer) factor.blocks.push_back(axes.accelerometer->value.data());
  return factor;
}

std::vector<Factor> FactorBuilder::imuAxes(const Window& window) const {
  constexpr double kUsualNorm = 3.0;  // norm of nine coordinates, in sigmas
  std::vector<Factor> priors;
  const auto add = [&](ParameterBlock* axes, double sigma) {
    if (!axes) return;
    priors.push_back(zeroPrior(*axes, sigma));
    priors.back().loss = std::make_shared<ceres::CauchyLoss>(kUsualNorm);
    priors.push_back(zeroPrior(*axes, imu_axes_.worst_sigma));
  };
  const ImuAxesStates axes(window);
  add(axes.gyroscope, imu_axes_.gyroscope_sigma);
  add(axes.accelerometer, imu_axes_.accelerometer_sigma);
  return priors;
}

std::optional<Factor> FactorBuilder::priorOf(ParameterBlock& state) const {
  if (state.priors.empty()) return std::nullopt;
  const auto size = static_cast<Eigen::Index>(state.priors.size());
  ceres::Vector value(size), information_root(size);
  for (Eigen::Index i = 0; i < size; ++i) {
    const ScalarPrior& prior = state.priors[static_cast<size_t>(i)];
    value[i] = prior.value;
    information_root[i] = 1.0 / prior.sigma;
  }
  Factor factor;
  factor.function = std::make_unique<ceres::NormalPrior>(ceres::Matrix(information_root.asDiagonal()), value);
  factor.blocks = {state.value.data()};
  return factor;
}

std::optional<Factor> FactorBuilder::placement(ParameterBlock& secondary) const {
  if (placement_sigma_m_ <= 0.0) return std::nullopt;
  ceres::Matrix whitening = ceres::Matrix::Zero(3, kExtrinsicsSize);
  whitening.rightCols<3>().diagonal().setConstant(1.0 / placement_sigma_m_);
  Factor factor;
  factor.function = std::make_unique<ceres::NormalPrior>(whitening, ceres::Vector::Zero(kExtrinsicsSize));
  factor.loss = std::make_shared<ceres::CauchyLoss>(placementLossWidth(secondary));
  factor.blocks = {secondary.value.data()};
  return factor;
}

std::optional<Factor> FactorBuilder::rest(Frame& frame) const {
  if (!frame.rest_sigma_m_per_s) return std::nullopt;
  const ceres::Matrix whitening = ceres::Matrix::Identity(3, kMotionSize) / *frame.rest_sigma_m_per_s;
  Factor factor;
  factor.function = std::make_unique<ceres::NormalPrior>(whitening, ceres::Vector::Zero(kMotionSize));
  factor.blocks = {frame.motion.data()};
  return factor;
}

Factor FactorBuilder::prior(const Prior& prior) const {
  Factor factor;
  factor.function = std::make_unique<PriorFactor>(prior);
  for (const Prior::Block& block : prior.blocks) factor.blocks.push_back(block.value);
  return factor;
}

DirectionMeasurement FactorBuilder::presentMeasurement(const Window& window, const Observation& observation,
                                                       const CameraStates& states) const {
  const DirectionMeasurement at_image =
      atTimeOfImage(observation, motionOf(*window.find(observation.frame), observation.camera), states);
  const ParameterBlock* port = states.portOf(observation.camera);
  if (!port) return at_image;
  return throughPort(*behind_port_[static_cast<size_t>(observation.camera)], at_image,
                     Vec3(port->value.data()));
}

Rigid3 FactorBuilder::worldFromCamera(const Window& window, const Frame& frame, int camera) const {
  const CameraStates states = cameraStates(window);
  if (!states) return frame.worldFromBody() * body_from_camera_[camera];
  const Rigid3 world_from_camera0 =
      frame.image_motion.poseAfter(frame.worldFromBody(), states.timeOffset_s()) *
      correctedExtrinsics(body_from_camera_[0], states.camera0->value.data());
  if (camera == 0) return world_from_camera0;
  return world_from_camera0 *
         correctedExtrinsics(camera0_from_camera_[camera], states.secondary[camera - 1]->value.data());
}

LandmarkFactors FactorBuilder::landmark(Window& window, FeatureTrack& track) const {
  const CameraStates states = cameraStates(window);
  return states ? calibratedLandmark(window, track, states) : plainLandmark(window, track);
}

Factor FactorBuilder::rayFactor(Window& window, const Landmark& landmark, double* parameters,
                                const Observation& observation, const DirectionMeasurement& measurement,
                                const CameraStates& states) const {
  Factor factor;
  Frame &host = *window.find(landmark.host), &target = *window.find(observation.frame);
  const bool in_host = observation.frame == landmark.host;
  ParameterBlock* secondary = observation.camera > 0 ? states.secondary[observation.camera - 1] : nullptr;
  if (in_host && !secondary) {
    factor.function = std::make_unique<HostReprojectionFactor>(measurement, landmark.base, Rigid3());
    factor.blocks = {parameters};
  } else if (in_host) {
    factor.function = std::make_unique<CalibratedStereoFactor>(measurement, landmark.base,
                                                               camera0_from_camera_[observation.camera],
                                                               secondary->linearizationPoint());
    factor.blocks = {parameters, secondary->value.data()};
  } else {
    CameraPlacement placement{body_from_camera_[0], std::nullopt};
    if (secondary) placement.camera0_from_target = camera0_from_camera_[observation.camera];
    const CalibratedLinearizationPoints first{
        host.firstPose(), target.firstPose(), states.camera0->linearizationPoint(),
        states.time_offset->linearizationPoint(), secondary ? secondary->linearizationPoint() : nullptr};
    factor.function = std::make_unique<CalibratedReprojectionFactor>(
        measurement, landmark.base, placement, host.image_motion, target.image_motion, first);
    factor.blocks = {host.pose.data(), target.pose.data(), parameters, states.camera0->value.data(),
                     states.time_offset->value.data()};
    if (secondary) factor.blocks.push_back(secondary->value.data());
    if (target.interpolated) hangOnNeighbours(window, target, &factor);
  }
  return factor;
}

Factor FactorBuilder::calibratedFactor(Window& window, const Landmark& landmark, double* parameters,
                                       const Observation& observation,
                                       const DirectionMeasurement& measurement,
                                       const CameraStates& states) const {
  Factor factor = rayFactor(window, landmark, parameters, observation, measurement, states);
  if (ParameterBlock* port = states.portOf(observation.camera)) {
    const auto factor_of = [&](const DirectionMeasurement& ray) {
      return rayFactor(window, landmark, parameters, observation, ray, states).function;
    };
    factor.function = std::make_unique<PortFactor>(factor_of, measurement,
                                                   behind_port_[static_cast<size_t>(observation.camera)]);
    factor.blocks.push_back(port->value.data());
  }
  addIntrinsics(measurement, observation.camera, states, &factor);
  return factor;
}

Factor FactorBuilder::shutterFactor(Window& window, const Landmark& landmark, double* parameters,
                                    const Observation& observation, const CameraStates& states) const {
  // The derivative by the line delay is taken before the intrinsics act on the residual, as that by a pose.
  CameraStates by_file = states;
  by_file.intrinsics.clear();
  Factor factor =
      calibratedFactor(window, landmark, parameters, observation, observation.measurement, by_file);
  const CameraMotion motion = motionOf(*window.find(observation.frame), observation.camera);
  const auto factor_of = [this, &window, &landmark, parameters, &observation,
                          by_file](const DirectionMeasurement& measurement) {
    return calibratedFactor(window, landmark, parameters, observation, measurement, by_file).function;
  };
  factor.function =
      std::make_unique<RollingShutterFactor>(factor_of, observation.measurement, motion, observation.camera,
                                             linearizationPoints(window, landmark, observation, by_file));
  factor.blocks.push_back(states.shutter->value.data());
  addIntrinsics(observation.measurement, observation.camera, states, &factor);
  return factor;
}

LandmarkFactors FactorBuilder::calibratedLandmark(Window& window, FeatureTrack& track,
                                                  const CameraStates& states) const {
  Landmark& landmark = *track.landmark;
  LandmarkFactors result;
  result.landmark = landmark.parameters.data();
  result.factors.reserve(track.observations.size());
  for (const Observation& observation : track.observations) {
    result.factors.push_back(states.shutter
                                 ? shutterFactor(window, landmark, result.landmark, observation, states)
                                 : calibratedFactor(window, landmark, result.landmark, observation,
                                                    observation.measurement, states));
    result.factors.back().loss = lossOf(track, robustScale(*window.find(observation.frame)));
  }
  return result;
}

LandmarkFactors FactorBuilder::plainLandmark(Window& window, FeatureTrack& track) const {
  Landmark& landmark = *track.landmark;
  Frame& host = *window.find(landmark.host);
  LandmarkFactors result;
  result.landmark = landmark.parameters.data();
  result.factors.reserve(track.observations.size());
  const Rigid3& body_from_host_camera = body_from_camera_[0];
  for (const Observation& observation : track.observations) {
    Factor& factor = result.factors.emplace_back();
    Frame& target = *window.find(observation.frame);
    factor.loss = lossOf(track, robustScale(target));
    const Rigid3& body_from_target_camera = body_from_camera_[observation.camera];
    if (observation.frame == landmark.host) {
      factor.function = std::make_unique<HostReprojectionFactor>(
          observation.measurement, landmark.base, body_from_target_camera.inverse() * body_from_host_camera);
      factor.blocks = {result.landmark};
    } else {
      factor.function =
          std::make_unique<ReprojectionFactor>(observation.measurement, landmark.base, body_from_host_camera,
                                               body_from_target_camera, host.firstPose(), target.firstPose());
      factor.blocks = {host.pose.data(), target.pose.data(), result.landmark};
      if (target.interpolated) hangOnNeighbours(window, target, &factor);
    }
  }
  return result;
}

}  // namespace lodeline
