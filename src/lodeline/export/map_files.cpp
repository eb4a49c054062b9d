#include "lodeline/export/map_files.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <utility>

#include "lodeline/base/choice.h"
#include "lodeline/base/error.h"
#include "lodeline/base/output_file.h"

namespace lodeline {
namespace {

using NamedContent = std::pair<std::string, std::string>;

bool needsPlace(MapFormat format) {
  return format == MapFormat::GeoJson || format == MapFormat::Kml || format == MapFormat::Gpx;
}

std::vector<NamedContent> colmapFiles(const DiveMap& map, const std::optional<MapImages>& images) {
  if (!images || images->cameras.empty()) {
    throw UsageError("--format colmap needs the cameras: name the recording with --recording DATA");
  }
  const ColmapModel model = colmapModel(map, images->cameras, images->images);
  return {{"colmap/cameras.txt", model.cameras},
          {"colmap/images.txt", model.images},
          {"colmap/points3D.txt", model.points3D}};
}

std::vector<NamedContent> contents(const DiveMap& map, const std::optional<MapImages>& images,
                                   MapFormat format) {
  const std::string& name = map.name;
  switch (format) {
    case MapFormat::Survex:
      return {{name + ".svx", survexText(map)}};
    case MapFormat::Therion:
      return {{name + ".th", therionText(map)}, {name + ".thconfig", therionConfig(map)}};
    case MapFormat::GeoJson:
      return {{name + ".geojson", geojsonText(map)}};
    case MapFormat::Kml:
      return {{name + ".kml", kmlText(map)}};
    case MapFormat::Gpx:
      return {{name + ".gpx", gpxText(map)}};
    case MapFormat::Ply:
      return {{name + ".ply", plyBytes(map)}};
    case MapFormat::Csv:
      return {{name + "_stations.csv", stationsCsv(map)}, {name + "_poses.csv", posesCsv(map)}};
    case MapFormat::Tum:
      return {{name + ".tum", tumText(map)}};
    case MapFormat::Colmap:
      return colmapFiles(map, images);
  }
  return {};
}

}  // namespace

const std::vector<std::string>& mapFormatNames() {
  static const std::vector<std::string> names = {"survex", "therion", "geojson", "kml",   "gpx",
                                                 "ply",    "csv",     "tum",     "colmap"};
  return names;
}

MapFormat mapFormatFromString(const std::string& name) {
  return static_cast<MapFormat>(chooseByName("--format", name, mapFormatNames()));
}

std::vector<std::filesystem::path> writeMap(const DiveMap& map, const std::optional<MapImages>& images,
                                            MapFormat format, const std::filesystem::path& folder) {
  if (needsPlace(format) && !map.place) {
    throw UsageError(fmt::format("--format {} needs a place on the Earth: give --entrance LAT,LON,HEIGHT",
                                 mapFormatNames()[static_cast<size_t>(format)]));
  }
  std::vector<std::filesystem::path> files;
  for (const auto& [name, content] : contents(map, images, format)) {
    const std::filesystem::path file = folder / name;
    createOutputFolder(file.parent_path());
    writeOutput(file, content);
    files.push_back(file);
  }
  return files;
}

}  // namespace lodeline
