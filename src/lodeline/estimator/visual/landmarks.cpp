#include "lodeline/estimator/visual/landmarks.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "lodeline/estimator/state/camera_states.h"
#include "lodeline/estimator/visual/visual_terms.h"
#include "lodeline/factors/intrinsics_factor.h"

namespace lodeline {
namespace {

/// Sighting by camera 0 in the newest keyframe that has one.
const Sighting* hostSighting(const Window& window, const TrackHistory& track) {
  for (auto sighting = track.sightings.rbegin(); sighting != track.sightings.rend(); ++sighting) {
    if (sighting->camera == 0 && window.find(sighting->frame)->is_keyframe) return &*sighting;
  }
  return nullptr;
}

/// What the lens adds to the residual of a point that is seen there, sigmas.
Vec2 shiftByLens(const Sighting& sighting, const CameraStates& cameras) {
  if (cameras.intrinsics.empty()) return Vec2::Zero();
  const GlobalState* lens = cameras.intrinsics[static_cast<size_t>(sighting.camera)];
  return lensShift(sighting.measurement, Vec2::Zero(), lens->value.data());
}

/// Inverse distance along a host's ray from all other sightings; every candidate asks for it in every frame,
/// so it is a closed form and not the full fit of features/triangulation.h. With the host's direction d held,
/// each sighting says
///   B^T (R d + rho t) = 0,
/// which is linear in rho, but for what the lens adds; a second pass weights by the depth that the first one
/// found.
struct InverseDistance {
  double value = 0.0;  ///< 1/m
  double sigma = 1e9;  ///< 1/m
  double rms_sigmas = 1e9;
};

InverseDistance solveInverseDistance(const Window& window, const TrackHistory& track, const Sighting& host,
                                     const FactorMaker& factors, const CameraStates& cameras) {
  struct Equation {
    Vec3 direction;  // R d
    Vec3 baseline;   // t
    Vec2 by_lens;    // sigmas
    const DirectionMeasurement* measurement;
  };
  std::vector<Equation> equations;
  const Rigid3 world_from_host = factors.worldFromCamera(window, *window.find(host.frame), 0);
  const Vec3 host_ray = rayOf(host, cameras);
  for (const Sighting& sighting : track.sightings) {
    if (&sighting == &host) continue;
    const Rigid3 target_from_host =
        factors.worldFromCamera(window, *window.find(sighting.frame), sighting.camera).inverse() *
        world_from_host;
    equations.push_back({target_from_host.rotation * host_ray, target_from_host.translation,
                         shiftByLens(sighting, cameras), &sighting.measurement});
  }
  InverseDistance result;
  for (int pass = 0; pass < 3; ++pass) {
    double information = 0.0;
    double right_side = 0.0;
    for (const Equation& e : equations) {
      const double depth = e.measurement->bearing_C.dot(e.direction + result.value * e.baseline);
      if (depth < 0.1) continue;
      const Mat23 weight = e.measurement->sqrt_information * e.measurement->tangent_C.transpose() / depth;
      const Vec2 slope = weight * e.baseline;
      information += slope.squaredNorm();
      right_side -= slope.dot(weight * e.direction + e.by_lens);
    }
    if (information <= 0.0) return {};
    result.value = right_side / information;
    result.sigma = 1.0 / std::sqrt(information);
  }
  double squared_error = 0.0;
  for (const Equation& e : equations) {
    const Vec3 point = e.direction + result.value * e.baseline;
    squared_error += (directionResidual(*e.measurement, point, nullptr) + e.by_lens).squaredNorm();
  }
  result.rms_sigmas = std::sqrt(squared_error / (2.0 * static_cast<double>(equations.size())));
  return result;
}

/// The inverse distance that points have here, 1/m: median of the landmarks in view, of all where few are.
/// Nothing where the window has hardly any.
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
  const auto middle = known.begin() + static_cast<std::ptrdiff_t>(known.size() / 2);
  std::nth_element(known.begin(), middle, known.end());
  return *middle;
}

/// Whether a point becomes a landmark must not depend on what noise makes of its distance: where the rig
/// hardly moves, points that seem to be near are those that move by themselves, such as flakes in the water,
/// and those with the largest errors. So its sigma is compared with the `usual` inverse distance.
bool isUsable(const InverseDistance& rho, std::optional<double> usual, const LandmarkOptions& options) {
  const bool known = rho.sigma < options.max_relative_sigma * usual.value_or(std::abs(rho.value)) ||
                     rho.sigma < options.max_inverse_distance_sigma_per_m;
  // A far point's inverse distance may come out a little below zero.
  const bool in_front = rho.value > -2.0 * rho.sigma && rho.value < 1.0 / options.min_distance_m;
  return known && in_front && rho.rms_sigmas < options.max_error_sigmas;
}

}  // namespace

