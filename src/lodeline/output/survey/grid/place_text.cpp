#include "lodeline/output/survey/grid/place_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <regex>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/output/survey/grid/angle_text.h"
#include "lodeline/output/survey/grid/crs_position.h"
#include "lodeline/util/csv_fields.h"

namespace lodeline {
namespace {

constexpr const char* kWanted =
    "a place is wanted, LAT,LON,HEIGHT, as 29.83,-82.60,10 or \"20°19'12\"N 87°23'24\"W 5\" or \"16Q 450000 "
    "2246000 5\" or "
    "\"EPSG:6372 3912345 912345 5\": latitude and longitude, or easting and northing, then the height in m";

[[noreturn]] void refuse(const std::string& text, const std::string& option, const std::string& why) {
  throw UsageError(fmt::format("{} {}: {}", option, text, why));
}

/// Numbers between blanks, commas and semicolons; "m" and "ft" after the third one are its unit, which
/// becomes metres. Empty for anything else.
std::vector<double> plainNumbers(const std::string& text) {
  std::vector<double> numbers;
  static const std::regex kWord(R"(([^\s,;]+))"), kUnit("(m|ft|feet)", std::regex::icase);
  static const std::regex kWithUnit("(.*[0-9.])(m|ft|feet)", std::regex::icase);
  for (std::sregex_iterator it(text.begin(), text.end(), kWord), end; it != end; ++it) {
    std::string word = (*it)[1], unit;
    std::smatch parts;
    if (numbers.size() == 3 && std::regex_match(word, kUnit)) {
      unit = word;
      word.clear();
    } else if (numbers.size() == 2 && std::regex_match(word, parts, kWithUnit)) {
      unit = parts[2];
      word = parts[1].str();
    }
    double number = 0.0;
    if (!word.empty()) {
      if (!csv::parse(word, &number) || !std::isfinite(number)) return {};
      numbers.push_back(number);
    }
    if (!unit.empty() && std::tolower(static_cast<unsigned char>(unit.front())) == 'f')
      numbers.back() *= kMetresPerFoot;
  }
  return numbers.size() == 2 || numbers.size() == 3 ? numbers : std::vector<double>();
}

StatedPlace onGrid(const std::string& code, const std::string& numbers_text, const std::string& text,
                   const std::string& option) {
  const std::vector<double> numbers = plainNumbers(numbers_text);
  if (numbers.empty())
    refuse(
        text, option,
        fmt::format("two or three numbers are wanted after {}: its coordinates, and the height in m", code));
  StatedPlace place;
  try {
    place.position = positionOnCrs(code, {numbers[0], numbers[1]});
  } catch (const UsageError& error) {
    refuse(text, option, error.what());
  }
  place.has_height = numbers.size() == 3;
  if (place.has_height) place.position.height_m = numbers[2];
  place.grid = code;
  return place;
}

/// Letter of the band of 8 degrees of latitude of the Military Grid Reference System.
char bandAt(double latitude_deg) {
  const int index = static_cast<int>(std::floor((latitude_deg + 80.0) / 8.0));
  return std::string("CDEFGHJKLMNPQRSTUVWX")[static_cast<size_t>(std::clamp(index, 0, 19))];
}

StatedPlace onUtm(int zone, std::string letters, const std::string& numbers_text, const std::string& text,
                  const std::string& option) {
  for (char& c : letters) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  const char letter = letters.front();
  const std::vector<double> numbers = plainNumbers(numbers_text);
  // Northings of the band from 32 to 40 degrees north; in the south, they are those of 53 to 58 degrees.
  constexpr double kBandBegin_m = 3.5e6, kBandEnd_m = 4.45e6;
  if (letters == "S" && !numbers.empty() && numbers[1] > kBandBegin_m && numbers[1] < kBandEnd_m) {
    refuse(text, option,
           fmt::format("S may be the southern hemisphere or the band from 32 to 40 degrees north: write "
                       "{0} south or {0} north",
                       zone));
  }
  if (letters.size() == 1 && std::string("CDEFGHJKLMNPQRSTUVWX").find(letter) == std::string::npos)
    refuse(text, option, fmt::format("{} is no band of a UTM zone", letter));
  if (zone < 1 || zone > 60) refuse(text, option, "zones of UTM count from 1 to 60");
  const bool is_word = letters.size() > 1 || letter == 'N' || letter == 'S';
  const bool is_north = letter >= 'N' && letter != 'S' && letters != "SOUTH";
  const bool north = is_word ? letter == 'N' : is_north || letter == 'S';
  StatedPlace place =
      onGrid(fmt::format("EPSG:{}{:02d}", north ? 326 : 327, zone), numbers_text, text, option);
  if (!is_word && bandAt(place.position.latitude_deg) != letter) {
    refuse(text, option,
           fmt::format("these coordinates lie at latitude {:.3f} in band {}, not {}",
                       place.position.latitude_deg, bandAt(place.position.latitude_deg), letter));
  }
  return place;
}

StatedPlace parse(const std::string& text, const std::string& option) {
  std::smatch parts;
  static const std::regex kCode(R"(\s*((?:EPSG|ESRI|OGC|IAU_?\d*):\w+)[\s,;]+(.*))", std::regex::icase);
  if (std::regex_match(text, parts, kCode)) return onGrid(parts[1], parts[2], text, option);
  static const std::regex kUtm(R"(\s*(?:UTM)?\s*(\d{1,2})\s*(north|south|[A-Z])[\s,;]+(\d.*))",
                               std::regex::icase);
  if (std::regex_match(text, parts, kUtm)) {
    const std::vector<double> numbers = plainNumbers(parts[3]);
    if (!numbers.empty() && std::abs(numbers[0]) > 1000.0)
      return onUtm(std::stoi(parts[1]), parts[2], parts[3], text, option);
  }
  StatedPlace place;
  std::optional<double> height_m;
  const std::vector<double> numbers = plainNumbers(text);
  if (!numbers.empty()) {
    place.position = {numbers[0], numbers[1], 0.0};
    if (numbers.size() == 3) height_m = numbers[2];
  } else {
    const std::optional<AnglePair> angles = parseAngles(text);
    if (!angles) refuse(text, option, kWanted);
    place.position = {angles->latitude_deg, angles->longitude_deg, 0.0};
    height_m = angles->height_m;
  }
  place.has_height = height_m.has_value();
  place.position.height_m = height_m.value_or(0.0);
  return place;
}

}  // namespace

StatedPlace parsePlace(const std::string& text, const std::string& option) {
  StatedPlace place = parse(text, option);
  place.text = text;
  return place;
}

}  // namespace lodeline
