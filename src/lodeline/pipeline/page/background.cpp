#include "lodeline/pipeline/page/background.h"

#include <fmt/format.h>

#include <GeographicLib/LocalCartesian.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <optional>
#include <sstream>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/output/report/data/base64.h"
#include "lodeline/output/report/page/table_json.h"
#include "lodeline/types.h"
#include "lodeline/util/angles.h"

namespace lodeline {
namespace {

namespace fs = std::filesystem;

constexpr uintmax_t kMostImageBytes = 12'000'000;

std::string readFile(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw InputError(file.string() + ": cannot be opened");
  std::stringstream text;
  text << stream.rdbuf();
  return text.str();
}

std::vector<double> numbersOf(const std::string& text, char separator) {
  std::vector<double> numbers;
  std::istringstream stream(text);
  for (std::string word; std::getline(stream, word, separator);) {
    size_t end = 0;
    try {
      numbers.push_back(std::stod(word, &end));
    } catch (const std::exception&) {
      return {};
    }
    if (word.find_first_not_of(" \r\t", end) != std::string::npos || !std::isfinite(numbers.back()))
      return {};
  }
  return numbers;
}

/// From the coordinates of a file to metres from the first pose on the page.
class Placement {
 public:
  Placement(const std::string& at, bool is_geographic) {
    const std::vector<double> numbers = numbersOf(at, ',');
    if (is_geographic) {
      if (numbers.size() != 2 || std::abs(numbers[0]) > 90.0 || std::abs(numbers[1]) > 360.0)
        throw UsageError(
            fmt::format("--background-at '{}': the file is in longitudes and latitudes, so LAT,LON of the "
                        "first pose is wanted, in degrees",
                        at));
      plane_.emplace(numbers[0], numbers[1], 0.0);
      return;
    }
    if (numbers.size() != 2 && numbers.size() != 3)
      throw UsageError(
          fmt::format("--background-at '{}': E,N or E,N,TURN of the first pose is wanted, in metres of the "
                      "file's grid and degrees",
                      at));
    origin_ = {numbers[0], numbers[1]};
    if (numbers.size() == 3) turn_rad_ = numbers[2] * kDegree;
  }

  Vec2 point(double x, double y) const {
    if (plane_) {
      double east = 0.0, north = 0.0, up = 0.0;
      plane_->Forward(y, x, 0.0, east, north, up);
      return {east, north};
    }
    return direction(Vec2(x, y) - origin_);
  }
  /// A clockwise turn.
  Vec2 direction(const Vec2& d) const {
    const double c = std::cos(turn_rad_), s = std::sin(turn_rad_);
    return {c * d.x() + s * d.y(), -s * d.x() + c * d.y()};
  }

