#include <fmt/format.h>

#include <cmath>
#include <regex>
#include <set>

#include "lodeline/io/tables/cells.h"
#include "lodeline/io/tables/text_lines.h"
#include "lodeline/mapping/control/files/control_positions.h"
#include "lodeline/mapping/control/files/survex_files.h"

namespace lodeline {

SurvexSurvey readSurvexPositions(const std::filesystem::path& file) {
  static const std::regex kRow(R"(\(\s*([^,()]+),\s*([^,()]+),\s*([^,()]+)\)\s*(.*))");
  SurvexSurvey survey;
  TextLines lines(openFile(file), file.string());
  for (std::string_view line; lines.next(&line);) {
    const std::string text(trimmed(line));
    std::smatch match;
    if (text.empty() || text.find("Easting") != std::string::npos) continue;
    SurvexStation station;
    bool is_good = std::regex_match(text, match, kRow);
    for (int i = 0; is_good && i < 3; ++i) {
      const std::string cell = match[static_cast<size_t>(i) + 1].str();
      const auto number = numberFrom(trimmed(cell));
      is_good = number && std::isfinite(*number);
      if (is_good) station.position[i] = *number;
    }
    if (!is_good) {
      throw InputError(fmt::format("{}:{}: '{}' is no '( easting, northing, altitude ) station'",
                                   file.string(), lines.number(), excerpt(text)));
    }
    station.name = match[4].str();
    if (!station.name.empty()) survey.stations.push_back(station);  // else anonymous
  }
  if (survey.stations.empty())
    throw InputError(fmt::format("{}: there is no station in this file", file.string()));
  return survey;
}

ControlSet controlOf(const SurvexSurvey& survey, const std::filesystem::path& file,
                     const ControlReadOptions& options) {
  ControlSet set;
  std::set<std::string> known;
  const ControlReadOptions::Sigmas sigmas = options.sigmasOf(ControlKind::Station);
  for (const SurvexStation& station : survey.stations) {
    if (!known.insert(station.name).second) continue;  // the format permits repetitions
    ControlPoint point;
    point.name = station.name;
    point.kind = ControlKind::Station;
    point.origin = file.string();
    try {
      point.position = onMap(station.position, options, sigmas);
    } catch (const InputError& error) {
      throw InputError(fmt::format("{}: station {}: {}", file.string(), station.name, error.what()));
    }
    set.points.push_back(std::move(point));
  }
  return set;
}

}  // namespace lodeline
