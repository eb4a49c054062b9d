#include "lodeline/estimator/sonar/sonar_measurement.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "lodeline/estimator/sonar/landmark_response.h"

namespace lodeline {
namespace {

using Scope = MeasurementContext::Scope;

/// Makes the factors of one frame's echoes.
class EchoFactors {
 public:
  EchoFactors(const SonarMeasurement& measurement, const MeasurementContext& context)
      : measurement_(measurement),
        context_(context),
        is_attached_(context.scope == Scope::Batch),
        cameras_(cameraStates(context.window)) {}

  std::optional<Factor> make(const SonarEcho& echo) {
    const Frame& frame = context_.frame;
    const Rigid3 pose = is_attached_
                            ? frame.worldFromBody() * echo.frame_from_echo
                            : echo.between.pose(context_.before->worldFromBody(), frame.worldFromBody());
    const auto surface =
        surfaceAlong(echo.beam, pose, context_.window, context_.builder, measurement_.options,
                     [this](const FeatureTrack& track) { return isChosen(track); });
    if (!surface) return std::nullopt;
    Factor factor = rangeFactor(echo, *surface);
    std::vector<LandmarkResponse> responses;
    for (const LocalSurface::Member& member : surface->members) {
      responses.push_back(response(member.track));
      if (!isPlaced(responses.back())) return std::nullopt;
    }
    auto eliminated =
        std::make_unique<EliminatedLandmarksFactor>(std::move(factor), std::move(responses), echo.share);
    Factor result;
    result.blocks = eliminated->blocks();
    result.function = std::move(eliminated);
    result.loss = std::make_shared<ceres::CauchyLoss>(measurement_.options.robust_scale_sigmas);
    return result;
  }

 private:
  /// Whether a frame may be among the blocks. What becomes part of the prior must not contain later frames,
  /// whose poses still change; the batch solution holds a measurement to the frames before.
  bool isAllowed(const Frame& frame) const {
    if (context_.scope == Scope::Batch) return frame.id <= context_.frame.id;
    return context_.scope == Scope::Window || !frame.has_motion || &frame == context_.before ||
           &frame == &context_.frame;
  }
  bool isChosen(const FeatureTrack& track) const {
    if (context_.scope == Scope::Batch && !track.seenIn(context_.frame.id)) return false;
    const Frame* host = context_.window.find(track.landmark->host);
    if (host == nullptr || host->interpolated || !isAllowed(*host)) return false;
    // The observations that are left must still tell where the landmark is.
    constexpr int kLeastObservations = 3;
    return std::count_if(track.observations.begin(), track.observations.end(), [&](const auto& observation) {
             return isAllowed(*context_.window.find(observation.frame));
           }) >= kLeastObservations;
  }
  /// Whether the observations tell the distance of a landmark. A response without that information has no
  /// variance in this direction (landmarkInverseRoot).
  static bool isPlaced(const LandmarkResponse& response) {
    constexpr double kGreatestSigma = 0.5;  // relative
    const double variance = response.covariance(2, 2);
    return variance > 0.0 && variance < std::pow(kGreatestSigma * response.landmark[2], 2);
  }

  Factor rangeFactor(const SonarEcho& echo, const LocalSurface& surface) const {
    Factor factor;
    std::vector<double*> hosts, landmarks;
    std::vector<SurfaceLandmark> members;
    const Frame& frame = context_.frame;
    SonarLinearizationPoints first;
    for (const LocalSurface::Member& member : surface.members) {
      Landmark& landmark = *context_.window.tracks().at(member.track).landmark;
      Frame& host = *context_.window.find(landmark.host);
      const auto known = std::find(hosts.begin(), hosts.end(), host.pose.data());
      const auto index = static_cast<size_t>(known - hosts.begin());
      if (known == hosts.end()) {
        hosts.push_back(host.pose.data());
        first.hosts.push_back(host.firstPose());
      }
      landmarks.push_back(landmark.parameters.data());
      members.push_back({landmark.base, index, member.weight});
    }
    ParameterBlock* camera = cameras_ ? cameras_.camera0 : nullptr;
    if (camera) first.camera = camera->linearizationPoint();
    SonarBeam beam = echo.beam;
    if (is_attached_) {
      beam.origin_B = echo.frame_from_echo * beam.origin_B;
      beam.axes_B = echo.frame_from_echo.rotation.toRotationMatrix() * beam.axes_B;
      first.pose = frame.first_pose;
    } else if (context_.before->first_pose || frame.first_pose) {
      poseToBlock(echo.between.pose(context_.before->firstWorldFromBody(), frame.firstWorldFromBody()),
                  first.pose.emplace().data());
    }
    const double sigma_m =
        std::sqrt(measurement_.variance_scale *
                  (echo.sigma_m * echo.sigma_m + echo.share * std::pow(surface.sigma_m, 2)));
    factor.function =
        std::make_unique<SonarRangeFactor>(echo.range_m, sigma_m, beam, context_.builder.bodyFromCamera(0),
                                           camera != nullptr, hosts.size(), std::move(members), first);
    factor.blocks = {is_attached_ ? context_.frame.pose.data() : context_.before->pose.data()};
    factor.blocks.insert(factor.blocks.end(), hosts.begin(), hosts.end());
    if (camera) factor.blocks.push_back(camera->value.data());
    factor.blocks.insert(factor.blocks.end(), landmarks.begin(), landmarks.end());
    if (is_attached_) return factor;
    factor.function = std::make_unique<InterpolatedPoseFactor>(
        std::move(factor.function), 0, echo.between, context_.before->firstPose(), frame.firstPose());
    factor.blocks.push_back(context_.frame.pose.data());
    return factor;
  }

  const LandmarkResponse& response(TrackId id) {
    const auto known = responses_.find(id);
    if (known != responses_.end()) return known->second;
    FeatureTrack& track = context_.window.tracks().at(id);
    LandmarkFactors terms = context_.builder.landmark(context_.window, track);
    std::vector<Factor> allowed;
    for (size_t i = 0; i < terms.factors.size(); ++i) {
      if (isAllowed(*context_.window.find(track.observations[i].frame)))
        allowed.push_back(std::move(terms.factors[i]));
    }
    terms.factors = std::move(allowed);
    return responses_.emplace(id, responseOf(terms)).first->second;
  }

  const SonarMeasurement& measurement_;
  const MeasurementContext& context_;
  bool is_attached_;  ///< the poses at the echoes follow the frame alone
  CameraStates cameras_;
  std::map<TrackId, LandmarkResponse> responses_;
};

}  // namespace

std::vector<Factor> SonarMeasurement::factors(const MeasurementContext& context) const {
  std::vector<Factor> factors;
  if (context.before == nullptr && context.scope != Scope::Batch) return factors;
  EchoFactors maker(*this, context);
  for (const SonarEcho& echo : echoes) {
    if (auto factor = maker.make(echo)) factors.push_back(std::move(*factor));
  }
  return factors;
}

std::shared_ptr<const Measurement> SonarMeasurement::weighted(int count) const {
  auto weighted = std::make_shared<SonarMeasurement>(*this);
  weighted->variance_scale /= count;
  return weighted;
}

}  // namespace lodeline
