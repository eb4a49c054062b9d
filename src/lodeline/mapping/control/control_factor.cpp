#include "lodeline/mapping/control/control_factor.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace lodeline {
namespace {

/// Tolerance at the ends of a dive, within which the first or last keyframe represents the visit.
constexpr double kEdge_s = 2.0;

struct Neighbours {
  const VisitedKeyframe* before;
  const VisitedKeyframe* after;
};

std::optional<Neighbours> neighboursOf(Time time, std::span<const VisitedKeyframe> keyframes,
                                       double longest_gap_s) {
  const auto after =
      std::lower_bound(keyframes.begin(), keyframes.end(), time,
                       [](const VisitedKeyframe& keyframe, Time t) { return keyframe.time < t; });
  const VisitedKeyframe& next = after != keyframes.end() ? *after : keyframes.back();
  const VisitedKeyframe& last = after != keyframes.begin() ? *(after - 1) : keyframes.front();
  if (&next == &last)
    return std::abs((next.time - time).seconds()) <= kEdge_s ? std::optional(Neighbours{&last, &next})
                                                             : std::nullopt;
  if ((next.time - last.time).seconds() > longest_gap_s) return std::nullopt;
  return Neighbours{&last, &next};
}

/// Position of the rig at the time of a visit, in the body frame of the nearer keyframe.
ControlFactor factorAt(Time time, const Neighbours& near, const VisitOptions& options) {
  const VisitedKeyframe &before = *near.before, &after = *near.after;
  const double span_s = (after.time - before.time).seconds();
  const double share = span_s > 0.0 ? std::clamp((time - before.time).seconds() / span_s, 0.0, 1.0) : 0.0;
  const VisitedKeyframe& nearer = share <= 0.5 ? before : after;
  const Vec3 way = after.odom_from_body.translation - before.odom_from_body.translation;
  const Vec3 position = before.odom_from_body.translation + share * way;
  ControlFactor factor;
  factor.keyframe = nearer.id;
  factor.in_body.position = nearer.odom_from_body.inverse() * position;
  const double odometry_m = options.odometry_share * std::min(share, 1.0 - share) * way.norm();
  factor.in_body.covariance =
      (options.reach_m * options.reach_m + odometry_m * odometry_m) * Mat3::Identity();
  return factor;
}

}  // namespace

void VisitOptions::check() const {
  if (!(reach_m > 0.0 && longest_gap_s > 0.0 && odometry_share > 0.0))
    throw UsageError("the options of visits of control points must be positive");
}

std::vector<ControlFactor> factorsOfVisits(const ControlSet& control, const std::string& dive, Time start,
                                           std::span<const VisitedKeyframe> keyframes,
                                           const VisitOptions& options) {
  options.check();
  std::vector<ControlFactor> factors;
  for (const ControlVisit& visit : control.visits) {
    if (!visit.dive.empty() && visit.dive != dive) continue;
    const ControlPoint* point = control.find(visit.point);
    const Time time = visit.stamp ? *visit.stamp : start + visit.since_start.value_or(Duration());
    std::optional<Neighbours> near;
    if (!keyframes.empty()) near = neighboursOf(time, keyframes, options.longest_gap_s);
    if (!near) {
      throw InputError(
          fmt::format("{}: the dive {} has no keyframes around the visit of '{}', {:.1f} s after its "
                      "start",
                      visit.origin, dive, visit.point, (time - start).seconds()));
    }
    ControlFactor factor = factorAt(time, *near, options);
    factor.name = visit.point;
    if (point != nullptr) {
      factor.kind = point->kind;
      factor.in_map = point->position;
    }
    factors.push_back(std::move(factor));
  }
  return factors;
}

std::vector<ControlFactor> controlFactorsOf(const MapFile& map) {
  std::map<int64_t, ControlPoint> points;
  for (ControlPoint& point : map.controlPoints()) points.emplace(point.id, std::move(point));
  std::vector<ControlFactor> factors;
  for (const ControlObservation& observation : map.controlObservations()) {
    const ControlPoint& point = points.at(observation.point);
    factors.push_back({point.name, point.kind, observation.keyframe, observation.in_body, point.position});
  }
  return factors;
}

void addControl(const ControlSet& control, std::span<const ControlFactor> factors, MapChange* change) {
  std::map<std::string, int64_t> ids;
  for (const ControlPoint& point : control.points) ids[point.name] = change->putControlPoint(point);
  for (const ControlFactor& factor : factors) {
    const auto id = ids.find(factor.name);
    if (id == ids.end()) throw InputError(fmt::format("there is no control point '{}'", factor.name));
    change->addControlObservation({id->second, factor.keyframe, factor.in_body});
  }
}

}  // namespace lodeline