 private:
  std::optional<GeographicLib::LocalCartesian> plane_;
  Vec2 origin_ = Vec2::Zero();
  double turn_rad_ = 0.0;
};

using Line = std::vector<Vec2>;

/// One position of a GeoJSON file.
Vec2 positionOf(const nlohmann::json& json) { return {json.at(0).get<double>(), json.at(1).get<double>()}; }

Line lineOf(const nlohmann::json& positions) {
  Line line;
  for (const auto& position : positions) line.push_back(positionOf(position));
  return line;
}

/// Lines and the edges of areas of a geometry, a feature or a collection of them.
void collectLines(const nlohmann::json& json, std::vector<Line>* lines) {
  if (!json.is_object()) return;
  const std::string type = json.value("type", "");
  for (const char* members : {"features", "geometries"}) {
    if (json.contains(members))
      for (const auto& member : json.at(members)) collectLines(member, lines);
  }
  if (type == "Feature") return collectLines(json.at("geometry"), lines);
  if (!json.contains("coordinates")) return;
  const auto& coordinates = json.at("coordinates");
  if (type == "LineString") lines->push_back(lineOf(coordinates));
  if (type == "MultiLineString" || type == "Polygon")
    for (const auto& line : coordinates) lines->push_back(lineOf(line));
  if (type == "MultiPolygon")
    for (const auto& area : coordinates)
      for (const auto& line : area) lines->push_back(lineOf(line));
}

bool isGeographic(const std::vector<Line>& lines) {
  for (const Line& line : lines) {
    for (const Vec2& p : line) {
      if (std::abs(p.x()) > 360.0 || std::abs(p.y()) > 90.0) return false;
    }
  }
  return true;
}

nlohmann::ordered_json linesJson(const fs::path& file, const std::string& at) {
  std::vector<Line> lines;
  try {
    collectLines(nlohmann::json::parse(readFile(file)), &lines);
  } catch (const nlohmann::json::exception& error) {
    throw InputError(fmt::format("{}: no GeoJSON ({})", file.string(), error.what()));
  }
  if (lines.empty()) throw InputError(file.string() + ": has no lines and no areas");
  const Placement placement(at, isGeographic(lines));
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const Line& line : lines) {
    nlohmann::ordered_json points = nlohmann::ordered_json::array();
    for (const Vec2& p : line) {
      const Vec2 placed = placement.point(p.x(), p.y());
      points.push_back({shortNumber(placed.x()), shortNumber(placed.y())});
    }
    json.push_back(std::move(points));
  }
  return json;
}

/// Six numbers: x of a column, y of a column, x of a row, y of a row, x and y of the first pixel's middle.
std::array<double, 6> readWorldFile(const fs::path& image) {
  const std::string ending = image.extension().string();
  const std::vector<std::string> endings = {ending.substr(0, 2) + ending.back() + "w", ending + "w", ".wld"};
  for (const std::string& candidate : endings) {
    const fs::path file = fs::path(image).replace_extension(candidate);
    if (!fs::exists(file)) continue;
    std::string text = readFile(file);
    text.erase(text.find_last_not_of(" \r\n\t") + 1);
    const std::vector<double> numbers = numbersOf(text, '\n');
    if (numbers.size() != 6) throw InputError(file.string() + ": six lines with a number each are wanted");
    if (std::abs(numbers[0] * numbers[3] - numbers[1] * numbers[2]) < 1e-12)
      throw InputError(file.string() + ": pixels have no area");
    return {numbers[0], numbers[1], numbers[2], numbers[3], numbers[4], numbers[5]};
  }
  throw InputError(
      fmt::format("{}: no world file beside it ({}); `gdal_translate -co WORLDFILE=YES` writes one",
                  image.string(), fmt::join(endings, ", ")));
}

nlohmann::ordered_json imageJson(const fs::path& file, const std::string& type, const std::string& at) {
  const std::array<double, 6> world = readWorldFile(file);
  const std::string bytes = readFile(file);
  if (bytes.size() > kMostImageBytes) {
    throw InputError(
        fmt::format("{}: {:.0f} MB; at most {:.0f} MB fit on a page; `gdal_translate -outsize 25% 25% -co "
                    "WORLDFILE=YES` writes a smaller one",
                    file.string(), 1e-6 * static_cast<double>(bytes.size()), 1e-6 * kMostImageBytes));
  }
  const Placement placement(at, false);
  const Vec2 column = placement.direction({world[0], world[1]}),
             row = placement.direction({world[2], world[3]});
  const Vec2 first = placement.point(world[4], world[5]);
  return {{"type", type},
          {"data", base64({reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size()})},
          {"column_m", {column.x(), column.y()}},
          {"row_m", {row.x(), row.y()}},
          {"first_m", {first.x(), first.y()}}};
}

}  // namespace

nlohmann::ordered_json readBackground(const fs::path& file, const std::string& at) {
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  nlohmann::ordered_json json = {
      {"name", file.filename().string()}, {"lines", nlohmann::ordered_json::array()}, {"image", nullptr}};
  if (ending == ".png") {
    json["image"] = imageJson(file, "image/png", at);
  } else if (ending == ".jpg" || ending == ".jpeg") {
    json["image"] = imageJson(file, "image/jpeg", at);
  } else if (ending == ".geojson" || ending == ".json") {
    json["lines"] = linesJson(file, at);
  } else {
    throw UsageError(
        fmt::format("--background {}: a PNG or JPEG image with a world file, or a GeoJSON file is wanted",
                    file.string()));
  }
  return json;
}

}  // namespace lodeline
