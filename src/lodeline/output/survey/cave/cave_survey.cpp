#include "lodeline/output/survey/cave/cave_survey.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "lodeline/diagnostics.h"
#include "lodeline/output/survey/map/survey_name.h"

namespace lodeline {
namespace {

/// Makes stations of the branches of paths.
class SurveyMaker {
 public:
  SurveyMaker(const CavePaths& paths, const CaveSurveyOptions& options, CaveSurvey* cave)
      : paths_(paths), options_(options), cave_(*cave), next_number_(cave->dives.size(), 0) {}

  void make() {
    for (const CavePathBranch& branch : paths_.branches) {
      for (const std::optional<size_t>& at : {branch.begins_at, branch.ends_at}) {
        if (at) junctions_.insert(*at);
      }
      if (branch.is_connection) junctions_.insert(branch.first);
    }
    for (const CavePathBranch& branch : paths_.branches) addBranch(branch);
    for (const CavePathBranch& branch : paths_.branches) closeBranch(branch);
  }

 private:
  size_t addStation(size_t point, size_t dive) {
    CaveStation made;
    made.dive = dive;
    made.number = next_number_[dive]++;
    const DiveMap& map = cave_.dives[paths_.points[point].dive];
    const StampedPose& pose = map.trajectory.poses[paths_.points[point].pose];
    made.station.time = pose.time;
    made.station.position_ENU = paths_.points[point].position;
    made.sigma_ENU = sigmaAt(map, pose.time);
    cave_.stations.push_back(made);
    return cave_.stations.size() - 1;
  }

  static Vec3 sigmaAt(const DiveMap& map, Time time) {
    const auto at = std::lower_bound(map.uncertainties.begin(), map.uncertainties.end(), time,
                                     [](const PositionUncertainty& u, Time t) { return u.time < t; });
    if (at == map.uncertainties.end()) return Vec3::Zero();
    return at->covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  }

  /// Points of a branch that become stations: its junctions, and those that chooseStations() takes between.
  std::vector<size_t> stationPoints(const CavePathBranch& branch) const {
    std::vector<size_t> fixed = {branch.first};
    for (size_t at : junctions_) {
      if (at > branch.first && at < branch.last) fixed.push_back(at);
    }
    if (branch.last > branch.first) fixed.push_back(branch.last);
    std::vector<size_t> chosen = {fixed.front()};
    for (size_t i = 1; i < fixed.size(); ++i) {
      for (size_t between : between_(fixed[i - 1], fixed[i])) chosen.push_back(between);
      chosen.push_back(fixed[i]);
    }
    return chosen;
  }

  std::vector<size_t> between_(size_t first, size_t last) const {
    std::vector<Vec3> positions;
    for (size_t k = first; k <= last; ++k) positions.push_back(paths_.points[k].position);
    if (positions.size() < 3 || (positions.front() - positions.back()).norm() < 1e-2) return {};
    std::vector<size_t> inner = chooseStations(positions, options_.stations);
    std::vector<size_t> points;
    for (size_t i = 1; i + 1 < inner.size(); ++i) points.push_back(first + inner[i]);
    return points;
  }

  void addBranch(const CavePathBranch& branch) {
    const size_t dive = paths_.points[branch.first].dive;
    CaveLegs legs;
    legs.dive = dive;
    legs.is_connection = branch.is_connection;
    if (branch.is_connection) {
      legs.stations.push_back(station_of_point_.at(branch.first));
    } else {
      for (size_t point : stationPoints(branch)) {
        legs.stations.push_back(addStation(point, dive));
        station_of_point_[point] = legs.stations.back();
      }
    }
    cave_.legs.push_back(legs);
  }

  /// The station of a junction in the survey of a dive: the same, or an equal one of that dive.
  size_t junctionIn(size_t dive, size_t point) {
    const size_t station = station_of_point_.at(point);
    if (cave_.stations[station].dive == dive) return station;
    const auto known = equal_.find({dive, point});
    if (known != equal_.end()) return known->second;
    const size_t equal = addStation(point, dive);
    cave_.equates.push_back({station, equal});
    equal_[{dive, point}] = equal;
    return equal;
  }

  /// Joins the ends of a branch to its junctions.
  void closeBranch(const CavePathBranch& branch) {
    CaveLegs& legs = cave_.legs[static_cast<size_t>(&branch - paths_.branches.data())];
    if (branch.begins_at)
      legs.stations.insert(legs.stations.begin(), junctionIn(legs.dive, *branch.begins_at));
    if (branch.ends_at) legs.stations.push_back(junctionIn(legs.dive, *branch.ends_at));
    noteEnds(branch, legs);
  }

  void noteEnds(const CavePathBranch& branch, const CaveLegs& legs) {
    if (branch.is_connection) return;
    CaveStation& first = cave_.stations[legs.stations.front()];
    CaveStation& last = cave_.stations[legs.stations.back()];
    if (branch.begins_at) addNote("junction", &first);
    addNote(branch.ends_at ? "junction" : "end of the way in: turning point, or end of the dive", &last);
  }

  static void addNote(const std::string& note, CaveStation* station) {
    if (std::find(station->notes.begin(), station->notes.end(), note) == station->notes.end())
      station->notes.push_back(note);
  }

