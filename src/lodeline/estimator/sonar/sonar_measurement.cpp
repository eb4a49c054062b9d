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

  /// The blocks of a range factor beside the pose at the echo, and what the factor knows of them.
  struct Blocks {
    std::vector<double*> hosts, landmarks;
    std::vector<SurfaceLandmark> members;
    SonarLinearizationPoints first;
  };

  Blocks blocksOf(const LocalSurface& surface) const {
    Blocks blocks;
    for (const LocalSurface::Member& member : surface.members) {
      Landmark& landmark = *context_.window.tracks().at(member.track).landmark;
      Frame& host = *context_.window.find(landmark.host);
      const auto known = std::find(blocks.hosts.begin(), blocks.hosts.end(), host.pose.data());
      blocks.members.push_back(
          {landmark.base, static_cast<size_t>(known - blocks.hosts.begin()), member.weight});
      blocks.landmarks.push_back(landmark.parameters.data());
      if (known != blocks.hosts.end()) continue;
      blocks.hosts.push_back(host.pose.data());
      blocks.first.hosts.push_back(host.firstPose());
    }
    return blocks;
  }

  SonarBeam beamOf(const SonarEcho& echo) const {
    if (!is_attached_) return echo.beam;
    return {echo.frame_from_echo * echo.beam.origin_B,
            echo.frame_from_echo.rotation.toRotationMatrix() * echo.beam.axes_B};
  }

  /// Linearization point of the pose at the echo; empty while neither frame has one.
  std::optional<PoseBlock> firstPoseOf(const SonarEcho& echo) const {
    const Frame& frame = context_.frame;
    if (is_attached_) return frame.first_pose;
    if (!context_.before->first_pose && !frame.first_pose) return std::nullopt;
    PoseBlock first;
    poseToBlock(echo.between.pose(context_.before->firstWorldFromBody(), frame.firstWorldFromBody()),
                first.data());
    return first;
  }

  Factor rangeFactor(const SonarEcho& echo, const LocalSurface& surface) const {
    Blocks blocks = blocksOf(surface);
    ParameterBlock* camera = cameras_ ? cameras_.camera0 : nullptr;
    if (camera) blocks.first.camera = camera->linearizationPoint();
    blocks.first.pose = firstPoseOf(echo);
    const double variance_m2 = echo.sigma_m * echo.sigma_m + echo.share * surface.sigma_m * surface.sigma_m;
    Factor factor;
    factor.function = std::make_unique<SonarRangeFactor>(
        echo.range_m, std::sqrt(measurement_.variance_scale * variance_m2), beamOf(echo),
        context_.builder.bodyFromCamera(0), camera != nullptr, blocks.hosts.size(), std::move(blocks.members),
        blocks.first);
    Frame& frame = context_.frame;
    factor.blocks = {is_attached_ ? frame.pose.data() : context_.before->pose.data()};
    factor.blocks.insert(factor.blocks.end(), blocks.hosts.begin(), blocks.hosts.end());
    if (camera) factor.blocks.push_back(camera->value.data());
    factor.blocks.insert(factor.blocks.end(), blocks.landmarks.begin(), blocks.landmarks.end());
    if (is_attached_) return factor;
    factor.function = std::make_unique<InterpolatedPoseFactor>(
        std::move(factor.function), 0, echo.between, context_.before->firstPose(), frame.firstPose());
    factor.blocks.push_back(frame.pose.data());
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