int createLandmarks(Window& window, const FactorMaker& factors, const LandmarkOptions& options) {
  const int min_frames = std::min(options.min_frames, static_cast<int>(window.frames().size()));
  std::vector<TrackHistory*> candidates;
  int landmarks = 0;
  int in_view = 0;
  for (auto& [id, track] : window.tracks()) {
    if (track.landmark) {
      ++landmarks;
      in_view += track.seenIn(window.newest().id);
    } else if (track.sightings.size() >= 2 && track.seenIn(window.newest().id) &&
               track.frameCount() >= min_frames) {
      candidates.push_back(&track);
    }
  }
  std::stable_sort(candidates.begin(), candidates.end(), [](const TrackHistory* a, const TrackHistory* b) {
    return a->sightings.size() > b->sightings.size();
  });
  const CameraStates cameras = cameraStates(window);
  const std::optional<double> usual = usualInverseDistance(window);
  const int wanted = std::max(options.max_landmarks - landmarks,
                              std::min(options.least_in_view, options.max_landmarks) - in_view);
  int created = 0;
  for (TrackHistory* track : candidates) {
    if (created >= wanted) break;
    const Sighting* host = hostSighting(window, *track);
    if (!host) continue;
    const InverseDistance rho = solveInverseDistance(window, *track, *host, factors, cameras);
    if (!isUsable(rho, usual, options)) continue;
    Landmark landmark;
    landmark.host = host->frame;
    landmark.base = LandmarkBase(rayOf(*host, cameras));
    landmark.parameters = {0.0, 0.0, std::max(rho.value, 1e-4)};
    track->landmark = landmark;
    ++created;
  }
  return created;
}

int removeOutliers(Window& window, const std::vector<double>& errors_sigmas, const LandmarkOptions& options,
                   std::vector<SightingError>* errors) {
  int removed = 0;
  auto next = errors_sigmas.begin();
  for (auto& [id, track] : window.tracks()) {
    if (!track.landmark || track.is_dormant) continue;
    bool host_kept = false;
    bool other_kept = false;
    auto kept = track.sightings.begin();
    for (const Sighting& sighting : track.sightings) {
      const double sigmas = *next++;
      const bool is_host = track.isHosted(sighting);
      if (errors && !is_host) errors->push_back({id, sighting.frame, sigmas});
      if (sigmas > options.max_error_sigmas) continue;
      (is_host ? host_kept : other_kept) = true;
      if (&*kept != &sighting) *kept = sighting;
      ++kept;
    }
    removed += static_cast<int>(track.sightings.end() - kept);
    track.sightings.erase(kept, track.sightings.end());
    const double rho = track.landmark->inverseDistance();
    const bool sane = rho > -0.05 && rho < 1.0 / options.min_distance_m;
    if (host_kept && other_kept && sane) continue;
    // What remains is inconsistent with itself or with the poses: start over with later sightings.
    track.landmark.reset();
    track.sightings.clear();
  }
  window.removeEmptyTracks();
  return removed;
}

int removeOutliers(Window& window, const FactorMaker& factors, const LandmarkOptions& options) {
  return removeOutliers(window, VisualTerms(window, factors, VisualTerms::Of::kAwake).errors(), options);
}

ReprojectionStatistics reprojectionStatistics(Window& window, const FactorMaker& factors, FrameId frame) {
  ReprojectionStatistics statistics;
  for (const auto& [id, track] : window.tracks()) {
    if (track.landmark) statistics.landmarks += track.seenIn(frame);
  }
  double squared = 0.0;
  for (const double sigmas : VisualTerms(window, factors, VisualTerms::Of::kAll, frame).errors()) {
    squared += sigmas * sigmas;
    ++statistics.sightings;
  }
  if (statistics.sightings > 0) statistics.rms_sigmas = std::sqrt(squared / (2.0 * statistics.sightings));
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
