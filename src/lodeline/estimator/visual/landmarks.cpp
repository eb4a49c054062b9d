#include "lodeline/estimator/visual/landmarks.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "lodeline/estimator/visual/reprojection_system.h"
#include "lodeline/factors/intrinsics_factor.h"
#include "lodeline/problem/state/camera_states.h"
#include "lodeline/util/median.h"

namespace lodeline {
namespace {

/// Observation by camera 0 in the newest keyframe that observes the track.
const Observation* hostObservation(const Window& window, const FeatureTrack& track) {
  for (auto observation = track.observations.rbegin(); observation != track.observations.rend();
       ++observation) {
    if (observation->camera == 0 && window.find(observation->frame)->is_keyframe) return &*observation;
  }
  return nullptr;
}

/// Shift of the residual by the estimated intrinsics for a point at the observed pixel, sigmas.
Vec2 shiftByIntrinsics(const Observation& observation, const CameraStates& cameras) {
  if (cameras.intrinsics.empty()) return Vec2::Zero();
  const ParameterBlock* lens = cameras.intrinsics[static_cast<size_t>(observation.camera)];
  return intrinsicsShift(observation.measurement, Vec2::Zero(), lens->value.data());
}

/// An observation with its measurement as of the time of its image.
Observation atTimeOfImage(const Window& window, const Observation& observation, const FactorBuilder& factors,
                          const CameraStates& cameras) {
  Observation moved = observation;
  moved.measurement = lodeline::atTimeOfImage(
      observation, factors.motionOf(*window.find(observation.frame), observation.camera), cameras);
  return moved;
}

/// Inverse distance along a host's ray from all other observations. It is a closed form and not the full fit
/// of frontend/stereo/triangulation.h, because every candidate needs it in every frame. With the host's
/// direction d held, each observation gives
///   B^T (R d + rho t) = 0.
/// This is linear in rho, apart from the shift by the intrinsics. Further passes weight by the depth that the
/// pass before has found.
struct InverseDistance {
  double value = 0.0;  ///< 1/m
  double sigma = 1e9;  ///< 1/m
  double rms_sigmas = 1e9;
};

InverseDistance solveInverseDistance(const Window& window, const FeatureTrack& track, const Observation& host,
                                     const FactorBuilder& factors, const CameraStates& cameras) {
  struct Equation {
    Vec3 direction;      // R d
    Vec3 baseline;       // t
    Vec2 by_intrinsics;  // sigmas
    DirectionMeasurement measurement;
  };
  std::vector<Equation> equations;
  const Rigid3 world_from_host = factors.worldFromCamera(window, *window.find(host.frame), 0);
  const Vec3 host_ray = rayOf(host, cameras);
  for (const Observation& seen : track.observations) {
    if (seen.frame == host.frame && seen.camera == host.camera) continue;
    const Observation observation = atTimeOfImage(window, seen, factors, cameras);
    const Rigid3 target_from_host =
        factors.worldFromCamera(window, *window.find(observation.frame), observation.camera).inverse() *
        world_from_host;
    // From the origin of the observed ray to that of the host's.
    const Vec3 baseline = target_from_host.rotation * host.measurement.origin_C +
                          target_from_host.translation - observation.measurement.origin_C;
    equations.push_back({target_from_host.rotation * host_ray, baseline,
                         shiftByIntrinsics(observation, cameras), observation.measurement});
  }
  InverseDistance result;
  for (int pass = 0; pass < 3; ++pass) {
    double information = 0.0;
    double right_side = 0.0;
    for (const Equation& e : equations) {
      const double depth = e.measurement.bearing_C.dot(e.direction + result.value * e.baseline);
      if (depth < 0.1) continue;
      const Mat23 weight = e.measurement.sqrt_information * e.measurement.tangent_C.transpose() / depth;
      const Vec2 slope = weight * e.baseline;
      information += slope.squaredNorm();
      right_side -= slope.dot(weight * e.direction + e.by_intrinsics);
    }
    if (information <= 0.0) return {};
    result.value = right_side / information;
    result.sigma = 1.0 / std::sqrt(information);
  }
  double squared_error = 0.0;
  for (const Equation& e : equations) {
    const Vec3 point = e.direction + result.value * e.baseline;
    squared_error += (directionResidual(e.measurement, point, nullptr) + e.by_intrinsics).squaredNorm();
  }
  result.rms_sigmas = std::sqrt(squared_error / (2.0 * static_cast<double>(equations.size())));
  return result;
}

/// Usual inverse distance of points in this scene, 1/m: median over the landmarks in view, over all where few
/// are in view. Empty where the window has hardly any.
std::optional<double> usualInverseDistance(const Window& window) {
  constexpr size_t kEnough = 8;
  std::vector<double> in_view, all;
  for (const auto& [id, track] : window.tracks()) {
    if (!track.landmark) continue;
    all.push_back(std::max(0.0, track.landmark->inverseDistance()));
    if (track.seenIn(window.newest().id)) in_view.push_back(all.back());
  }
  std::vector<double>& known = in_view.size() >= kEnough ? in_view : all;
  if (known.size() < kEnough) return std::nullopt;
  return median(std::move(known));
}

/// Whether the inverse distance is accurate enough for a landmark. The decision must not depend on the effect
/// of noise on the distance. Where the rig hardly moves, apparently near points have the largest errors, or
/// move by themselves, such as flakes in the water. The sigma is therefore compared with the `usual` inverse
/// distance.
bool isUsable(const InverseDistance& rho, std::optional<double> usual, const LandmarkOptions& options) {
  const bool known = rho.sigma < options.max_relative_sigma * usual.value_or(std::abs(rho.value)) ||
                     rho.sigma < options.max_inverse_distance_sigma_per_m;
  // The inverse distance of a far point may be slightly negative.
  const bool in_front = rho.value > -2.0 * rho.sigma && rho.value < 1.0 / options.min_distance_m;
  return known && in_front && rho.rms_sigmas < options.max_error_sigmas;
}

}  // namespace

int createLandmarks(Window& window, const FactorBuilder& factors, const LandmarkOptions& options) {
  const int min_frames = std::min(options.min_frames, static_cast<int>(window.frames().size()));
  std::vector<FeatureTrack*> candidates;
  int landmarks = 0;
  int in_view = 0;
  for (auto& [id, track] : window.tracks()) {
    if (track.landmark) {
      ++landmarks;
      in_view += track.seenIn(window.newest().id);
    } else if (track.observations.size() >= 2 && track.seenIn(window.newest().id) &&
               track.frameCount() >= min_frames) {
      candidates.push_back(&track);
    }
  }
  std::stable_sort(candidates.begin(), candidates.end(), [](const FeatureTrack* a, const FeatureTrack* b) {
    return a->observations.size() > b->observations.size();
  });
  const CameraStates cameras = cameraStates(window);
  const std::optional<double> usual = usualInverseDistance(window);
  const int wanted = std::max(options.max_landmarks - landmarks,
                              std::min(options.least_in_view, options.max_landmarks) - in_view);
  int created = 0;
  for (FeatureTrack* track : candidates) {
    if (created >= wanted) break;
    const Observation* seen = hostObservation(window, *track);
    if (!seen) continue;
    const Observation host = atTimeOfImage(window, *seen, factors, cameras);
    const InverseDistance rho = solveInverseDistance(window, *track, host, factors, cameras);
    if (!isUsable(rho, usual, options)) continue;
    Landmark landmark;
    landmark.host = host.frame;
    landmark.base = LandmarkBase(rayOf(host, cameras));
    const double inverse_distance_per_m = std::max(rho.value, 1e-4);
    // The origin of the ray is the point of it next to the lens, so it has no part along the ray.
    const Vec2 aside =
        inverse_distance_per_m * landmark.base.tangent_C.transpose() * host.measurement.origin_C;
    landmark.parameters = {aside.x(), aside.y(), inverse_distance_per_m};
    track->landmark = landmark;
    ++created;
  }
  return created;
}

int removeOutliers(Window& window, const std::vector<double>& errors_sigmas, const LandmarkOptions& options,
                   std::vector<ObservationError>* errors) {
  int removed = 0;
  auto next = errors_sigmas.begin();
  for (auto& [id, track] : window.tracks()) {
    if (!track.landmark || track.is_frozen) continue;
    bool host_kept = false;
    bool other_kept = false;
    auto kept = track.observations.begin();
    for (const Observation& observation : track.observations) {
      const double sigmas = *next++;
      const bool is_host = track.isHosted(observation);
      if (errors && !is_host) errors->push_back({id, observation.frame, sigmas});
      if (sigmas > options.max_error_sigmas) continue;
      (is_host ? host_kept : other_kept) = true;
      if (&*kept != &observation) *kept = observation;
      ++kept;
    }
    removed += static_cast<int>(track.observations.end() - kept);
    track.observations.erase(kept, track.observations.end());
    const double rho = track.landmark->inverseDistance();
    const bool sane = rho > -0.05 && rho < 1.0 / options.min_distance_m;
    if (host_kept && other_kept && sane) continue;
    // The remaining observations contradict each other or the poses: the track starts again with later
    // observations.
    track.landmark.reset();
    track.observations.clear();
  }
  window.removeEmptyTracks();
  return removed;
}

int removeOutliers(Window& window, const FactorBuilder& factors, const LandmarkOptions& options) {
  return removeOutliers(window, ReprojectionSystem(window, factors, ReprojectionSystem::Of::kLive).errors(),
                        options);
}

ReprojectionStatistics reprojectionStatistics(Window& window, const FactorBuilder& factors, FrameId frame) {
  ReprojectionStatistics statistics;
  for (const auto& [id, track] : window.tracks()) {
    if (track.landmark) statistics.landmarks += track.seenIn(frame);
  }
  double squared = 0.0;
  for (const double sigmas :
       ReprojectionSystem(window, factors, ReprojectionSystem::Of::kAll, frame).errors()) {
    squared += sigmas * sigmas;
    ++statistics.observations;
  }
  if (statistics.observations > 0)
    statistics.rms_sigmas = std::sqrt(squared / (2.0 * statistics.observations));
  return statistics;
}

std::optional<double> meanLandmarkDistance_m(const Window& window, FrameId frame, int camera) {
  double inverse_distances = 0.0;
  int count = 0;
  for (const auto& [id, track] : window.tracks()) {
    if (!track.landmark || track.landmark->inverseDistance() <= 0.0 || !track.find(frame, camera)) continue;
    inverse_distances += track.landmark->inverseDistance();
    ++count;
  }
  if (count == 0) return std::nullopt;
  return count / inverse_distances;
}

}  // namespace lodeline