  const CavePaths& paths_;
  const CaveSurveyOptions& options_;
  CaveSurvey& cave_;
  std::vector<size_t> next_number_;
  std::set<size_t> junctions_;
  std::map<size_t, size_t> station_of_point_;
  std::map<std::pair<size_t, size_t>, size_t> equal_;
};

void measureWalls(const CaveSurveyOptions& options, CaveSurvey* cave) {
  std::vector<Vec3> walls;
  for (const DiveMap& dive : cave->dives) {
    walls.insert(walls.end(), dive.echoes_ENU.begin(), dive.echoes_ENU.end());
    for (const MapLandmark& landmark : dive.landmarks) {
      if (landmark.observations >= options.min_observations) walls.push_back(landmark.position);
    }
  }
  for (const CaveLegs& legs : cave->legs) {
    if (legs.is_connection || legs.stations.size() < 2) continue;
    Survey line;
    for (size_t station : legs.stations) line.stations.push_back(cave->stations[station].station);
    measurePassage(walls, options.passage, &line);
    for (size_t i = 0; i < legs.stations.size(); ++i) {
      SurveyStation& station = cave->stations[legs.stations[i]].station;
      if (!station.passage.isComplete() && station.splays_ENU.empty()) station = line.stations[i];
    }
  }
}

size_t nearestStation(const CaveSurvey& cave, const Vec3& position_ENU) {
  size_t nearest = 0;
  for (size_t i = 1; i < cave.stations.size(); ++i) {
    if ((cave.positionOf(i) - position_ENU).norm() < (cave.positionOf(nearest) - position_ENU).norm())
      nearest = i;
  }
  return nearest;
}

/// Marks the station at which each dive began.
void markEntrances(const CaveSurveyOptions& options, CaveSurvey* cave) {
  for (const DiveMap& dive : cave->dives) {
    const Vec3 start = dive.trajectory.poses.front().world_from_body.translation;
    const size_t station = nearestStation(*cave, start);
    const double reach_m = std::max(options.paths.merge_m, options.stations.spacing_m);
    if ((cave->positionOf(station) - start).norm() <= reach_m) cave->stations[station].is_entrance = true;
  }
}

/// Notes on both stations of each leg that was swum without usable images.
void noteBlindTimes(const CaveSurveyOptions& options, CaveSurvey* cave) {
  for (const BlindTime& blind : options.blind) {
    for (const CaveLegs& legs : cave->legs) {
      for (size_t i = 1; i < legs.stations.size() && legs.dive == blind.dive; ++i) {
        CaveStation& a = cave->stations[legs.stations[i - 1]];
        CaveStation& b = cave->stations[legs.stations[i]];
        const Time begin = std::min(a.station.time, b.station.time);
        const Time end = std::max(a.station.time, b.station.time);
        if (blind.begin > end || begin > blind.end) continue;
        const std::string note =
            fmt::format("blind: {:.1f} s without usable images", (blind.end - blind.begin).seconds());
        for (CaveStation* station : {&a, &b}) station->notes.push_back(note);
      }
    }
  }
}

void addControl(const std::vector<CaveControl>& control, CaveSurvey* cave) {
  std::set<std::string> labels;
  for (const CaveControl& point : control) {
    std::string label = "c_" + surveyName(point.name);
    while (!labels.insert(label).second) label += "_";
    cave->control.push_back({point, nearestStation(*cave, point.position_ENU), label});
  }
}

void setNotes(CaveSurvey* cave) {
  cave->notes.push_back(fmt::format("cave: {} dives, {} stations, {:.2f} m of passages", cave->dives.size(),
                                    cave->stations.size(), cave->length_m()));
  cave->notes.push_back(
      "adjusted: all positions are those of the common solution of all dives; loops close without an error");
  for (const CaveLegs& legs : cave->legs) {
    if (legs.is_connection)
      cave->notes.push_back(
          fmt::format("not met: dive {} meets no other; a leg by the common solution joins it",
                      cave->dives[legs.dive].name));
  }
  // Independent loops of a connected net: legs - places + 1.
  size_t count = 0;
  for (const CaveLegs& legs : cave->legs) count += legs.stations.size() - 1;
  cave->notes.push_back(fmt::format("loops: {}", count + 1 + cave->equates.size() - cave->stations.size()));
}

}  // namespace

double CaveSurvey::length_m() const {
  double length = 0.0;
  for (const CaveLegs& part : legs) {
    for (size_t i = 1; i < part.stations.size() && !part.is_connection; ++i)
      length += (positionOf(part.stations[i]) - positionOf(part.stations[i - 1])).norm();
  }
  return length;
}

CaveSurvey makeCaveSurvey(std::vector<DiveMap> dives, const std::vector<CaveControl>& control,
                          const CaveSurveyOptions& options, Diagnostics* diagnostics) {
  CaveSurvey cave;
  cave.name = surveyName(options.name);
  cave.title = options.title.empty() ? cave.name : options.title;
  cave.dives = std::move(dives);
  std::vector<std::vector<Vec3>> positions;
  for (const DiveMap& dive : cave.dives) {
    positions.emplace_back();
    for (const StampedPose& pose : dive.trajectory.poses)
      positions.back().push_back(pose.world_from_body.translation);
  }
  const CavePaths paths = splitPaths(positions, options.paths);
  SurveyMaker(paths, options, &cave).make();
  for (size_t dive : paths.apart) {
    diagnostics->report(Severity::Warning, "dive_apart",
                        fmt::format("{} comes nowhere within {:g} m of an earlier dive; a leg by the common "
                                    "solution joins it",
                                    cave.dives[dive].name, options.paths.merge_m));
  }
  markEntrances(options, &cave);
  noteBlindTimes(options, &cave);
  measureWalls(options, &cave);
  addControl(control, &cave);
  setNotes(&cave);
  return cave;
}

}  // namespace lodeline
