#include <fmt/format.h>

#include "lodeline/output/survey/cave/cave_text.h"
#include "lodeline/output/survey/formats/survey_text.h"
#include "lodeline/output/survey/formats/therion_text.h"

namespace lodeline {
namespace {

using namespace survey_text;
using namespace therion_text;

std::string therionName(const CaveSurvey& cave, size_t station) {
  const CaveStation& made = cave.stations[station];
  return fmt::format("{}@{}", made.number, cave.dives[made.dive].name);
}

/// Writes the parts of one dive. Positions are offsets from the fixed station.
class DiveWriter {
 public:
  DiveWriter(const CaveSurvey& cave, const Offsets& fromFirst) : cave_(cave), fromFirst_(fromFirst) {
    for (size_t i = 0; i < cave.stations.size(); ++i) positions_.push_back(fromFirst(cave.positionOf(i)));
  }

  std::string text(size_t dive) const {
    const DiveMap& map = cave_.dives[dive];
    std::string text = fmt::format("\n  survey {} -title {}\n  centreline\n    # {}\n", map.name,
                                   quoted(map.title), cave_text::declinationNote(map)) +
                       dateText(map);
    for (const std::string& name : map.team) text += fmt::format("    team {}\n", quoted(person(name)));
    text += legsText(dive) + controlText(dive) + stationsText(dive) + splaysText(dive);
    const std::string header = "    data dimensions station left right up down\n";
    return text + cave_text::passages(cave_, dive, header, "    ") + "  endcentreline\n  endsurvey\n";
  }

 private:
  std::string legsText(size_t dive) const {
    if (!cave_text::hasLegs(cave_, dive, false) && !cave_text::hasLegs(cave_, dive, true)) return "";
    const Vec3& sigma = cave_.dives[dive].survey.leg_sigma_ENU;
    std::string text = fmt::format(
        "    declination 0 degrees\n    data cartesian from to dx dy dz\n    sd dx {:.4f} metres\n"
        "    sd dy {:.4f} metres\n    sd dz {:.4f} metres\n",
        sigma.x(), sigma.y(), sigma.z());
    text += cave_text::legs(cave_, positions_, dive, false, "    ");
    const std::string lines = cave_text::legs(cave_, positions_, dive, true, "    ");
    return lines.empty() ? text : text + "    flags duplicate\n" + lines + "    flags not duplicate\n";
  }

  std::string controlText(size_t dive) const {
    std::string text;
    for (const CaveSurvey::Control& control : cave_.control) {
      const CaveStation& station = cave_.stations[control.station];
      if (station.dive != dive) continue;
      const Vec3 leg =
          rounded(rounded(fromFirst_(control.point.position_ENU)) - rounded(positions_[control.station]))
              .array() +
          0.0;
      text += fmt::format("    {} {} {:.4f} {:.4f} {:.4f}\n", station.number, control.label, leg.x(), leg.y(),
                          leg.z());
      text += fmt::format("    station {} {}\n", control.label,
                          quoted(control.point.name + ": " + cave_text::statedText(control.point)));
    }
    if (text.empty()) return "";
    return "    data cartesian from to dx dy dz\n    flags duplicate\n" + text + "    flags not duplicate\n";
  }

  std::string stationsText(size_t dive) const {
    std::string text;
    for (const CaveStation& station : cave_.stations) {
      if (station.dive != dive || (station.notes.empty() && !station.is_entrance)) continue;
      std::string note = station.is_entrance ? "a dive began here" : "";
      for (const std::string& line : station.notes) note += (note.empty() ? "" : "; ") + line;
      text += fmt::format("    station {} {}{}\n", station.number, quoted(note),
                          station.is_entrance ? " entrance" : "");
    }
    return text;
  }

  std::string splaysText(size_t dive) const {
    std::string text;
    for (size_t i = 0; i < cave_.stations.size(); ++i) {
      const CaveStation& station = cave_.stations[i];
      if (station.dive != dive) continue;
      for (const Vec3& target : station.station.splays_ENU)
        text += splay(station.number, ".", fromFirst_(target) - positions_[i], "    ");
    }
    if (text.empty()) return "";
    return "    data normal from to tape compass clino\n    declination 0 degrees\n    flags splay\n" + text +
           "    flags not splay\n";
  }

  const CaveSurvey& cave_;
  const Offsets& fromFirst_;
  cave_text::Positions positions_;
};

}  // namespace

std::string therionCave(const CaveSurvey& cave) {
  const DiveMap& map = cave.dives.front();
  const Offsets fromFirst(map, cave.positionOf(0));
  const DiveWriter writer(cave, fromFirst);
  std::string text = "encoding utf-8\n" + cave_text::comments(cave, "#") +
                     fmt::format("\nsurvey {} -title {}\n", cave.name, quoted(cave.title));
  for (size_t dive = 0; dive < cave.dives.size(); ++dive) text += writer.text(dive);
  text += "\n  centreline\n" + csLine(fromFirst.place(), "    ");
  const Vec3 first = fromFirst.fixed();
  text += fmt::format("    fix {} {:.4f} {:.4f} {:.4f} {:g} {:g} {:g}\n  endcentreline\n",
                      therionName(cave, 0), first.x(), first.y(), first.z(), map.place_sigma.x(),
                      map.place_sigma.y(), map.place_sigma.z());
  if (!cave.equates.empty()) text += "  centreline\n";
  for (const CaveEquate& equate : cave.equates)
    text +=
        fmt::format("    equate {} {}\n", therionName(cave, equate.first), therionName(cave, equate.second));
  if (!cave.equates.empty()) text += "  endcentreline\n";
  return text + "endsurvey\n";
}

}  // namespace lodeline
