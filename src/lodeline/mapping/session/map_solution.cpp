#include "lodeline/mapping/session/map_solution.h"

#include <cmath>
#include <map>
#include <numeric>
#include <optional>

#include "lodeline/geometry/so3.h"
#include "lodeline/mapping/graph/motion/level_motion.h"
#include "lodeline/mapping/session/map_north.h"
#include "lodeline/mapping/store/map_change.h"

namespace lodeline {
namespace {

/// Groups of dives that are connected with each other (union-find).
class Groups {
 public:
  int of(int dive) {
    int& parent = parent_.try_emplace(dive, dive).first->second;
    return parent == dive ? dive : parent = of(parent);
  }
  void join(int a, int b) { parent_[std::max(of(a), of(b))] = std::min(of(a), of(b)); }

 private:
  std::map<int, int> parent_;
};

/// The graph of a map with what is needed to write the result back.
struct MapGraph {
  PoseGraph graph;
  std::vector<KeyframeId> keyframes;
  std::vector<StoredLoop> loops;  ///< accepted ones, in the order of the graph's robust factors
  std::map<KeyframeId, int> dive_of;
  std::map<int, std::string> names;
  std::map<std::string, ControlPoint> points;
  Groups groups;
};

/// Pose at which a dive starts before anything is solved: as solved before, else the identity.
Rigid3 startOf(const StoredKeyframe& first) {
  if (!first.solved) return {};
  return mapFromOdom(first.solved->map_from_body, first.keyframe.odom_from_body);
}

/// Turn of the map as solved before that points its y axis to `north`, by the first dive that knows it. It is
/// not the identity where the map had a worse north, or none, before that dive came.
Rigid3 turnTo(HeadingReference north, const MapFile& map) {
  std::optional<double> turn_rad;
  for (const MapDive& dive : map.dives()) {
    if (dive.heading_reference != north) continue;
    map.forEachKeyframe(dive.id, [&](const StoredKeyframe& row) {
      if (turn_rad || !row.solved || !row.keyframe.heading_sigma_rad) return;
      const Rigid3 map_from_odom = startOf(row);
      const Quat& rotation = map_from_odom.rotation;
      turn_rad = row.keyframe.north_from_odom_rad - 2.0 * std::atan2(rotation.z(), rotation.w());
    });
  }
  return {so3::exp(turn_rad.value_or(0.0) * Vec3::UnitZ()), Vec3::Zero()};
}

void addDives(const MapFile& map, const MapSolutionOptions& options, MapGraph* result) {
  const HeadingReference north = northOf(map);
  const Rigid3 turned_from_map = turnTo(north, map);
  for (const MapDive& dive : map.dives()) {
    KeyframeFactorOptions factors = options.factors;
    factors.north_sigma_rad = northSigma_rad(north, dive.heading_reference);
    result->names[dive.id] = dive.name;
    result->groups.of(dive.id);
    const MapKeyframe* previous = nullptr;
    std::vector<StoredKeyframe> rows;
    map.forEachKeyframe(dive.id, [&](const StoredKeyframe& row) { rows.push_back(row); });
    for (const StoredKeyframe& row : rows) {
      const MapKeyframe& keyframe = row.keyframe;
      addKeyframe(keyframe, previous, &result->graph, turned_from_map * startOf(rows.front()), factors);
      result->keyframes.push_back(keyframe.id);
      result->dive_of[keyframe.id] = dive.id;
      previous = &keyframe;
    }
  }
}

void addLoops(const MapFile& map, MapGraph* result) {
  map.forEachLoop([&](const StoredLoop& row) {
    if (row.loop.status == LoopStatus::Accepted) result->loops.push_back(row);
  });
  for (const StoredLoop& row : result->loops) result->graph.add(edgeOf(row.loop));
}

void addControl(const MapFile& map, MapGraph* result) {
  std::map<int64_t, ControlPoint> points;
  for (const ControlPoint& point : map.controlPoints()) {
    points[point.id] = point;
    result->points[point.name] = point;
    GraphLandmark landmark{point.name, std::nullopt, Mat3::Identity()};
    if (point.position) {
      landmark.position_W = point.position->position;
      landmark.covariance = point.position->covariance;
    }
    result->graph.add(landmark);
  }
  for (const ControlObservation& seen : map.controlObservations()) {
    const ControlPoint& point = points.at(seen.point);
    LandmarkObservation observation;
    observation.landmark = point.name;
    observation.node = seen.keyframe;
    observation.point_B = seen.in_body.position;
    observation.covariance = seen.in_body.covariance;
    result->graph.add(observation);
  }
}

/// Joins the dives that a factor in use connects; one that the solution refused connects nothing.
/// `first_dive`: by the name of a point of unknown position, the dive that saw it first.
void joinDives(const FactorReport& factor, MapGraph* graph, std::map<std::string, int>* first_dive) {
  // All points of known position are in one frame, which joins their dives as well.
  constexpr int kFrame = -1;
  if (!factor.accepted) return;
  const int dive = graph->dive_of.at(factor.from);
  if (factor.kind == FactorReport::Kind::Loop) return graph->groups.join(dive, graph->dive_of.at(factor.to));
  const auto point = graph->points.find(factor.name);
  const bool is_known = point == graph->points.end() || point->second.position.has_value();
  graph->groups.join(dive, is_known ? kFrame : first_dive->try_emplace(factor.name, dive).first->second);
}

std::vector<std::string> unconnectedDives(MapGraph* graph) {
  std::vector<std::string> names;
  const int first = graph->names.begin()->first;
  for (const auto& [dive, name] : graph->names) {
    if (graph->groups.of(dive) != graph->groups.of(first)) names.push_back(name);
  }
  return names;
}

}  // namespace

MapSolution solveMap(MapFile* map, const MapSolutionOptions& options) {
  MapGraph graph{PoseGraph(options.graph), {}, {}, {}, {}, {}, {}};
  addDives(*map, options, &graph);
  MapSolution solution;
  if (graph.keyframes.empty()) return solution;
  addLoops(*map, &graph);
  addControl(*map, &graph);
  constexpr double kSteps = 4.0;  // reading, solution, covariance, writing
  options.progress(1.0 / kSteps);
  const GraphSummary summary = graph.graph.solve();
  options.progress(2.0 / kSteps);
  const GraphCovariance covariance = graph.graph.covariance();
  options.progress(3.0 / kSteps);
  MapChange change = map->change();
  for (const KeyframeId id : graph.keyframes)
    change.setSolution(id, {graph.graph.pose(id), covariance.of(id)});
  size_t next_loop = 0;
  std::map<std::string, int> first_dive;
  for (const FactorReport& factor : summary.factors) {
    joinDives(factor, &graph, &first_dive);
    if (factor.kind == FactorReport::Kind::Loop) {
      StoredLoop& row = graph.loops[next_loop++];
      if (factor.accepted) continue;
      row.loop.status = LoopStatus::Refused;
      row.loop.reason = factor.reason;
      change.updateLoop(row);
      ++solution.refused_loops;
    } else {
      const Vec3 residual = factor.residual.head<3>();
      solution.control.push_back({factor.name, graph.names.at(graph.dive_of.at(factor.from)), residual,
                                  factor.chi_squared, factor.accepted, factor.reason});
    }
  }
  change.commit();
  options.progress(1.0);
  solution.converged = summary.converged;
  solution.dives = static_cast<int>(graph.names.size());
  solution.keyframes = static_cast<int>(graph.keyframes.size());
  solution.loops = static_cast<int>(graph.loops.size()) - solution.refused_loops;
  solution.unconnected = unconnectedDives(&graph);
  return solution;
}

}  // namespace lodeline
