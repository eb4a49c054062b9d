#include <fmt/format.h>

#include <iterator>
#include <numbers>

#include "lodeline/geometry/so3.h"
#include "lodeline/output/survey/formats/write_formats.h"
#include "lodeline/output/survey/map/map_times.h"
#include "lodeline/util/time/time_steps.h"

namespace lodeline {
namespace {

/// Azimuth of the body's x axis, clockwise from the map's north, 0 to 360 degrees.
double azimuth_deg(const Quat& map_from_body) {
  const Vec3 x = map_from_body * Vec3::UnitX();
  const double azimuth = std::atan2(x.x(), x.y()) * 180.0 / std::numbers::pi;
  return azimuth < 0.0 ? azimuth + 360.0 : azimuth;
}

std::string shortUnit(const MapGridDescription& grid) {
  if (grid.unit == "metre") return "m";
  if (grid.unit == "US survey foot") return "ftUS";
  return grid.unit == "foot" ? "ft" : grid.unit;
}

/// The grid's coordinates are in its own unit, which the header states.
std::string placeHeader(const DiveMap& map) {
  const std::string unit = map.place ? shortUnit(map.place->gridDescription()) : "m";
  return fmt::format(
      "east [m],north [m],up [m],depth [m],latitude [deg],longitude [deg],height [m],grid_easting [{0}],"
      "grid_northing [{0}]",
      unit);
}

/// Fields of a position; without a georeference those on the Earth are empty.
std::string placeFields(const DiveMap& map, const Vec3& point_ENU) {
  std::string text = fmt::format("{:.4f},{:.4f},{:.4f},{:.4f}", point_ENU.x(), point_ENU.y(), point_ENU.z(),
                                 map.depth_m(point_ENU));
  if (!map.place) return text + ",,,,,";
  const GeodeticPosition position = map.place->geodetic(point_ENU);
  const Vec3 grid = map.place->grid(point_ENU) / map.place->gridDescription().metres_per_unit;
  return text + fmt::format(",{:.9f},{:.9f},{:.4f},{:.4f},{:.4f}", position.latitude_deg,
                            position.longitude_deg, position.height_m, grid.x(), grid.y());
}

/// Square roots of variances; empty for negative ones, which are invalid.
std::string sigmaFields(const Vec3& variances) {
  std::string text;
  for (double variance : variances)
    text += variance < 0.0 ? "," : fmt::format(",{:.4f}", std::sqrt(variance));
  return text + "\n";
}

std::string optionalField(const std::optional<double>& value) {
  return value ? fmt::format(",{:.3f}", *value) : ",";
}

}  // namespace

std::string posesCsv(const DiveMap& map) {
  std::string text = "timestamp [ns]," + placeHeader(map) +
                     ",q_w,q_x,q_y,q_z,azimuth_of_body_x [deg],sigma_east [m],sigma_north [m],sigma_up [m]\n";
  auto uncertainty = map.uncertainties.begin();
  for (const StampedPose& pose : map.trajectory.poses) {
    while (uncertainty != map.uncertainties.end() && uncertainty->time < pose.time) ++uncertainty;
    std::string sigmas = ",,,\n";
    if (uncertainty != map.uncertainties.end() && uncertainty->time == pose.time) {
      sigmas = sigmaFields(uncertainty->covariance.diagonal());
    }
    const Quat q = so3::canonical(pose.world_from_body.rotation);
    fmt::format_to(std::back_inserter(text), "{},{},{:.9f},{:.9f},{:.9f},{:.9f},{:.3f}",
                   pose.time.nanoseconds(), placeFields(map, pose.world_from_body.translation), q.w(), q.x(),
                   q.y(), q.z(), azimuth_deg(q));
    text += sigmas;
  }
  return text;
}

std::string stationsCsv(const DiveMap& map) {
  std::string text = "station,timestamp [ns],distance [m]," + placeHeader(map) +
                     ",left [m],right [m],passage_up [m],passage_down [m]\n";
  double distance_m = 0.0;
  for (size_t i = 0; i < map.survey.stations.size(); ++i) {
    const SurveyStation& station = map.survey.stations[i];
    if (i > 0) distance_m += (station.position_ENU - map.survey.stations[i - 1].position_ENU).norm();
    const PassageSize& size = station.passage;
    text += fmt::format("{},{},{:.3f},{}", i, station.time.nanoseconds(), distance_m,
                        placeFields(map, station.position_ENU));
    text += optionalField(size.left) + optionalField(size.right) + optionalField(size.up) +
            optionalField(size.down) + "\n";
  }
  return text;
}

std::string tumText(const DiveMap& map) {
  std::string text;
  for (const std::string& note : map.notes) text += "# " + note + "\n";
  text += "# body in " + map.north.axes + "\n# timestamp [s] x y z qx qy qz qw\n";
  for (const StampedPose& pose : map.trajectory.poses) {
    const Vec3& p = pose.world_from_body.translation;
    const Quat q = so3::canonical(pose.world_from_body.rotation);
    fmt::format_to(std::back_inserter(text), "{} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f}\n",
                   secondsText(pose.time), p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w());
  }
  return text;
}

}  // namespace lodeline
