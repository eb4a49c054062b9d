#include "lodeline/diagnostics.h"
#include "lodeline/output/survey/formats/gis/dxf_drawing.h"
#include "lodeline/output/survey/formats/write_formats.h"

// In place of formats/gis/write_gdal.cpp in a library without GDAL.

namespace lodeline {

bool hasGdal() { return false; }

std::string geopackageBytes(const DiveMap&) {
  throw UsageError("--format gpkg: this program was built without GDAL; --format geojson holds the same");
}

std::string dxfText(const DxfDrawing&, const std::string&) {
  throw UsageError("--format dxf: this program was built without GDAL");
}

}  // namespace lodeline
