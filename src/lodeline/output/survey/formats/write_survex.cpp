#include <fmt/format.h>

#include "lodeline/output/survey/formats/survey_text.h"
#include "lodeline/output/survey/formats/write_formats.h"

namespace lodeline {
namespace {

using namespace survey_text;

std::string survexFix(const DiveMap& map) {
  if (!map.place) return fmt::format("*fix 0 {}\n", localStart(map));
  const std::string& grid = map.place->gridDescription().survex_name;
  const Vec3 first = rounded(map.place->grid(map.survey.stations.front().position_ENU));
  return fmt::format("*cs {0}\n*cs out {0}\n*fix 0 {1:.4f} {2:.4f} {3:.4f} {4:g} {5:g} {6:g}\n", grid,
                     first.x(), first.y(), first.z(), map.place_sigma.x(), map.place_sigma.y(),
                     map.place_sigma.z());
}

/// Position of a station for cavern: on the grid, or metres from the first station.
Vec3 onGrid(const DiveMap& map, const Vec3& point_ENU) {
  return map.place ? map.place->grid(point_ENU) : point_ENU;
}

std::string survexSplays(const DiveMap& map) {
  std::string text;
  for (size_t i = 0; i < map.survey.stations.size(); ++i) {
    const SurveyStation& station = map.survey.stations[i];
    const Vec3 origin = onGrid(map, station.position_ENU);
    for (const Vec3& target : station.splays_ENU) text += splay(i, "..", onGrid(map, target) - origin, "");
  }
  if (text.empty()) return "";
  return "\n; To the walls, from points of the map. Bearings are grid bearings.\n"
         "*data normal from to tape compass clino\n*declination 0 degrees\n*flags splay\n" +
         text + "*flags not splay\n";
}

/// Consecutive stations with known passage sizes form one tube; a station without a size ends it.
std::string passageText(const Survey& survey) {
  std::string text;
  bool is_open = false;
  for (size_t i = 0; i < survey.stations.size(); ++i) {
    const PassageSize& size = survey.stations[i].passage;
    if (size.isComplete()) {
      if (!is_open) text += "*data passage station left right up down\n";
      text +=
          fmt::format("{} {:.2f} {:.2f} {:.2f} {:.2f}\n", i, *size.left, *size.right, *size.up, *size.down);
    }
    is_open = size.isComplete();
  }
  if (text.empty()) return "";
  return "\n; Distances to the walls: median of the points of the map within 30 degrees of each "
         "direction.\n" +
         text;
}

}  // namespace

std::string survexText(const DiveMap& map) {
  const Survey& survey = map.survey;
  std::vector<Vec3> positions;
  for (const SurveyStation& station : survey.stations) positions.push_back(onGrid(map, station.position_ENU));
  std::string text = fmt::format("; {}\n", map.title) + comments(map, ";");
  text += fmt::format("\n*begin {}\n*title {}\n", map.name, quoted(map.title));
  if (!map.date.empty()) text += fmt::format("*date {}\n", dotted(map.date));
  for (const std::string& name : map.team) text += fmt::format("*team {}\n", quoted(name));
  text += survexFix(map) + "*entrance 0\n";
  const Vec3& sigma = survey.leg_sigma_ENU;
  text += fmt::format(
      "\n; Differences are those of this very grid: for another one, export anew with --crs.\n*data "
      "cartesian from to dx dy dz\n"
      "*sd dx {:.4f} metres\n*sd dy {:.4f} metres\n*sd dz {:.4f} metres\n",
      sigma.x(), sigma.y(), sigma.z());
  text += legs(positions, "");
  if (survey.is_closed) text += fmt::format("*equate 0 {}\n", survey.legs());
  text += survexSplays(map) + passageText(survey);
  return text + fmt::format("*end {}\n", map.name);
}

std::string survexProject(const std::vector<DiveMap>& maps, const std::string& title) {
  std::string text = fmt::format("; {}: several dives on one grid\n", title);
  for (const DiveMap& map : maps) text += fmt::format("*include {}\n", map.name);
  for (const auto& [first, second] : equalStarts(maps))
    text += fmt::format("*equate {}.0 {}.0\n", first, second);
  return text;
}

}  // namespace lodeline
