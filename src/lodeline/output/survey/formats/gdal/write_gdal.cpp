#include <fmt/format.h>
#include <ogrsf_frmts.h>

#include <functional>
#include <memory>
#include <mutex>

#include "lodeline/diagnostics.h"
#include "lodeline/output/survey/formats/write_formats.h"
#include "lodeline/output/survey/map/map_times.h"

namespace lodeline {
namespace {

/// A file in GDAL's memory, which is removed at the end.
class MemoryFile {
 public:
  explicit MemoryFile(const std::string& name) : path_("/vsimem/lodeline/" + name) {
    VSIUnlink(path_.c_str());
  }
  ~MemoryFile() { VSIUnlink(path_.c_str()); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  const std::string& path() const { return path_; }
  std::string bytes() const {
    vsi_l_offset size = 0;
    const GByte* data = VSIGetMemFileBuffer(path_.c_str(), &size, FALSE);
    if (data == nullptr || size == 0) throw InputError("GDAL wrote nothing");
    return {reinterpret_cast<const char*>(data), static_cast<size_t>(size)};
  }

 private:
  std::string path_;
};

void check(bool is_good, const char* what) {
  if (!is_good) throw InputError(fmt::format("GDAL cannot write {}: {}", what, CPLGetLastErrorMsg()));
}

/// Coordinates on the grid in its own unit, height in metres; east, north, up without a place.
OGRPoint pointOf(const DiveMap& map, const Vec3& point_ENU) {
  if (!map.place) return {point_ENU.x(), point_ENU.y(), -map.depth_m(point_ENU)};
  const Vec3 grid = map.place->grid(point_ENU);
  const double unit_m = map.place->gridDescription().metres_per_unit;
  return {grid.x() / unit_m, grid.y() / unit_m, grid.z()};
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

/// Dataset of one of GDAL's drivers in memory.
GDALDatasetUniquePtr createDataset(const char* driver_name, const MemoryFile& file) {
  static std::once_flag once;
  std::call_once(once, [] { GDALAllRegister(); });
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName(driver_name);
  check(driver != nullptr, driver_name);
  GDALDatasetUniquePtr dataset(driver->Create(file.path().c_str(), 0, 0, 0, GDT_Unknown, nullptr));
  check(dataset != nullptr, driver_name);
  return dataset;
}

/// Adds features to a table.
class Table {
 public:
  Table(GDALDataset* dataset, const char* name, OGRSpatialReference* grid, OGRwkbGeometryType type)
      : layer_(dataset->CreateLayer(name, grid, type, nullptr)) {
    check(layer_ != nullptr, name);
  }

  void addField(const char* name, OGRFieldType type) {
    OGRFieldDefn field(name, type);
    check(layer_->CreateField(&field) == OGRERR_NONE, name);
  }

  void add(const OGRGeometry& geometry, const std::function<void(OGRFeature&)>& fill) {
    const OGRFeatureUniquePtr feature(OGRFeature::CreateFeature(layer_->GetLayerDefn()));
    feature->SetGeometry(&geometry);
    fill(*feature);
    check(layer_->CreateFeature(feature.get()) == OGRERR_NONE, "a feature");
  }

 private:
  OGRLayer* layer_;
};

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
  check(grid->SetFromUserInput(map.place->gridDescription().code.c_str()) == OGRERR_NONE, "the grid");
  grid->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  return grid;
}

}  // namespace

bool hasGdal() { return true; }

std::string geopackageBytes(const DiveMap& map) {
  const MemoryFile file(map.name + ".gpkg");
  // The same map gives the same bytes.
  CPLConfigOptionSetter date("OGR_CURRENT_DATE", "1970-01-01T00:00:00.000Z", false);
  GDALDatasetUniquePtr dataset = createDataset("GPKG", file);
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

std::string dxfText(const DiveMap& map) {
  const MemoryFile file(map.name + ".dxf");
  GDALDatasetUniquePtr dataset = createDataset("DXF", file);
  Table entities(dataset.get(), "entities", nullptr, wkbUnknown);
  const auto onLayer = [](const char* name) {
    return [name](OGRFeature& feature) { feature.SetField("Layer", name); };
  };
  entities.add(lineOf(map), onLayer("LINE"));
  for (const std::vector<Vec3>& ring : passagePlan(map.survey)) {
    const OGRPolygon polygon = polygonOf(map, ring);
    entities.add(OGRLineString(*polygon.getExteriorRing()), onLayer("PASSAGE"));
  }
  for (size_t i = 0; i < map.survey.stations.size(); ++i) {
    const OGRPoint point = pointOf(map, map.survey.stations[i].position_ENU);
    entities.add(point, onLayer("STATIONS"));
    entities.add(point, [i](OGRFeature& feature) {
      feature.SetField("Layer", "NAMES");
      feature.SetStyleString(fmt::format("LABEL(f:\"Arial\",t:\"{}\",s:0.5g)", i).c_str());
    });
  }
  dataset.reset();
  return file.bytes();
}

}  // namespace lodeline
