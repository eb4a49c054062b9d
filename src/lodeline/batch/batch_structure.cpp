#include "lodeline/batch/batch_structure.h"

#include <algorithm>
#include <cmath>

#include "lodeline/frontend/stereo/triangulation.h"
#include "lodeline/problem/marginalization/landmark_host.h"
#include "lodeline/problem/state/camera_states.h"

namespace lodeline {
namespace {

bool hosts(const FeatureTrack& track) {
  return track.seenIn(track.landmark->host) && track.find(track.landmark->host, 0) != nullptr;
}

/// Cost of a landmark's terms and, under their losses, the normal equations of the landmark alone.
struct LandmarkSystem {
  double cost = 0.0;
  Mat3 hessian = Mat3::Zero();
  Vec3 gradient = Vec3::Zero();

  explicit LandmarkSystem(const LandmarkFactors& terms) {
    for (const Factor& factor : terms.factors) add(factor, terms.landmark);
  }
  void add(const Factor& factor, const double* landmark) {
    using RowMajor = Eigen::Matrix<double, 2, kLandmarkSize, Eigen::RowMajor>;
    RowMajor by_landmark;
    std::vector<double*> jacobians(factor.blocks.size(), nullptr);
    const auto block = std::find(factor.blocks.begin(), factor.blocks.end(), landmark);
    jacobians[static_cast<size_t>(block - factor.blocks.begin())] = by_landmark.data();
    Vec2 residual;
    factor.function->Evaluate(factor.blocks.data(), residual.data(), jacobians.data());
    double rho[3];
    factor.loss->Evaluate(residual.squaredNorm(), rho);
    cost += 0.5 * rho[0];
    hessian += rho[1] * by_landmark.transpose() * by_landmark;
    gradient += rho[1] * by_landmark.transpose() * residual;
  }
};

/// Moves a landmark to the minimum of its robust cost, with fixed poses. A position in the middle of all
/// observations is so wrong after one outlier that most of the others contradict it.
void settle(const LandmarkFactors& terms) {
  constexpr int kMostSteps = 10;
  constexpr double kLeastGain = 1e-3;
  Eigen::Map<Vec3> landmark(terms.landmark);
  LandmarkSystem system(terms);
  for (int i = 0; i < kMostSteps; ++i) {
    const Vec3 before = landmark;
    landmark -= system.hessian.ldlt().solve(system.gradient);
    const LandmarkSystem next(terms);
    const double gain = system.cost - next.cost;
    if (!(gain > 0.0)) landmark = before;
    if (!(gain > kLeastGain * system.cost)) return;
    system = next;
  }
}

}  // namespace

std::vector<Vec2> residualsOf(const LandmarkFactors& landmark) {
  std::vector<Vec2> residuals;
  for (const Factor& factor : landmark.factors)
    factor.function->Evaluate(factor.blocks.data(), residuals.emplace_back().data(), nullptr);
  return residuals;
}

void placeLandmark(Window& window, const FactorBuilder& factors, const LandmarkOptions& options,
                   FeatureTrack* track) {
  const auto host = std::find_if(track->observations.begin(), track->observations.end(),
                                 [](const Observation& observation) { return observation.camera == 0; });
  if (host == track->observations.end() || track->observations.size() < 2) return;
  const CameraStates cameras = cameraStates(window);
  const auto viewOf = [&](const Observation& seen) {
    Observation observation = seen;
    observation.measurement = factors.presentMeasurement(window, seen, cameras);
    // Pixels per angle, geometric mean of both axes.
    const double pixels = std::sqrt(std::abs(observation.measurement.sqrt_information.determinant()));
    Rigid3 world_from_ray =
        factors.worldFromCamera(window, *window.find(observation.frame), observation.camera);
    world_from_ray.translation += world_from_ray.rotation * observation.measurement.origin_C;
    return BearingView{world_from_ray, rayOf(observation, cameras), 1.0 / pixels};
  };
  std::vector<BearingView> views = {viewOf(*host)};
  for (const Observation& observation : track->observations) {
    if (&observation != &*host) views.push_back(viewOf(observation));
  }
  TriangulationOptions wanted;
  wanted.max_rms_sigmas = 3.0 * options.max_error_sigmas;  // single observations are checked afterwards
  const Triangulation point = triangulate(views, wanted);
  const double rho = point.inverse_depth_per_m, sigma = point.inverse_depth_sigma_per_m;
  const bool is_known =
      sigma < options.max_relative_sigma * std::abs(rho) || sigma < options.max_inverse_distance_sigma_per_m;
  const bool is_usable =
      point.good() || (point.status == TriangulationStatus::LowParallax && is_known && rho > 1e-4);
  if (!is_usable || rho > 1.0 / options.min_distance_m || rho < 1e-4) return;
  const Vec3 point_C = views.front().world_from_camera.inverse() * point.point_W + host->measurement.origin_C;
  Landmark landmark;
  landmark.host = host->frame;
  landmark.base = LandmarkBase(views.front().bearing_C);
  const double depth = landmark.base.bearing_C.dot(point_C);
  if (depth < options.min_distance_m) return;
  const Vec2 ab = landmark.base.tangent_C.transpose() * point_C / depth;
  landmark.parameters = {ab.x(), ab.y(), 1.0 / depth};
  track->landmark = landmark;
}

int removeContradictions(Window& window, const FactorBuilder& factors, const LandmarkOptions& options,
                         TrackId id, FeatureTrack* track, std::vector<ObservationError>* errors) {
  const LandmarkFactors terms = factors.landmark(window, *track);
  const std::vector<Vec2> as_placed = residualsOf(terms);
  settle(terms);
  const std::vector<Vec2> settled = residualsOf(terms);
  std::vector<Observation> kept;
  for (size_t i = 0; i < track->observations.size(); ++i) {
    const Observation& observation = track->observations[i];
    const bool is_host = observation.frame == track->landmark->host && observation.camera == 0;
    if (!is_host) errors->push_back({id, observation.frame, as_placed[i].norm()});
    if (settled[i].norm() <= options.max_error_sigmas) kept.push_back(observation);
  }
  const int removed = static_cast<int>(track->observations.size() - kept.size());
  track->observations = std::move(kept);
  if (!hosts(*track)) moveToNewHost(window, *track, track->landmark->host, factors);
  if (!track->landmark) return removed;
  const double rho = track->landmark->inverseDistance();
  const bool is_sane = rho > -0.05 && rho < 1.0 / options.min_distance_m;
  if (track->observations.size() < 2 || !is_sane) track->landmark.reset();
  return removed;
}

}  // namespace lodeline
