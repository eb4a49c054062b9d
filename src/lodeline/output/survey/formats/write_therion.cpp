#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <sstream>

#include "lodeline/output/survey/formats/survey_text.h"
#include "lodeline/output/survey/formats/write_formats.h"

namespace lodeline {
namespace {

using namespace survey_text;

/// Georeference of the map on a grid that Therion supports: the map's own grid, else the UTM zone of the
/// entrance.
std::optional<Georeference> therionPlace(const DiveMap& map) {
  if (!map.place || map.place->gridDescription().therion_name) return map.place;
  return Georeference(map.place->origin(), MapGrid("auto", map.place->origin()));
}

/// Positions for Therion, as offsets from the first station. Therion rotates them by the convergence at the
/// fixed station, so grid differences are rotated in the opposite direction.
class Offsets {
 public:
  explicit Offsets(const DiveMap& map)
      : place_(therionPlace(map)), first_ENU_(map.survey.stations.front().position_ENU) {}

  Vec3 operator()(const Vec3& point_ENU) const {
    if (!place_) return point_ENU - first_ENU_;
    return turnedClockwise(place_->grid(point_ENU) - rounded(place_->grid(first_ENU_)),
                           place_->convergence_rad());
  }

 private:
  std::optional<Georeference> place_;
  Vec3 first_ENU_;
};

/// The line that fixes the position of a dive's first station.
std::string fixLine(const DiveMap& map, const std::optional<Georeference>& place) {
  if (!place) return fmt::format("  fix 0@{} {}\n", map.name, localStart(map));
  const Vec3 first = rounded(place->grid(map.survey.stations.front().position_ENU));
  return fmt::format("  fix 0@{} {:.4f} {:.4f} {:.4f} {:g} {:g} {:g}\n", map.name, first.x(), first.y(),
                     first.z(), map.place_sigma.x(), map.place_sigma.y(), map.place_sigma.z());
}

/// "cs UTM17", or empty for a map without a georeference.
std::string csLine(const std::optional<Georeference>& place, const char* indent) {
  return place ? fmt::format("{}cs {}\n", indent, place->gridDescription().therion_name.value()) : "";
}

/// Date of the survey. Therion 6.1 warns of dates after 2024, where its declination model ends, even if it
/// needs no declination.
std::string dateText(const DiveMap& map) {
  if (map.date.empty()) return "";
  if (map.date < "2025") return fmt::format("    date {}\n", dotted(map.date));
  return fmt::format("    # date {}  (Therion 6.1 warns of dates after 2024)\n", dotted(map.date));
}

/// A person's name for Therion: one or two words, or more with a slash before the surname.
std::string therionPerson(std::string name) {
  std::replace(name.begin(), name.end(), '/', ' ');
  std::istringstream stream(name);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  std::string person;
  for (size_t i = 0; i < words.size(); ++i) {
    const bool is_surname = words.size() > 2 && i + 1 == words.size();
    person += (i == 0 ? "" : is_surname ? "/" : " ") + words[i];
  }
  return person;
}

std::string therionSplays(const DiveMap& map, const Offsets& fromFirst) {
  std::string text;
  for (size_t i = 0; i < map.survey.stations.size(); ++i) {
    const SurveyStation& station = map.survey.stations[i];
    const Vec3 origin = fromFirst(station.position_ENU);
    for (const Vec3& target : station.splays_ENU) text += splay(i, ".", fromFirst(target) - origin, "    ");
  }
  if (text.empty()) return "";
  return "\n    # To the walls, from points of the map.\n    data normal from to tape compass clino\n"
         "    declination 0 degrees\n    flags splay\n" +
         text + "    flags not splay\n";
}

std::string dimensionsText(const Survey& survey) {
  std::string text;
  for (size_t i = 0; i < survey.stations.size(); ++i) {
    const PassageSize& size = survey.stations[i].passage;
    if (!size.isComplete()) continue;
    text +=
        fmt::format("    {} {:.2f} {:.2f} {:.2f} {:.2f}\n", i, *size.left, *size.right, *size.up, *size.down);
  }
  if (text.empty()) return "";
  return "\n    # Distances to the walls: median of the points of the map within 30 degrees of each "
         "direction.\n"
         "    data dimensions station left right up down\n" +
         text;
}

}  // namespace

std::string therionText(const DiveMap& map) {
  const Survey& survey = map.survey;
  const Offsets fromFirst(map);
  std::vector<Vec3> positions;
  for (const SurveyStation& station : survey.stations) positions.push_back(fromFirst(station.position_ENU));
  std::string text = fmt::format("encoding utf-8\n# {}\n", map.title) + comments(map, "#");
  text += fmt::format("\nsurvey {} -title {}\n  centreline\n", map.name, quoted(map.title)) + dateText(map);
  for (const std::string& name : map.team) text += fmt::format("    team {}\n", quoted(therionPerson(name)));
  text += "    station 0 \"entrance\" entrance\n";
  const Vec3& sigma = survey.leg_sigma_ENU;
  text += fmt::format(
      "\n    # Differences against the north named above; Therion turns them by the convergence of the "
      "meridians.\n"
      "    declination 0 degrees\n    data cartesian from to dx dy dz\n"
      "    sd dx {:.4f} metres\n    sd dy {:.4f} metres\n    sd dz {:.4f} metres\n",
      sigma.x(), sigma.y(), sigma.z());
  text += legs(positions, "    ");
  if (survey.is_closed) text += fmt::format("    equate 0 {}\n", survey.legs());
  text += therionSplays(map, fromFirst) + dimensionsText(survey);
  return text + "  endcentreline\nendsurvey\n";
}

std::string therionFix(const DiveMap& map) {
  const std::optional<Georeference> place = therionPlace(map);
  return fmt::format(
      "encoding utf-8\n# Where the first station of {0} lies. A project of several dives that begin at one "
      "place\n"
      "# inputs this file for one of them and equates the others.\ncentreline\n{1}{2}endcentreline\n",
      map.name, csLine(place, "  "), fixLine(map, place));
}

std::string therionProject(const std::vector<DiveMap>& maps, const std::string& name,
                           const std::string& title) {
  std::string text = fmt::format("encoding utf-8\nsurvey {} -title {}\n", name, quoted(title));
  std::string equates;
  std::set<std::string> equated;
  for (const auto& [first, second] : equalStarts(maps)) {
    equates += fmt::format("  equate 0@{} 0@{}\n", first, second);
    equated.insert(second);
  }
  for (const DiveMap& map : maps) {
    text += fmt::format("  input {}.th\n", map.name);
    if (!equated.contains(map.name)) text += fmt::format("  input {}_fix.th\n", map.name);
  }
  if (!equates.empty()) text += "  centreline\n" + equates + "  endcentreline\n";
  return text + "endsurvey\n";
}

std::string therionConfig(const DiveMap& map, const std::string& name,
                          const std::vector<std::string>& sources) {
  std::string text = "encoding utf-8\n";
  for (const std::string& source : sources) text += fmt::format("source {}\n", source);
  const std::optional<Georeference> place = therionPlace(map);
  text += csLine(place, "");
  if (place) text += fmt::format("export model -fmt kml -o {}_therion.kml\n", name);
  return text + fmt::format("export model -o {0}.lox\nexport survey-list -o {0}_surveys.html\n", name);
}

}  // namespace lodeline
