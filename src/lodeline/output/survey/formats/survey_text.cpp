#include "lodeline/output/survey/formats/survey_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lodeline/output/survey/formats/write_formats.h"
#include "lodeline/util/angles.h"

namespace lodeline::survey_text {

Vec3 rounded(const Vec3& position) {
  return position.unaryExpr([](double x) { return std::round(x * 1e4) * 1e-4; });
}

std::string legs(const std::vector<Vec3>& positions, const std::string& indent) {
  std::string text;
  for (size_t i = 1; i < positions.size(); ++i) {
    // Adding zero turns -0 into 0.
    const Vec3 leg = rounded(rounded(positions[i]) - rounded(positions[i - 1])).array() + 0.0;
    text += fmt::format("{}{} {} {:.4f} {:.4f} {:.4f}\n", indent, i - 1, i, leg.x(), leg.y(), leg.z());
  }
  return text;
}

std::string splay(size_t station, const char* target, const Vec3& vector, const std::string& indent) {
  const double length_m = vector.norm();
  if (length_m < 1e-3) return "";
  const double clino_deg = std::asin(std::clamp(vector.z() / length_m, -1.0, 1.0)) / kDegree;
  double bearing_deg = std::round(std::atan2(vector.x(), vector.y()) / kDegree * 100.0) * 0.01;
  if (bearing_deg < 0.0) bearing_deg += 360.0;
  return fmt::format("{}{} {} {:.3f} {:.2f} {:.2f}\n", indent, station, target, length_m,
                     bearing_deg < 359.995 ? bearing_deg + 0.0 : 0.0, clino_deg);
}

std::string comments(const DiveMap& map, const char* mark) {
  std::string text;
  for (const std::string& note : map.notes) text += fmt::format("{} {}\n", mark, note);
  return text;
}

std::string dotted(std::string date) {
  std::replace(date.begin(), date.end(), '-', '.');
  return date;
}

std::string quoted(std::string text) {
  std::replace(text.begin(), text.end(), '"', '\'');
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < ' '; }, ' ');
  return '"' + text + '"';
}

std::string localStart(const DiveMap& map) {
  const Vec3 first_ENU = map.survey.stations.front().position_ENU - map.start_depth_m * Vec3::UnitZ();
  const auto text = [](double value) { return value == 0.0 ? "0" : fmt::format("{:.4f}", value); };
  return fmt::format("{} {} {:.4f}", text(first_ENU.x()), text(first_ENU.y()), first_ENU.z() + 0.0);
}

}  // namespace lodeline::survey_text

namespace lodeline {

std::vector<std::pair<std::string, std::string>> equalStarts(const std::vector<DiveMap>& maps) {
  constexpr double kSame_m = 1e-3;
  const auto start = [](const DiveMap& map) {
    const Vec3 first_ENU = map.survey.stations.front().position_ENU;
    return map.place ? map.place->grid(first_ENU) : Vec3(first_ENU - map.start_depth_m * Vec3::UnitZ());
  };
  std::vector<std::pair<std::string, std::string>> pairs;
  for (size_t i = 1; i < maps.size(); ++i) {
    const auto earlier =
        std::find_if(maps.begin(), maps.begin() + static_cast<std::ptrdiff_t>(i), [&](const DiveMap& map) {
          return map.place.has_value() == maps[i].place.has_value() &&
                 (start(map) - start(maps[i])).norm() < kSame_m;
        });
    if (earlier != maps.begin() + static_cast<std::ptrdiff_t>(i))
      pairs.emplace_back(earlier->name, maps[i].name);
  }
  return pairs;
}

}  // namespace lodeline
