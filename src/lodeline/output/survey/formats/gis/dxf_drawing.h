#pragma once

#include <string>
#include <vector>

#include "lodeline/output/survey/map/dive_map.h"

namespace lodeline {

/// What a DXF file shows, on named layers; coordinates as of drawingPoint().
struct DxfDrawing {
  struct Line {
    std::string layer;
    std::vector<Vec3> points;
  };
  struct Point {
    std::string layer;
    Vec3 position = Vec3::Zero();
  };
  struct Label {
    std::string layer;
    Vec3 position = Vec3::Zero();
    std::string text;
    double height = 0.5;  ///< in units of the drawing
  };
  std::vector<Line> lines;
  std::vector<Point> points;
  std::vector<Label> labels;
};

/// Coordinates of a point on the grid of the map, in its own unit, and its height in m; east, north and the
/// depth below the water without a place.
Vec3 drawingPoint(const DiveMap& map, const Vec3& point_ENU);

/// The file. `name`: of the drawing. Throws UsageError without GDAL.
std::string dxfText(const DxfDrawing& drawing, const std::string& name);

}  // namespace lodeline
