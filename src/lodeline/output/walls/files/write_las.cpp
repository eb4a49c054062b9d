#include "lodeline/output/walls/files/write_las.h"

#include <proj.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string_view>

#include "lodeline/output/survey/formats/gis/dxf_drawing.h"
#include "lodeline/util/files/output_file.h"
#include "lodeline/version.h"

// Format: ASPRS, "LAS Specification 1.4 - R15", sections 2.4 (header), 2.5 (records of variable length) and
// 2.6.8 (point format 7).

namespace lodeline {
namespace {

constexpr double kScale_m = 0.001;
constexpr uint16_t kHeaderBytes = 375, kPointBytes = 36;

/// Well-known text of a grid by its code; empty where PROJ has none.
std::string gridText(const std::string& code) {
  const std::unique_ptr<PJ_CONTEXT, decltype(&proj_context_destroy)> context(proj_context_create(),
                                                                             &proj_context_destroy);
  const std::unique_ptr<PJ, decltype(&proj_destroy)> grid(proj_create(context.get(), code.c_str()),
                                                          &proj_destroy);
  if (!grid) return "";
  const char* const options[] = {"MULTILINE=NO", nullptr};
  const char* text = proj_as_wkt(context.get(), grid.get(), PJ_WKT1_GDAL, options);
  return text == nullptr ? "" : text;
}

std::string padded(std::string_view text, size_t size) {
  std::string field(size, '\0');
  std::copy_n(text.begin(), std::min(text.size(), size), field.begin());
  return field;
}

template <typename Value>
void appendMany(std::string* bytes, size_t count, const Value& value) {
  for (size_t i = 0; i < count; ++i) appendValue(bytes, value);
}

/// The text of the grid as a record; empty without one.
std::string gridRecord(const std::string& text) {
  if (text.empty()) return "";
  std::string record;
  appendValue(&record, uint16_t{0});
  record += padded("LASF_Projection", 16);
  appendValue(&record, uint16_t{2112});
  appendValue(&record, static_cast<uint16_t>(text.size() + 1));
  return record + padded("OGC WKT", 32) + text + '\0';
}

std::string lasHeader(const WallTiles& tiles, const Eigen::AlignedBox3d& box, const Vec3& offset,
                      size_t record_bytes) {
  std::string bytes = "LASF";
  appendValue(&bytes, uint16_t{0});
  appendValue(&bytes, uint16_t{16});  // coordinates are described by well-known text
  bytes += padded("", 16);
  bytes += std::string("\x01\x04", 2);
  bytes += padded("OTHER", 32) + padded("lodeline " LODELINE_VERSION, 32);
  appendMany(&bytes, 2, uint16_t{0});  // no date: the same input gives the same bytes
  appendValue(&bytes, kHeaderBytes);
  appendValue(&bytes, static_cast<uint32_t>(kHeaderBytes + record_bytes));
  appendValue(&bytes, static_cast<uint32_t>(record_bytes > 0 ? 1 : 0));
  appendValue(&bytes, uint8_t{7});
  appendValue(&bytes, kPointBytes);
  appendMany(&bytes, 6, uint32_t{0});  // counts of the earlier versions
  appendMany(&bytes, 3, kScale_m);
  for (int axis = 0; axis < 3; ++axis) appendValue(&bytes, offset[axis]);
  for (int axis = 0; axis < 3; ++axis) {
    appendValue(&bytes, box.max()[axis]);
    appendValue(&bytes, box.min()[axis]);
  }
  appendMany(&bytes, 2, uint64_t{0});
  appendValue(&bytes, uint32_t{0});
  appendMany(&bytes, 2, uint64_t{tiles.vertices});  // in all, and first returns
  appendMany(&bytes, 14, uint64_t{0});
  return bytes;
}

void appendPoint(std::string* bytes, const Vec3& point, const std::array<uint8_t, 3>& colour,
                 uint16_t views) {
  for (int axis = 0; axis < 3; ++axis)
    appendValue(bytes, static_cast<int32_t>(std::lround(point[axis] / kScale_m)));
  appendValue(bytes, uint16_t{0});
  appendValue(bytes, uint8_t{0x11});  // the first of one return
  appendValue(bytes, uint8_t{0});
  appendValue(bytes, uint8_t{1});  // not classified
  appendValue(bytes, static_cast<uint8_t>(std::min<uint16_t>(views, 255)));
  appendMany(bytes, 2, uint16_t{0});
  appendValue(bytes, 0.0);
  for (const uint8_t channel : colour) appendValue(bytes, static_cast<uint16_t>(257 * channel));
}

}  // namespace

void writeLas(const WallTiles& tiles, const DiveMap& map, const std::filesystem::path& file) {
  Eigen::AlignedBox3d box;
  const auto forEachPoint = [&](const auto& visit) {
    for (const std::filesystem::path& tile : tiles.files) {
      const WallMesh mesh = readTileFile(tile);
      for (size_t i = 0; i < mesh.vertices(); ++i)
        visit(drawingPoint(map, mesh.positions[i].cast<double>()), mesh.colours[i], mesh.views[i]);
    }
  };
  forEachPoint([&](const Vec3& point, const auto&, uint16_t) { box.extend(point); });
  if (box.isEmpty()) box.extend(Vec3::Zero());
  const Vec3 offset = box.min().array().floor();
  const std::string record = gridRecord(map.place ? gridText(map.place->gridDescription().gis_name) : "");
  std::ofstream stream = openOutput(file);
  stream << lasHeader(tiles, box, offset, record.size()) << record;
  std::string bytes;
  forEachPoint([&](const Vec3& point, const auto& colour, uint16_t views) {
    appendPoint(&bytes, point - offset, colour, views);
    if (bytes.size() < (1U << 20)) return;
    stream << bytes;
    bytes.clear();
  });
  stream << bytes;
  closeOutput(file, &stream);
}

}  // namespace lodeline
