#include "lodeline/mapping/recognition/frame_geometry.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lodeline/problem/factor_builder.h"
#include "lodeline/problem/marginalization/landmark_host.h"

namespace lodeline {
namespace {

/// Share of a landmark's distance that its observations do not average out: they share the calibration.
constexpr double kCommonDistanceError = 0.003;
/// Sine of the smallest parallax that gives a position. With it and a sigma of 2 mrad, the distance is
/// accurate to a fifth.
constexpr double kLeastParallax_sigmas = 5.0;

/// A point, and where rays to it start.
struct SightLine {
  Vec3 origin = Vec3::Zero();
  double sigma_rad = 1e-3;
};

/// Standard deviation of the distance of `point` along the ray from `origin`, by the sight lines to the
/// point. A change of the distance by dr turns a sight line of length d by dr sin(a) / d, with the angle a
/// between both. Returns infinity where all are parallel.
double distanceSigma_m(const Vec3& origin, const Vec3& point, const std::vector<SightLine>& lines) {
  const Vec3 along = (point - origin).normalized();
  double information = 0.0;
  for (const SightLine& line : lines) {
    const Vec3 there = point - line.origin;
    const double turned_per_m = along.cross(there.normalized()).norm() / there.norm();
    information += std::pow(turned_per_m / line.sigma_rad, 2);
  }
  return information > 0.0 ? 1.0 / std::sqrt(information) : std::numeric_limits<double>::infinity();
}

TrackPoint trackPoint(TrackId track, const Vec3& point_B, double distance_m, double sigma_m) {
  return {track, point_B, std::hypot(sigma_m, kCommonDistanceError * distance_m)};
}

/// The landmark of a track in axes of the newest body; empty where it has none or its distance is not known.
std::optional<TrackPoint> landmarkOf(const Window& window, const FactorBuilder& factors, TrackId id) {
  const auto found = window.tracks().find(id);
  if (found == window.tracks().end() || !found->second.landmark) return std::nullopt;
  const auto point = mapPointOf(window, id, found->second, factors);
  if (!point) return std::nullopt;
  std::vector<SightLine> lines;
  for (const Observation& observation : found->second.observations) {
    const Frame* frame = window.find(observation.frame);
    if (!frame) continue;
    const DirectionMeasurement& measured = observation.measurement;
    const double sigma_rad = 1.0 / std::sqrt(std::abs(measured.sqrt_information.determinant()));
    lines.push_back(
        {factors.worldFromCamera(window, *frame, observation.camera) * measured.origin_C, sigma_rad});
  }
  const Frame& newest = window.newest();
  const Vec3 origin_W = factors.worldFromCamera(window, newest, 0).translation;
  const double distance_m = (point->position_W - origin_W).norm();
  const double sigma_m = distanceSigma_m(origin_W, point->position_W, lines);
  if (!(kLeastParallax_sigmas * sigma_m < distance_m)) return std::nullopt;
  return trackPoint(id, newest.worldFromBody().inverse() * point->position_W, distance_m, sigma_m);
}

}  // namespace

std::optional<BodyRay> FrameGeometry::rayOf(int camera, const Vec2& pixel, double sigma_px) const {
  const auto index = static_cast<size_t>(camera);
  auto ray = cameras[index]->viewRay(pixel);
  if (!ray) return std::nullopt;
  Observation observation;
  observation.camera = camera;
  observation.measurement = DirectionMeasurement::fromRay(*cameras[index], ray->fromNearestPoint(), sigma_px);
  const double determinant = std::abs(observation.measurement.sqrt_information.determinant());
  if (!(determinant > 0.0)) return std::nullopt;
  const Rigid3& body_from_camera = body_from_cameras[index];
  BodyRay result;
  result.camera = camera;
  result.pixel = pixel;
  result.origin_B = body_from_camera * observation.measurement.origin_C;
  result.bearing_B = body_from_camera.rotation * lodeline::rayOf(observation, states);
  result.sigma_rad = 1.0 / std::sqrt(determinant);
  return result;
}

const TrackPoint* FrameGeometry::find(TrackId track) const {
  const auto found =
      std::lower_bound(points.begin(), points.end(), track,
                       [](const TrackPoint& point, TrackId wanted) { return point.track < wanted; });
  return found != points.end() && found->track == track ? &*found : nullptr;
}

std::optional<TrackPoint> pointOfRays(TrackId track, const std::vector<BodyRay>& rays) {
  // Normal equations of the point next to all rays, weighted for equal angles in a second round.
  Vec3 point_B = Vec3::Zero();
  for (int round = 0; round < 2; ++round) {
    Mat3 normal = Mat3::Zero();
    Vec3 right = Vec3::Zero();
    for (const BodyRay& ray : rays) {
      const double distance_m = round == 0 ? 1.0 : (point_B - ray.origin_B).norm();
      const Mat3 across = (Mat3::Identity() - ray.bearing_B * ray.bearing_B.transpose()) /
                          std::pow(ray.sigma_rad * distance_m, 2);
      normal += across;
      right += across * ray.origin_B;
    }
    const Eigen::LDLT<Mat3> solver(normal);
    if (solver.info() != Eigen::Success || solver.rcond() < 1e-12) return std::nullopt;
    point_B = solver.solve(right);
    if (!point_B.allFinite()) return std::nullopt;
  }
  std::vector<SightLine> lines;
  for (const BodyRay& ray : rays) {
    if ((point_B - ray.origin_B).dot(ray.bearing_B) <= 0.0) return std::nullopt;
    lines.push_back({ray.origin_B, ray.sigma_rad});
  }
  const double distance_m = (point_B - rays.front().origin_B).norm();
  const double sigma_m = distanceSigma_m(rays.front().origin_B, point_B, lines);
  if (!(kLeastParallax_sigmas * sigma_m < distance_m)) return std::nullopt;
  return trackPoint(track, point_B, distance_m, sigma_m);
}

FrameGeometry frameGeometry(const Estimator& estimator,
                            const std::vector<std::shared_ptr<const Camera>>& cameras,
                            const FrameTracks& tracks) {
  const Window& window = estimator.window();
  const FactorBuilder factors(estimator.rig(), estimator.options());
  FrameGeometry geometry;
  geometry.cameras = cameras;
  geometry.states = cameraStates(window);
  const Frame& newest = window.newest();
  const Rigid3 body_from_world = newest.worldFromBody().inverse();
  for (int camera = 0; camera < factors.cameraCount(); ++camera)
    geometry.body_from_cameras.push_back(body_from_world * factors.worldFromCamera(window, newest, camera));

  const auto& observations = tracks.observations;
  for (size_t first = 0, end = 0; first < observations.size(); first = end) {
    const TrackId id = observations[first].track;
    std::vector<BodyRay> rays;
    for (end = first; end < observations.size() && observations[end].track == id; ++end) {
      const FeatureObservation& seen = observations[end];
      if (const auto ray = geometry.rayOf(seen.camera, seen.pixel, seen.sigma_px)) rays.push_back(*ray);
    }
    auto point = landmarkOf(window, factors, id);
    if (!point && rays.size() > 1) point = pointOfRays(id, rays);
    if (point) geometry.points.push_back(*point);
  }
  return geometry;
}

}  // namespace lodeline
