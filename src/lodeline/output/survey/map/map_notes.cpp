#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lodeline/output/survey/map/dive_map.h"
#include "lodeline/output/survey/map/loop_candidates.h"
#include "lodeline/util/angles.h"

namespace lodeline {
namespace {

/// "29.8300000 N" or "82.6000000 W".
std::string angleText(double angle_deg, const char* positive, const char* negative) {
  return fmt::format("{:.7f} {}", std::abs(angle_deg), angle_deg < 0.0 ? negative : positive);
}

std::string placeNote(const DiveMap& map) {
  if (!map.place) {
    return fmt::format("place: none given; metres from the first station, which is {:.2f} m under water ({})",
                       map.start_depth_m, map.start_depth_source);
  }
  const GeodeticPosition& origin = map.place->origin();
  return fmt::format("place: first station {}, {} (WGS 84), height {:.2f} m, {:.2f} m under water ({})",
                     angleText(origin.latitude_deg, "N", "S"), angleText(origin.longitude_deg, "E", "W"),
                     origin.height_m, map.start_depth_m, map.start_depth_source);
}

std::string gridNote(const Georeference& place) {
  const MapGridDescription& grid = place.gridDescription();
  return fmt::format(
      "grid: {} ({}, {}; unit {}); convergence {:.4f} deg, scale {:.6f} at the first station, both applied",
      grid.name, grid.title, grid.code, grid.unit, place.convergence_rad() / kDegree, place.scale());
}

std::string heightNote(const DiveMap& map) {
  const VerticalDatum& heights = map.heights;
  const std::string level =
      heights.name.empty()
          ? "the level that the height of the entrance counts from (--vertical-datum states it)"
          : heights.name;
  return fmt::format("heights: in metres above {}; {}", level,
                     heights.geoid_height_m
                         ? fmt::format("it lies {:.2f} m above the WGS 84 ellipsoid", *heights.geoid_height_m)
                         : "its height above the WGS 84 ellipsoid is unknown");
}

/// Notes on the transformation from WGS 84 to the datum of the grid, and its name in files for survey
/// programs.
void addDatumNotes(const MapGridDescription& grid, std::vector<std::string>* notes) {
  if (grid.accuracy_m != 0.0) {
    notes->push_back(fmt::format("datum: from WGS 84 by {} (PROJ), accuracy {}", grid.operation,
                                 grid.accuracy_m ? fmt::format("{:g} m", *grid.accuracy_m) : "unknown"));
  }
  if (grid.counts_west_and_south) {
    notes->push_back(fmt::format(
        "axes: {} counts to the west and south; coordinates are minus its westing and minus its southing, "
        "which count to the east and north as programs expect{}",
        grid.code, grid.turned_code.empty() ? "" : fmt::format(" ({})", grid.turned_code)));
  }
  if (grid.metres_per_unit != 1.0) {
    notes->push_back(fmt::format(
        "survey programs: Survex counts in metres, so its file has this grid in metres ({}); 1 {} is "
        "{:.10g} m",
        grid.survex_name, grid.unit, grid.metres_per_unit));
  }
  if (!grid.therion_name) {
    notes->push_back(
        "survey programs: Therion cannot use this grid, so its file has the UTM zone of the entrance");
  }
}

std::string sigmaNote(const Survey& survey) {
  const Vec3 end = survey.leg_sigma_ENU * std::sqrt(static_cast<double>(survey.legs()));
  return fmt::format(
      "uncertainty of the end (one sigma): {:.3f} m east, {:.3f} m north, {:.3f} m up, {:.2f} % of the "
      "length; each leg's is this by the root of {}",
      end.x(), end.y(), end.z(), 100.0 * end.norm() / survey.length_m(), survey.legs());
}

std::string closureNote(const Survey& survey) {
  const Misclosure closure = misclosure(survey);
  const Vec3& d = closure.end_from_start_ENU;
  const std::string distance =
      fmt::format("{:.2f} m ({:.2f} m horizontal, {:+.2f} m vertical)", d.norm(), d.head<2>().norm(), d.z());
  if (survey.is_closed) {
    return fmt::format("misclosure: {}, {:.2f} % of the length; the last station is the first one again",
                       distance, closure.percent());
  }
  if (!closure.horizontal_between_ways_m) {
    return fmt::format("end from start: {}; the dive did not come back, so there is no misclosure", distance);
  }
  return fmt::format(
      "end from start: {}, {:.2f} % of the length: the misclosure if the dive ended where it began "
      "(--closed); way back from way out: median {:.2f} m horizontal, {:.2f} m vertical",
      distance, closure.percent(), *closure.horizontal_between_ways_m, *closure.vertical_between_ways_m);
}

/// Notes on the longest loop candidates; people have to confirm them.
void addLoopNotes(const Survey& survey, std::vector<std::string>* notes) {
  constexpr size_t kMostListed = 5;
  const std::vector<LoopCandidate> loops = findLoopCandidates(survey);
  if (loops.empty()) return;
  notes->push_back(fmt::format(
      "candidate loops: {} where the line comes back to itself within its uncertainty; nothing is "
      "equated",
      loops.size()));
  for (size_t i = 0; i < std::min(kMostListed, loops.size()); ++i) {
    const LoopCandidate& loop = loops[i];
    const Vec3& d = loop.misclosure_ENU;
    notes->push_back(fmt::format(
        "candidate loop: stations {} to {} come back; station {} to leg {}-{}: misclosure {:.2f} m ({:.2f} m "
        "horizontal, {:+.2f} m vertical), {:.2f} % of {:.1f} m, one sigma {:.2f} m; median of all {:.2f} m",
        loop.first, loop.last, loop.station, loop.leg, loop.leg + 1, d.norm(), d.head<2>().norm(), d.z(),
        loop.percent(), loop.length_m, loop.sigma_ENU.norm(), loop.median_misclosure_m));
  }
}

}  // namespace

std::vector<std::string> describe(const DiveMap& map, const RunFolder& run) {
  std::vector<std::string> notes;
  notes.push_back(fmt::format(
      "source: {}, {} of run '{}'{}, {} poses", run.program.empty() ? "lodeline" : run.program,
      run.trajectory_file, run.folder.filename().string(),
      run.recording.empty() ? "" : fmt::format(" on recording '{}'", run.recording), map.trajectory.size()));
  notes.push_back(fmt::format("date: {}", map.date.empty() ? "unknown" : map.date));
  notes.push_back("north: " + map.north.text);
  if (run.heading_sigma_rad) {
    notes.push_back(
        fmt::format("heading: {:.2f} deg (one sigma, at the end)", *run.heading_sigma_rad / kDegree));
  }
  notes.push_back(placeNote(map));
  if (map.place) {
    notes.push_back(gridNote(*map.place));
    addDatumNotes(map.place->gridDescription(), &notes);
    notes.push_back(heightNote(map));
  }
  notes.push_back(
      fmt::format("line: {} stations, {:.2f} m", map.survey.stations.size(), map.survey.length_m()));
  notes.push_back(sigmaNote(map.survey));
  notes.push_back(closureNote(map.survey));
  addLoopNotes(map.survey, &notes);
  return notes;
}

}  // namespace lodeline
