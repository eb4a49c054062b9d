#include "lodeline/output/survey/formats/map_files.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "lodeline/diagnostics.h"
#include "lodeline/util/choice.h"
#include "lodeline/util/files/output_file.h"

namespace lodeline {
namespace {

bool needsPlace(MapFormat format) {
  return format == MapFormat::GeoJson || format == MapFormat::Kml || format == MapFormat::Gpx;
}

std::vector<std::string> colmapTexts(const DiveMap& map, const std::optional<MapImages>& images) {
  if (!images || images->cameras.empty()) {
    throw UsageError("--format colmap needs the cameras: name the recording with --recording DATA");
  }
  const ColmapModel model = colmapModel(map, images->cameras, images->images);
  return {model.cameras, model.images, model.points3D};
}

/// In the order of mapFileNames().
std::vector<std::string> contents(const DiveMap& map, const std::optional<MapImages>& images,
                                  MapFormat format) {
  switch (format) {
    case MapFormat::Survex:
      return {survexText(map)};
    case MapFormat::Therion:
      return {therionText(map), therionFix(map),
              therionConfig(map, map.name, {map.name + ".th", map.name + "_fix.th"})};
    case MapFormat::GeoJson:
      return {geojsonText(map)};
    case MapFormat::Kml:
      return {kmlText(map)};
    case MapFormat::Gpx:
      return {gpxText(map)};
    case MapFormat::Ply:
      return {plyBytes(map)};
    case MapFormat::Csv:
      return {stationsCsv(map), posesCsv(map)};
    case MapFormat::Tum:
      return {tumText(map)};
    case MapFormat::Colmap:
      return colmapTexts(map, images);
    case MapFormat::GeoPackage:
      return {geopackageBytes(map)};
    case MapFormat::Dxf:
      return {dxfText(map)};
  }
  return {};
}

std::vector<std::filesystem::path> writeFiles(const std::filesystem::path& folder,
                                              const std::vector<std::string>& names,
                                              const std::vector<std::string>& texts) {
  std::vector<std::filesystem::path> files;
  for (size_t i = 0; i < names.size(); ++i) {
    files.push_back(folder / names[i]);
    createOutputFolder(files.back().parent_path());
    writeOutput(files.back(), texts[i]);
  }
  return files;
}

}  // namespace

const std::vector<std::string>& mapFormatNames() {
  static const std::vector<std::string> names = {"survex", "therion", "geojson", "kml",  "gpx", "ply",
                                                 "csv",    "tum",     "colmap",  "gpkg", "dxf"};
  return names;
}

MapFormat mapFormatFromString(const std::string& name) {
  return static_cast<MapFormat>(chooseByName("--format", name, mapFormatNames()));
}

std::vector<std::string> mapFileNames(const std::string& name, MapFormat format) {
  switch (format) {
    case MapFormat::Survex:
      return {name + ".svx"};
    case MapFormat::Therion:
      return {name + ".th", name + "_fix.th", name + ".thconfig"};
    case MapFormat::GeoJson:
      return {name + ".geojson"};
    case MapFormat::Kml:
      return {name + ".kml"};
    case MapFormat::Gpx:
      return {name + ".gpx"};
    case MapFormat::Ply:
      return {name + ".ply"};
    case MapFormat::Csv:
      return {name + "_stations.csv", name + "_poses.csv"};
    case MapFormat::Tum:
      return {name + ".tum"};
    case MapFormat::Colmap:
      return {"colmap/cameras.txt", "colmap/images.txt", "colmap/points3D.txt"};
    case MapFormat::GeoPackage:
      return {name + ".gpkg"};
    case MapFormat::Dxf:
      return {name + ".dxf"};
  }
  return {};
}

std::vector<std::filesystem::path> writeMap(const DiveMap& map, const std::optional<MapImages>& images,
                                            MapFormat format, const std::filesystem::path& folder) {
  if (needsPlace(format) && !map.place) {
    throw UsageError(fmt::format("--format {} needs a place on the Earth: give --entrance LAT,LON,HEIGHT",
                                 mapFormatNames()[static_cast<size_t>(format)]));
  }
  return writeFiles(folder, mapFileNames(map.name, format), contents(map, images, format));
}

bool joinsDives(MapFormat format) { return format == MapFormat::Survex || format == MapFormat::Therion; }

std::vector<std::filesystem::path> writeProject(const std::vector<DiveMap>& maps, const std::string& name,
                                                const std::string& title, MapFormat format,
                                                const std::filesystem::path& folder) {
  if (format == MapFormat::Survex) return writeFiles(folder, {name + ".svx"}, {survexProject(maps, title)});
  return writeFiles(folder, {name + ".th", name + ".thconfig"},
                    {therionProject(maps, name, title), therionConfig(maps.front(), name, {name + ".th"})});
}

}  // namespace lodeline
