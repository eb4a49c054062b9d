#include "lodeline/output/survey/cave/cave_text.h"

#include <fmt/format.h>

#include "lodeline/diagnostics.h"
#include "lodeline/output/survey/formats/survey_text.h"
#include "lodeline/util/angles.h"

namespace lodeline::cave_text {

std::string legs(const CaveSurvey& cave, const Positions& positions, size_t dive, bool connections,
                 const std::string& indent) {
  using survey_text::rounded;
  std::string text;
  for (const CaveLegs& part : cave.legs) {
    if (part.dive != dive || part.is_connection != connections) continue;
    for (size_t i = 1; i < part.stations.size(); ++i) {
      const size_t from = part.stations[i - 1], to = part.stations[i];
      // Adding zero turns -0 into 0.
      const Vec3 leg = rounded(rounded(positions[to]) - rounded(positions[from])).array() + 0.0;
      text += fmt::format("{}{} {} {:.4f} {:.4f} {:.4f}\n", indent, cave.stations[from].number,
                          cave.stations[to].number, leg.x(), leg.y(), leg.z());
    }
  }
  return text;
}

bool hasLegs(const CaveSurvey& cave, size_t dive, bool connections) {
  for (const CaveLegs& part : cave.legs) {
    if (part.dive == dive && part.is_connection == connections && part.stations.size() > 1) return true;
  }
  return false;
}

std::string declinationNote(const DiveMap& dive) {
  if (!dive.place || dive.date.empty()) return "declination: not known without a place and a date";
  try {
    const double year = decimalYear(dive.date);
    const double declination_rad =
        fieldElements(worldMagneticField(dive.place->origin(), year).field_ENU).declination_rad;
    return fmt::format("declination: {:.2f} deg at the entrance on {} ({})", declination_rad / kDegree,
                       dive.date, magneticModelName(year));
  } catch (const InputError& error) {
    return fmt::format("declination: not known, {}", error.what());
  }
}

std::string comments(const CaveSurvey& cave, const char* mark) {
  std::string text = fmt::format("{} {}\n", mark, cave.title);
  for (const std::string& note : cave.notes) text += fmt::format("{} {}\n", mark, note);
  for (const std::string& note : cave.dives.front().notes) {
    for (const char* kind : {"north:", "place:", "grid:", "datum:", "heights:", "survey programs:"}) {
      if (note.starts_with(kind)) text += fmt::format("{} {}\n", mark, note);
    }
  }
  return text;
}

std::string passages(const CaveSurvey& cave, size_t dive, const std::string& header,
                     const std::string& indent) {
  std::string text;
  for (const CaveLegs& part : cave.legs) {
    bool is_open = false;
    for (size_t i = 0; i < part.stations.size() && part.dive == dive && !part.is_connection; ++i) {
      const CaveStation& station = cave.stations[part.stations[i]];
      const PassageSize& size = station.station.passage;
      if (size.isComplete()) {
        if (!is_open) text += header;
        text += fmt::format("{}{} {:.2f} {:.2f} {:.2f} {:.2f}\n", indent, station.number, *size.left,
                            *size.right, *size.up, *size.down);
      }
      is_open = size.isComplete();
    }
  }
  return text;
}

std::string statedText(const CaveControl& control) {
  if (!control.stated_ENU) return "position not stated";
  const Vec3& at = *control.stated_ENU;
  const Vec3& sigma = control.sigma_ENU;
  return fmt::format(
      "stated {:.2f} {:.2f} {:.2f} m east, north, up of the origin, one sigma {:.2f} {:.2f} {:.2f} m; the "
      "solution is off by {:.2f} m",
      at.x(), at.y(), at.z(), sigma.x(), sigma.y(), sigma.z(), (control.position_ENU - at).norm());
}

}  // namespace lodeline::cave_text
