#include "lodeline/estimator/sonar/local_surface.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace lodeline {
namespace {

struct Candidate {
  LocalSurface::Member member;
  BeamPoint point;
};

/// Tukey's biweight: 1 at the beam, 0 at the edge of the cone, smooth in between.
double weightAt(double tangent, double edge_tangent) {
  const double share = tangent / edge_tangent;
  return std::pow(1.0 - share * share, 2);
}

std::vector<Candidate> landmarksAbout(const SonarBeam& beam, const Rigid3& world_from_body,
                                      const Window& window, const FactorBuilder& factors, double edge_tangent,
                                      const LandmarkChoice& isChosen) {
  std::map<FrameId, Rigid3> beam_from_host;
  const Rigid3 beam_from_world =
      Rigid3(Quat(beam.axes_B), beam.origin_B).inverse() * world_from_body.inverse();
  std::vector<Candidate> candidates;
  for (const auto& [id, track] : window.tracks()) {
    if (!track.landmark || !isChosen(track)) continue;
    const Landmark& landmark = *track.landmark;
    auto host = beam_from_host.find(landmark.host);
    if (host == beam_from_host.end()) {
      const Rigid3 world_from_camera = factors.worldFromCamera(window, *window.find(landmark.host), 0);
      host = beam_from_host.emplace(landmark.host, beam_from_world * world_from_camera).first;
    }
    const double rho = landmark.inverseDistance();
    const Vec3 q = host->second.rotation * landmark.base.direction(landmark.parameters.data()) +
                   rho * host->second.translation;
    if (!(q[0] > 0.0) || !(rho > 1.0 / SonarRangeFactor::kFarthest_m)) continue;
    const BeamPoint point{q[1] / q[0], q[2] / q[0], rho / q[0], 1.0};
    const double tangent = std::hypot(point.across_1, point.across_2);
    if (!(tangent < edge_tangent)) continue;
    candidates.push_back({{id, weightAt(tangent, edge_tangent)}, point});
    candidates.back().point.weight = candidates.back().member.weight;
  }
  return candidates;
}

/// Keeps the candidates with the largest weights, in their order.
void keepNearest(size_t count, std::vector<Candidate>* candidates) {
  if (candidates->size() <= count) return;
  std::vector<double> weights;
  for (const Candidate& candidate : *candidates) weights.push_back(candidate.member.weight);
  std::nth_element(weights.begin(), weights.begin() + static_cast<std::ptrdiff_t>(count), weights.end(),
                   std::greater<>());
  const double limit = weights[count];
  std::erase_if(*candidates, [&](const Candidate& candidate) { return candidate.member.weight <= limit; });
}

}  // namespace

std::optional<LocalSurface> surfaceAlong(const SonarBeam& beam, const Rigid3& world_from_body,
                                         const Window& window, const FactorBuilder& factors,
                                         const SonarOptions& options, const LandmarkChoice& isChosen) {
  std::vector<Candidate> candidates =
      landmarksAbout(beam, world_from_body, window, factors, std::tan(options.surface_angle_rad), isChosen);
  keepNearest(static_cast<size_t>(options.max_landmarks), &candidates);
  if (candidates.size() < static_cast<size_t>(options.min_landmarks)) return std::nullopt;
  LocalSurface result;
  std::vector<BeamPoint> points;
  for (const Candidate& candidate : candidates) {
    result.members.push_back(candidate.member);
    points.push_back(candidate.point);
  }
  const BeamSurface surface(std::move(points));
  const double inverse = surface.inverseDistance_per_m(), leverage = surface.leverage();
  if (!(inverse > 1.0 / SonarRangeFactor::kFarthest_m) || !(leverage < options.max_leverage))
    return std::nullopt;
  result.range_m = 1.0 / inverse;
  // The wall at the beam deviates from the plane as each landmark does.
  const double scatter_m =
      surface.scatter_per_m() * result.range_m * result.range_m * std::sqrt(1.0 + leverage);
  result.sigma_m = std::hypot(scatter_m, options.roughness * result.range_m);
  if (!std::isfinite(result.sigma_m)) return std::nullopt;
  return result;
}

}  // namespace lodeline
