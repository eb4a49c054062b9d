#include "lodeline/output/survey/formats/gis/dxf_drawing.h"
#include "lodeline/output/survey/formats/write_formats.h"

namespace lodeline {

Vec3 drawingPoint(const DiveMap& map, const Vec3& point_ENU) {
  if (!map.place) return {point_ENU.x(), point_ENU.y(), -map.depth_m(point_ENU)};
  const Vec3 grid = map.place->grid(point_ENU);
  const double unit_m = map.place->gridDescription().metres_per_unit;
  return {grid.x() / unit_m, grid.y() / unit_m, grid.z()};
}

std::string dxfText(const DiveMap& map) {
  DxfDrawing drawing;
  DxfDrawing::Line line{"LINE", {}};
  for (const SurveyStation& station : map.survey.stations)
    line.points.push_back(drawingPoint(map, station.position_ENU));
  drawing.lines.push_back(line);
  for (const std::vector<Vec3>& ring : passagePlan(map.survey)) {
    DxfDrawing::Line outline{"PASSAGE", {}};
    for (const Vec3& corner : ring) outline.points.push_back(drawingPoint(map, corner));
    if (!(outline.points.front() == outline.points.back())) outline.points.push_back(outline.points.front());
    drawing.lines.push_back(outline);
  }
  for (size_t i = 0; i < line.points.size(); ++i) {
    drawing.points.push_back({"STATIONS", line.points[i]});
    drawing.labels.push_back({"NAMES", line.points[i], std::to_string(i)});
  }
  return dxfText(drawing, map.name);
}

}  // namespace lodeline
