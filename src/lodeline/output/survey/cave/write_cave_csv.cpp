#include <fmt/format.h>

#include "lodeline/output/survey/cave/cave_survey.h"

namespace lodeline {
namespace {

std::string field(const std::optional<double>& value) { return value ? fmt::format(",{:.3f}", *value) : ","; }

std::string earthFields(const DiveMap& map, const Vec3& point_ENU) {
  if (!map.place) return ",,,,,";
  const GeodeticPosition at = map.place->geodetic(point_ENU);
  const Vec3 grid = map.place->grid(point_ENU) / map.place->gridDescription().metres_per_unit;
  return fmt::format(",{:.9f},{:.9f},{:.4f},{:.4f},{:.4f}", at.latitude_deg, at.longitude_deg, at.height_m,
                     grid.x(), grid.y());
}

}  // namespace

std::string caveStationsCsv(const CaveSurvey& cave) {
  std::string text =
      "dive,station,timestamp [ns],east [m],north [m],up [m],depth [m],latitude [deg],longitude [deg],height "
      "[m],"
      "grid_easting,grid_northing,sigma_east [m],sigma_north [m],sigma_up [m],left [m],right [m],passage_up "
      "[m],"
      "passage_down [m],entrance,notes\n";
  const DiveMap& frame = cave.dives.front();
  for (const CaveStation& made : cave.stations) {
    const Vec3& at = made.station.position_ENU;
    const PassageSize& size = made.station.passage;
    text += fmt::format("{},{},{},{:.4f},{:.4f},{:.4f},{:.4f}", cave.dives[made.dive].name, made.number,
                        made.station.time.nanoseconds(), at.x(), at.y(), at.z(), frame.depth_m(at));
    text += earthFields(frame, at);
    text += fmt::format(",{:.4f},{:.4f},{:.4f}", made.sigma_ENU.x(), made.sigma_ENU.y(), made.sigma_ENU.z());
    text += field(size.left) + field(size.right) + field(size.up) + field(size.down);
    std::string notes;
    for (const std::string& note : made.notes) notes += (notes.empty() ? "" : "; ") + note;
    text += fmt::format(",{},\"{}\"\n", made.is_entrance ? 1 : 0, notes);
  }
  return text;
}

}  // namespace lodeline
