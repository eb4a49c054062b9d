#include "lodeline/estimator/factor_list.h"

#include "lodeline/factors/inertial_factor.h"

namespace lodeline {

FactorMaker::FactorMaker(const Rig& rig, const EstimatorOptions& options)
    : gravity_W_(options.gravity_W),
      reprojection_loss_(std::make_unique<ceres::CauchyLoss>(options.solver.robust_scale_sigmas)) {
  for (const CameraCalibration& camera : rig.cameras) body_from_camera_.push_back(camera.body_from_camera);
}

Factor FactorMaker::inertial(Frame& before, Frame& frame) const {
  Factor factor;
  const InertialFirstEstimates first_estimates{before.firstPose(), before.firstMotion(), frame.firstPose(),
                                               frame.firstMotion()};
  factor.function = std::make_unique<InertialFactor>(frame.from_previous.get(), gravity_W_, first_estimates);
  factor.blocks = {before.pose.data(), before.motion.data(), frame.pose.data(), frame.motion.data()};
  return factor;
}

Factor FactorMaker::prior(const Prior& prior) const {
  Factor factor;
  factor.function = std::make_unique<PriorFactor>(prior);
  for (const Prior::Block& block : prior.blocks) factor.blocks.push_back(block.value);
  return factor;
}

LandmarkFactors FactorMaker::landmark(Window& window, TrackHistory& track) const {
  Landmark& landmark = *track.landmark;
  Frame& host = *window.find(landmark.host);
  LandmarkFactors result;
  result.landmark = landmark.parameters.data();
  result.factors.reserve(track.sightings.size());
  const Rigid3& body_from_host_camera = body_from_camera_[0];
  for (const Sighting& sighting : track.sightings) {
    Factor& factor = result.factors.emplace_back();
    factor.loss = reprojection_loss_.get();
    const Rigid3& body_from_target_camera = body_from_camera_[sighting.camera];
    if (sighting.frame == landmark.host) {
      factor.function = std::make_unique<HostReprojectionFactor>(
          sighting.measurement, landmark.base, body_from_target_camera.inverse() * body_from_host_camera);
      factor.blocks = {result.landmark};
    } else {
      Frame& target = *window.find(sighting.frame);
      factor.function =
          std::make_unique<ReprojectionFactor>(sighting.measurement, landmark.base, body_from_host_camera,
                                               body_from_target_camera, host.firstPose(), target.firstPose());
      factor.blocks = {host.pose.data(), target.pose.data(), result.landmark};
    }
  }
  return result;
}

}  // namespace lodeline
