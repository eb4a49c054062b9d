#include <fmt/format.h>

#include "lodeline/output/survey/cave/cave_text.h"
#include "lodeline/output/survey/formats/survey_text.h"

namespace lodeline {
namespace {

using namespace survey_text;

Vec3 onGrid(const CaveSurvey& cave, const Vec3& point_ENU) {
  const DiveMap& map = cave.dives.front();
  if (map.place) return map.place->grid(point_ENU);
  return point_ENU - map.start_depth_m * Vec3::UnitZ();
}

cave_text::Positions onGrid(const CaveSurvey& cave) {
  cave_text::Positions positions;
  for (size_t i = 0; i < cave.stations.size(); ++i) positions.push_back(onGrid(cave, cave.positionOf(i)));
  return positions;
}

std::string survexName(const CaveSurvey& cave, size_t station) {
  const CaveStation& made = cave.stations[station];
  return fmt::format("{}.{}", cave.dives[made.dive].name, made.number);
}

std::string sds(const Vec3& sigma) {
  return fmt::format("*sd dx {:.4f} metres\n*sd dy {:.4f} metres\n*sd dz {:.4f} metres\n", sigma.x(),
                     sigma.y(), sigma.z());
}

std::string splays(const CaveSurvey& cave, const cave_text::Positions& positions, size_t dive) {
  std::string text;
  for (size_t i = 0; i < cave.stations.size(); ++i) {
    const CaveStation& station = cave.stations[i];
    if (station.dive != dive) continue;
    for (const Vec3& target : station.station.splays_ENU)
      text += splay(station.number, "..", onGrid(cave, target) - positions[i], "");
  }
  if (text.empty()) return "";
  return "*data normal from to tape compass clino\n*declination 0 degrees\n*flags splay\n" + text +
         "*flags not splay\n";
}

std::string controlLegs(const CaveSurvey& cave, const cave_text::Positions& positions, size_t dive) {
  std::string text;
  for (const CaveSurvey::Control& control : cave.control) {
    const CaveStation& station = cave.stations[control.station];
    if (station.dive != dive) continue;
    const Vec3 leg =
        rounded(rounded(onGrid(cave, control.point.position_ENU)) - rounded(positions[control.station]))
            .array() +
        0.0;
    text += fmt::format("; {}: {}\n{} {} {:.4f} {:.4f} {:.4f}\n", control.point.name,
                        cave_text::statedText(control.point), station.number, control.label, leg.x(), leg.y(),
                        leg.z());
  }
  if (text.empty()) return "";
  return "*data cartesian from to dx dy dz\n*flags duplicate\n" + text + "*flags not duplicate\n";
}

std::string diveText(const CaveSurvey& cave, const cave_text::Positions& positions, size_t dive) {
  const DiveMap& map = cave.dives[dive];
  std::string text = fmt::format("\n*begin {}\n*title {}\n; {}\n", map.name, quoted(map.title),
                                 cave_text::declinationNote(map));
  if (!map.date.empty()) text += fmt::format("*date {}\n", dotted(map.date));
  for (const std::string& name : map.team) text += fmt::format("*team {}\n", quoted(name));
  if (cave_text::hasLegs(cave, dive, false) || cave_text::hasLegs(cave, dive, true))
    text += "*data cartesian from to dx dy dz\n" + sds(map.survey.leg_sigma_ENU);
  text += cave_text::legs(cave, positions, dive, false, "");
  if (cave_text::hasLegs(cave, dive, true)) {
    text +=
        "*flags duplicate\n" + cave_text::legs(cave, positions, dive, true, "") + "*flags not duplicate\n";
  }
  for (const CaveStation& station : cave.stations) {
    for (size_t i = 0; i < station.notes.size() && station.dive == dive; ++i)
      text += fmt::format("; station {}: {}\n", station.number, station.notes[i]);
  }
  text += controlLegs(cave, positions, dive) + splays(cave, positions, dive);
  text += cave_text::passages(cave, dive, "*data passage station left right up down\n", "");
  return text + fmt::format("*end {}\n", map.name);
}

std::string fixes(const CaveSurvey& cave, const cave_text::Positions& positions) {
  const DiveMap& map = cave.dives.front();
  const Vec3 first = rounded(positions.front());
  std::string text;
  if (map.place) text += fmt::format("*cs {0}\n*cs out {0}\n", map.place->gridDescription().survex_name);
  text += fmt::format("*fix {} {:.4f} {:.4f} {:.4f} {:g} {:g} {:g}\n", survexName(cave, 0), first.x(),
                      first.y(), first.z(), map.place_sigma.x(), map.place_sigma.y(), map.place_sigma.z());
  for (const CaveSurvey::Control& control : cave.control) {
    if (!control.point.stated_ENU) continue;
    const Vec3 at = rounded(onGrid(cave, control.point.position_ENU));
    const Vec3 sigma = control.point.sigma_ENU.cwiseMax(1e-3);
    text += fmt::format("*fix {}.{} {:.4f} {:.4f} {:.4f} {:g} {:g} {:g}\n",
                        cave.dives[cave.stations[control.station].dive].name, control.label, at.x(), at.y(),
                        at.z(), sigma.x(), sigma.y(), sigma.z());
  }
  for (size_t i = 0; i < cave.stations.size(); ++i) {
    if (cave.stations[i].is_entrance) text += fmt::format("*entrance {}\n", survexName(cave, i));
  }
  return text;
}

}  // namespace

std::string survexCave(const CaveSurvey& cave) {
  const cave_text::Positions positions = onGrid(cave);
  std::string text = cave_text::comments(cave, ";");
  text += fmt::format("\n*begin {}\n*title {}\n", cave.name, quoted(cave.title)) + fixes(cave, positions);
  for (size_t dive = 0; dive < cave.dives.size(); ++dive) text += diveText(cave, positions, dive);
  for (const CaveEquate& equate : cave.equates)
    text += fmt::format("*equate {} {}\n", survexName(cave, equate.first), survexName(cave, equate.second));
  return text + fmt::format("*end {}\n", cave.name);
}

}  // namespace lodeline
