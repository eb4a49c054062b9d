#include <memory>

#include "lodeline/output/survey/formats/gis/dxf_drawing.h"
#include "lodeline/output/survey/formats/gis/gdal_dataset.h"
#include "lodeline/output/survey/formats/write_formats.h"
#include "lodeline/output/survey/map/map_times.h"

namespace lodeline {
namespace {

using gdal::check;
using gdal::MemoryFile;
using gdal::Table;

OGRPoint pointOf(const DiveMap& map, const Vec3& point_ENU) {
  const Vec3 point = drawingPoint(map, point_ENU);
  return {point.x(), point.y(), point.z()};
}

OGRLineString lineOf(const DiveMap& map) {
  OGRLineString line;
  for (const SurveyStation& station : map.survey.stations) {
    const OGRPoint point = pointOf(map, station.position_ENU);
    line.addPoint(&point);
  }
  return line;
}

OGRPolygon polygonOf(const DiveMap& map, const std::vector<Vec3>& corners_ENU) {
  OGRLinearRing ring;
  for (const Vec3& corner : corners_ENU) {
    const OGRPoint point = pointOf(map, corner);
    ring.addPoint(&point);
  }
  ring.closeRings();
  OGRPolygon polygon;
  polygon.addRing(&ring);
  return polygon;
}

void addStations(const DiveMap& map, Table* table) {
  table->addField("name", OFTString);
  table->addField("time", OFTString);
  for (const char* name : {"depth_m", "left_m", "right_m", "up_m", "down_m"}) table->addField(name, OFTReal);
  for (size_t i = 0; i < map.survey.stations.size(); ++i) {
    const SurveyStation& station = map.survey.stations[i];
    table->add(pointOf(map, station.position_ENU), [&](OGRFeature& feature) {
      const auto put = [&](const char* name, const std::optional<double>& value) {
        if (value) feature.SetField(name, *value);
      };
      feature.SetField("name", std::to_string(i).c_str());
      if (const auto time = isoTime(station.time)) feature.SetField("time", time->c_str());
      put("depth_m", map.depth_m(station.position_ENU));
      put("left_m", station.passage.left);
      put("right_m", station.passage.right);
      put("up_m", station.passage.up);
      put("down_m", station.passage.down);
    });
  }
}

void addLine(const DiveMap& map, Table* table) {
  for (const char* name : {"name", "date", "vertical_datum", "notes"}) table->addField(name, OFTString);
  table->addField("length_m", OFTReal);
  std::string notes;
  for (const std::string& note : map.notes) notes += note + "\n";
  table->add(lineOf(map), [&](OGRFeature& feature) {
    feature.SetField("name", map.title.c_str());
    feature.SetField("date", map.date.c_str());
    feature.SetField("vertical_datum", map.heights.name.c_str());
    feature.SetField("notes", notes.c_str());
    feature.SetField("length_m", map.survey.length_m());
  });
}

/// Coordinates count to the east first, as GDAL stores them in every file.
std::unique_ptr<OGRSpatialReference> gridOf(const DiveMap& map) {
  if (!map.place) return nullptr;
  auto grid = std::make_unique<OGRSpatialReference>();
  check(grid->SetFromUserInput(map.place->gridDescription().gis_name.c_str()) == OGRERR_NONE, "the grid");
  grid->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  return grid;
}

}  // namespace

bool hasGdal() { return true; }

std::string geopackageBytes(const DiveMap& map) {
  const MemoryFile file(map.name + ".gpkg");
  // The same map gives the same bytes.
  CPLConfigOptionSetter date("OGR_CURRENT_DATE", "1970-01-01T00:00:00.000Z", false);
  GDALDatasetUniquePtr dataset = gdal::createDataset("GPKG", file);
  const std::unique_ptr<OGRSpatialReference> grid = gridOf(map);
  Table line(dataset.get(), "line", grid.get(), wkbLineString25D);
  addLine(map, &line);
  Table stations(dataset.get(), "stations", grid.get(), wkbPoint25D);
  addStations(map, &stations);
  Table passage(dataset.get(), "passage", grid.get(), wkbPolygon25D);
  for (const std::vector<Vec3>& ring : passagePlan(map.survey))
    passage.add(polygonOf(map, ring), [](OGRFeature&) {});
  dataset.reset();  // writes the file
  return file.bytes();
}

}  // namespace lodeline
