#include "apps/lodeline/map/map_dives.h"

#include <fmt/format.h>

#include "lodeline/mapping/control/control_factor.h"
#include "lodeline/mapping/session/map_north.h"
#include "lodeline/mapping/session/map_points.h"
#include "lodeline/mapping/session/map_surface.h"
#include "lodeline/mapping/store/map_change.h"
#include "lodeline/version.h"

namespace lodeline {
namespace {

/// A dive of the map as a run whose world is the map: poses and covariances of the common solution.
RunFolder runOfDive(const MapFile& map, const MapDive& dive, HeadingReference north,
                    std::optional<double> depth_at_origin_m) {
  RunFolder run;
  run.folder = dive.name;
  run.trajectory_file = map.path().filename().string();
  run.program = std::string("lodeline ") + LODELINE_VERSION;
  run.recording = dive.recording;
  run.heading_reference = north;
  run.depth_at_origin_m = depth_at_origin_m;
  map.forEachKeyframe(dive.id, [&](const StoredKeyframe& row) {
    if (!row.solved) return;
    run.trajectory.poses.push_back({row.keyframe.time, row.solved->map_from_body});
    run.uncertainties.push_back({row.keyframe.time, row.solved->covariance.topLeftCorner<3, 3>()});
  });
  run.landmarks = mapPointsOf(map, dive.id);
  return run;
}

/// A dive with its keyframes in order of time.
struct VisitedDive {
  std::string name;
  std::vector<VisitedKeyframe> keyframes;

  /// Whether a stamp is within the dive, or just outside.
  bool contains(Time stamp) const {
    constexpr double kAround_s = 2.0;
    return !keyframes.empty() && (stamp - keyframes.front().time).seconds() > -kAround_s &&
           (keyframes.back().time - stamp).seconds() > -kAround_s;
  }
};

std::vector<VisitedDive> visitedDives(const MapFile& map) {
  std::vector<VisitedDive> dives;
  for (const MapDive& dive : map.dives()) {
    dives.push_back({dive.name, {}});
    map.forEachKeyframe(dive.id, [&](const StoredKeyframe& row) {
      dives.back().keyframes.push_back({row.keyframe.id, row.keyframe.time, row.keyframe.odom_from_body});
    });
  }
  return dives;
}

/// Names the dive of each visit that does not: the dive around its stamp, or the only one.
void nameDives(const std::vector<VisitedDive>& dives, std::vector<ControlVisit>* visits) {
  for (ControlVisit& visit : *visits) {
    std::vector<std::string> names;
    for (const VisitedDive& dive : dives) {
      const bool fits =
          visit.dive.empty() ? !visit.stamp || dive.contains(*visit.stamp) : dive.name == visit.dive;
      if (fits) names.push_back(dive.name);
    }
    if (names.size() != 1) {
      throw InputError(fmt::format("{}: {} of the map fits the visit of '{}'; name it in the column 'dive'",
                                   visit.origin, names.empty() ? "no dive" : "more than one dive",
                                   visit.point));
    }
    visit.dive = names.front();
  }
}

}  // namespace

std::vector<RunFolder> runsOfMap(const MapFile& map) {
  std::vector<RunFolder> runs;
  const std::optional<SurfaceHeight> surface = surfaceOf(map);
  const std::optional<double> depth_m = surface ? std::optional(surface->height_m) : std::nullopt;
  for (const MapDive& dive : map.dives()) {
    runs.push_back(runOfDive(map, dive, northOf(map), depth_m));
    if (runs.back().trajectory.poses.size() < 2) {
      throw InputError(map.path().string() + ": dive '" + dive.name +
                       "' has no solved poses; run `lodeline map solve`");
    }
  }
  if (runs.empty()) throw InputError(map.path().string() + ": the map has no dive");
  return runs;
}

ControlSet addControlFile(MapFile* map, const std::filesystem::path& file, const ControlReadOptions& options,
                          Diagnostics* diagnostics) {
  ControlSet control = readControl(file, options, diagnostics);
  const std::vector<VisitedDive> dives = visitedDives(*map);
  nameDives(dives, &control.visits);
  std::vector<ControlFactor> factors;
  for (const VisitedDive& dive : dives) {
    if (dive.keyframes.empty()) continue;
    // A time since the start counts from the first keyframe.
    const std::vector<ControlFactor> of_dive =
        factorsOfVisits(control, dive.name, dive.keyframes.front().time, dive.keyframes);
    factors.insert(factors.end(), of_dive.begin(), of_dive.end());
  }
  MapChange change = map->change();
  addControl(control, factors, &change);
  change.commit();
  return control;
}

}  // namespace lodeline
