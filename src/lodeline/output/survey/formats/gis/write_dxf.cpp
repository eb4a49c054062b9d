#include <fmt/format.h>

#include "lodeline/output/survey/formats/gis/dxf_drawing.h"
#include "lodeline/output/survey/formats/gis/gdal_dataset.h"
#include "lodeline/output/survey/formats/write_formats.h"

namespace lodeline {
namespace {

OGRPoint ogrPoint(const Vec3& point) { return {point.x(), point.y(), point.z()}; }

}  // namespace

std::string dxfText(const DxfDrawing& drawing, const std::string& name) {
  const gdal::MemoryFile file(name + ".dxf");
  GDALDatasetUniquePtr dataset = gdal::createDataset("DXF", file);
  gdal::Table entities(dataset.get(), "entities", nullptr, wkbUnknown);
  const auto onLayer = [](const std::string& layer) {
    return [&layer](OGRFeature& feature) { feature.SetField("Layer", layer.c_str()); };
  };
  for (const DxfDrawing::Line& line : drawing.lines) {
    OGRLineString points;
    for (const Vec3& point : line.points) {
      const OGRPoint ogr = ogrPoint(point);
      points.addPoint(&ogr);
    }
    entities.add(points, onLayer(line.layer));
  }
  for (const DxfDrawing::Point& point : drawing.points)
    entities.add(ogrPoint(point.position), onLayer(point.layer));
  for (const DxfDrawing::Label& label : drawing.labels) {
    entities.add(ogrPoint(label.position), [&label](OGRFeature& feature) {
      feature.SetField("Layer", label.layer.c_str());
      feature.SetStyleString(
          fmt::format("LABEL(f:\"Arial\",t:\"{}\",s:{:g}g)", label.text, label.height).c_str());
    });
  }
  dataset.reset();
  return file.bytes();
}

}  // namespace lodeline
